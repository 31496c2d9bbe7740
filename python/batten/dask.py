"""Collections of Dask: the functions of batten, lazily, partition by partition, with the results of one machine.

Settings are those of the functions of the same name in ``batten``. Nothing is computed before ``compute()`` or a writer asks
for it. A worker that dies loses nothing: Dask computes its partitions again, and they come out the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from batten._core import BattenWarning, Report, Unsupported, like, show_signatures
from batten.curves import refine as _refine
from batten.maps import degrees_of, smooth as _smooth, space_of
from batten.meshes import decimate as _decimate, refine_mesh as _refine_mesh
from batten.motions import Motion
from batten.spaces import from_lonlat

__all__ = ["decimate", "map_items", "motions", "refine", "refine_mesh", "smooth"]


def map_items(function: Callable[..., Any], items: Any, **settings: Any) -> Any:
    """Apply a function of batten to each item of a bag.

    Parameters
    ----------
    function : callable
        ``batten.refine``, ``batten.fit_surface``, ``batten.Mesh.read``, …
    items : dask.bag.Bag
        What `function` takes.
    **settings
        Keyword arguments of `function`.

    Returns
    -------
    dask.bag.Bag
        With the same partitions.
    """
    settings.setdefault("threads", 1)
    return items.map(function, **settings)


@like("refine")
def refine(curves: Any, **settings: Any) -> Any:
    """Refine the curves of a bag, each by itself, as :func:`batten.refine` does.

    Parameters
    ----------
    curves : dask.bag.Bag
        Arrays of points, one a curve.
    **settings
        Those of :func:`batten.refine` for one curve.

    Returns
    -------
    dask.bag.Bag
        A :class:`batten.Curve` for each.
    """
    return map_items(_refine, curves, **settings)


@like("refine_mesh")
def refine_mesh(meshes: Any, **settings: Any) -> Any:
    """Refine the meshes of a bag as :func:`batten.refine_mesh` does; items are meshes of batten or trimesh."""
    return map_items(_refine_mesh, meshes, **settings)


@like("decimate")
def decimate(meshes: Any, **settings: Any) -> Any:
    """Decimate the meshes of a bag as :func:`batten.decimate` does; items become :class:`batten.Decimation`."""
    return map_items(_decimate, meshes, **settings)


@like("Motion.__init__")
def motions(keyframes: Any, *, by: Any = None, time: str | None = None, poses: Iterable[str] = (), rate: float | None = None,
            **settings: Any) -> Any:
    """Motions through keyframes: :class:`batten.Motion` of each item of a bag, or of each group of a dataframe.

    Parameters
    ----------
    keyframes : dask.bag.Bag or dask.dataframe.DataFrame
        A bag of pairs (times, poses); or a dataframe whose partitions hold whole groups, as after ``shuffle(by)``.
    by, time, poses
        Of a dataframe: the columns of the group, of the time and of the coordinates.
    rate : float
        Of a dataframe: how many rows a unit of time (a second of dates) each motion becomes.
    **settings
        Those of :class:`batten.Motion`.

    Returns
    -------
    dask.bag.Bag or dask.dataframe.DataFrame
        A bag of motions; or a dataframe of the columns `by`, `time` and `poses`, sampled.
    """
    settings.setdefault("threads", 1)
    if not hasattr(keyframes, "_meta"):
        return keyframes.map(_motion, **settings)
    if by is None or time is None or rate is None:
        raise TypeError("a dataframe needs the columns 'by', 'time' and 'poses', and 'rate'")
    names = [by, time, *poses]
    meta = keyframes._meta[names].astype({name: float for name in names[2:]})
    if meta[time].dtype.kind in "iu":
        meta = meta.astype({time: float})
    return keyframes.map_partitions(_sampled, names, rate, settings, meta=meta)


def _motion(pair: Any, **settings: Any) -> Any:
    return Motion(*pair, **settings)


def _sampled(frame: Any, names: list[str], rate: float, settings: dict[str, Any]) -> Any:
    """The motions of a pandas dataframe, sampled."""
    import pandas as pd

    by, time, *poses = names
    parts = []
    for key, group in frame.groupby(by, sort=False, observed=True):
        group = group.sort_values(time, kind="stable")  # a shuffle changes the order
        times = group[time].to_numpy()
        motion = Motion(times, group[poses].to_numpy(float), **settings)
        dates = times.dtype.kind == "M"
        span = (times[-1] - times[0]) / np.timedelta64(1, "s") if dates else float(times[-1] - times[0])
        steps = np.arange(int(np.floor(span * rate * (1 + 1e-12))) + 1) / rate
        moments = times[0] + (1e9 * steps).round().astype("timedelta64[ns]") if dates else times[0] + np.minimum(steps, span)
        part = pd.DataFrame(np.asarray(motion(moments)), columns=poses)
        part.insert(0, time, moments)
        part.insert(0, by, key)
        parts.append(part)
    if not parts:
        return frame[names]
    made = pd.concat(parts, ignore_index=True)
    return made.astype({by: frame[by].dtype, **({time: frame[time].dtype} if frame[time].dtype.kind == "M" else {})})


# Maps


@like("smooth")
def smooth(map: Any, *, rings: int = 3, space: str | None = None, **settings: Any) -> Any:
    """Make the lines and polygons of a map smooth, as :func:`batten.smooth` does with the whole map at once.

    Borders between features of different partitions stay shared: each partition is refined together with the features of
    others that it depends on. Partitions whose features are neighbours need least of them, see
    ``dask_geopandas.GeoDataFrame.spatial_shuffle``.

    Parameters
    ----------
    map : dask_geopandas.GeoDataFrame, dask_geopandas.GeoSeries or dask.bag.Bag
        A map; or a bag whose items are maps, which become smooth each by itself.
    rings : int
        How many times neighbours of neighbours of a partition are taken along, at least 2. Where a chain of borders that are drawn
        back, since they would cross, leaves these rings, the partition is refused.
    space, topology, keep_area
        As of :func:`batten.smooth`. With ``topology="separate"`` no partition needs another. Areas, with `keep_area`,
        depend on the whole map: they need one partition.
    **settings
        As of :func:`batten.smooth`.

    Returns
    -------
    as `map`
        With the same partitions, index, columns and coordinate reference system; the geometries are those of one machine,
        byte for byte.
    """
    settings.setdefault("threads", 1)
    if not hasattr(map, "crs"):
        return map.map(_smooth, space=space, **settings)
    if settings.get("topology") == "separate" or map.npartitions == 1:
        return map.map_partitions(_smooth, space=space, meta=map._meta, **settings)
    if settings.get("keep_area"):
        raise Unsupported("keep_area: areas depend on the whole map; map.repartition(npartitions=1) does")
    from dask.base import tokenize
    from dask.delayed import delayed

    crs = map.crs
    where = space or space_of(crs)
    if where == "sphere" and degrees_of(crs) != 1:
        raise Unsupported("crs: degrees are needed; map.to_crs(4326) makes them")
    name = tokenize(map, rings, where, settings)
    parts = map.to_delayed()
    boxes = [delayed(_boxes, pure=True)(part, where, float(settings.get("snap_tolerance", 0))) for part in parts]
    plan = delayed(_plan, pure=True)(boxes, rings, dask_key_name=f"batten-plan-{name}")
    made = []
    for own, part in enumerate(parts):
        given = [delayed(_wanted, pure=True)(other, plan, own, i) for i, other in enumerate(parts) if i != own]
        made.append(delayed(_smooth_part)(part, given, plan, own, where, rings, settings, dask_key_name=f"batten-smooth-{name}-{own}"))
    from dask.dataframe import from_delayed

    return from_delayed(made, meta=map._meta, divisions=map.divisions, verify_meta=False)


def _boxes(part: Any, space: str, tolerance: float) -> Any:
    """A box for each feature that holds it once it is refined, as rows of lower and upper bounds, and its largest
    coordinate. On the sphere boxes are in space. Features without lines have none: NaN."""
    import shapely

    given = np.asarray(part.geometry, dtype=object)
    points, owner = shapely.get_coordinates(given, return_index=True)
    largest = np.zeros(len(given))
    np.maximum.at(largest, owner, np.abs(points).max(axis=1, initial=0))
    if space == "sphere":
        points = from_lonlat(points)
    low, high = np.full((len(given), points.shape[1]), np.inf), np.full((len(given), points.shape[1]), -np.inf)
    np.minimum.at(low, owner, points)
    np.maximum.at(high, owner, points)
    longest = np.zeros(len(given))  # of its edges
    same = owner[1:] == owner[:-1]
    np.maximum.at(longest, owner[1:][same], np.linalg.norm(np.diff(points, axis=0), axis=1)[same])
    margin = longest[:, None] + tolerance
    none = ~np.isin(shapely.get_type_id(given), (1, 2, 3, 5, 6, 7)) | shapely.is_empty(given)
    low, high = low - margin, high + margin
    low[none], high[none] = np.nan, np.nan
    return low, high, largest


def _plan(boxes: list[Any], rings: int) -> dict[str, Any]:
    """Which features each partition needs.

    Features are neighbours where their boxes overlap. Equal points, and lines that may cross, are those of neighbours.
    """
    import shapely

    low, high = np.concatenate([box[0] for box in boxes]), np.concatenate([box[1] for box in boxes])
    begin = np.cumsum([0, *(len(box[0]) for box in boxes)])
    count = len(low)
    flat = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    flat[np.isnan(low[:, 0])] = None
    first, second = shapely.STRtree(flat).query(flat)
    close = ((low[first] <= high[second]) & (low[second] <= high[first])).all(axis=1)
    first, second = first[close], second[close]
    order = np.lexsort((second, first))
    starts = np.concatenate([[0], np.cumsum(np.bincount(first, minlength=count))])
    plan = {"begin": begin, "starts": starts, "neighbours": second[order], "low": low, "high": high}
    # Points of the plane are equal up to rounding, which the largest coordinate decides.
    largest = int(np.argmax(np.concatenate([box[2] for box in boxes]))) if count else 0
    needed = []
    for own in range(len(boxes)):
        found = np.zeros(count, np.bool_)
        found[begin[own] : begin[own + 1]] = True
        for _ in range(rings):
            found |= _reached(plan, found)
        if count:
            found[largest] = True
        needed.append(np.flatnonzero(found))
    return {**plan, "needed": needed}


def _reached(plan: dict[str, Any], found: Any) -> Any:
    """Flags of the neighbours of flagged features."""
    edges = np.repeat(found, np.diff(plan["starts"]))
    reached = np.zeros(len(found), np.bool_)
    reached[plan["neighbours"][edges]] = True
    return reached


def _wanted(part: Any, plan: dict[str, Any], own: int, index: int) -> Any:
    """The features of partition `index` that partition `own` needs."""
    begin, end = plan["begin"][index : index + 2]
    needed = plan["needed"][own]
    return np.asarray(part.geometry, dtype=object)[needed[(needed >= begin) & (needed < end)] - begin]


def _smooth_part(part: Any, given: list[Any], plan: dict[str, Any], own: int, space: str, rings: int, settings: dict[str, Any]) -> Any:
    """A partition, refined together with the features of others that it needs."""
    import warnings

    import shapely

    mine = np.asarray(part.geometry, dtype=object)
    joined = np.concatenate([*given[:own], mine, *given[own:]])
    needed = plan["needed"][own]
    begin, end = plan["begin"][own : own + 2]
    inside = (needed >= begin) & (needed < end)
    done = Report()
    made = _smooth(joined, space=space, details=done, **settings)
    moved = np.zeros(len(plan["low"]), np.bool_)
    if done.get("drawn_back", 0) and settings.get("simple") != "never":
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", BattenWarning)
            free = _smooth(joined, space=space, **{**settings, "simple": "never"})
        moved[needed] = shapely.to_wkb(made) != shapely.to_wkb(free)
    _check_chain(plan, own, moved, rings)
    _check_boxes(made[inside], plan["low"][begin:end], plan["high"][begin:end], space, own)
    result = type(part.geometry)(made[inside], index=part.index, crs=part.crs, name=part.geometry.name)
    return part.set_geometry(result) if hasattr(part, "set_geometry") else result


def _check_boxes(made: Any, low: Any, high: Any, space: str, own: int) -> None:
    """Refuse a partition with lines that left the boxes by which neighbours were found."""
    import shapely

    points, owner = shapely.get_coordinates(made, return_index=True)
    if space == "sphere":
        points = from_lonlat(points)
    if ((points < low[owner] - 1e-12) | (points > high[owner] + 1e-12)).any():
        raise Unsupported(f"partition {own}: a line moved farther than its longest edge; map.repartition(npartitions=1) does")


def _check_chain(plan: dict[str, Any], own: int, moved: Any, rings: int) -> None:
    """Refuse a partition whose lines, or those that drew them back, have neighbours of neighbours that are not there."""
    chain = np.zeros(len(moved), np.bool_)
    chain[plan["begin"][own] : plan["begin"][own + 1]] = True
    while True:
        longer = chain | (_reached(plan, chain) & moved)
        if (longer == chain).all():
            break
        chain = longer
    there = np.zeros(len(moved), np.bool_)
    there[plan["needed"][own]] = True
    needed = _reached(plan, chain)
    if (_reached(plan, needed) & ~there).any():
        raise Unsupported(f"partition {own}: lines that would cross form a chain that leaves the {rings} rings of neighbours around it; "
                          "a larger 'rings' or fewer partitions do")  # fmt: skip


show_signatures("DASK", globals())
