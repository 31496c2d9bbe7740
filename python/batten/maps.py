"""Maps: geometries of shapely and geopandas, whose shared borders stay shared."""

from __future__ import annotations

import warnings
from typing import Any, Literal, TypeVar, overload

import numpy as np

from batten._core import (BattenWarning, Progress, Report, call, ffi, lib, options, pointer, report, shown,
                          take, takes)  # fmt: skip

#: The kinds of geometries with lines, by shapely's numbers: all but points.
_LINES = (1, 2, 3, 5, 6, 7)


_Geometries = TypeVar("_Geometries")


@overload
def smooth(geometries: _Geometries, *, space: Literal["sphere", "plane"] | None = None, progress: Progress = False,
           details: Report | None = None, **settings: Any) -> _Geometries: ...
@overload
def smooth(geometries: Any, *, space: str | None = None, progress: Progress = False, details: Report | None = None,
           **settings: Any) -> Any: ...
@takes("bat_curve_map_refine_options")
def smooth(geometries: Any, *, space: str | None = None, progress: Progress = False, details: Report | None = None,
           **settings: Any) -> Any:
    """Make the lines and polygons of a map smooth; borders that polygons share stay shared, and nothing crosses.

    Parameters
    ----------
    geometries : GeoSeries, GeoDataFrame, shapely geometry, or a list or array of them
        Points, missing and empty geometries come back as they are. Further coordinates are refined too.
    space : {"sphere", "plane"}, optional
        By default the sphere for a geographic coordinate reference system, whose coordinates are longitudes and latitudes
        in degrees; else the plane.
    progress : bool or callable
        As of :func:`refine`.
    details : Report, optional
        Receives what was found and done: shared arcs, nodes, crossings.
    **settings
        Fields of ``bat_curve_map_refine_options`` and its ``bat_curve_refine_options``.

    Returns
    -------
    of the same kind as `geometries`
        With the same index, columns and coordinate reference system.

    Examples
    --------
    >>> import shapely
    >>> left, right = shapely.box(0, 0, 1, 1), shapely.box(1, 0, 2, 1)
    >>> smooth = batten.smooth([left, right], levels=3)
    >>> bool(shapely.coverage_is_valid(smooth)), smooth[0].intersection(smooth[1]).geom_type
    (True, 'MultiLineString')
    """
    import shapely

    if hasattr(geometries, "set_geometry"):  # a GeoDataFrame
        return geometries.set_geometry(smooth(geometries.geometry, space=space, progress=progress, details=details, **settings))
    system = getattr(geometries, "crs", None)
    given = np.atleast_1d(np.asarray(geometries, dtype=object))
    if given.ndim != 1 or not (shapely.is_geometry(given) | shapely.is_missing(given)).all():
        raise TypeError("geometries of shapely are needed")
    if not shapely.is_missing(given).all() and not np.isfinite(shapely.get_coordinates(given)).all():
        raise ValueError("coordinates that are finite are needed")
    where = space or ("sphere" if system is not None and system.is_geographic else "plane")
    chosen = np.isin(shapely.get_type_id(given), _LINES) & ~shapely.is_empty(given)
    made = given.copy()
    if chosen.any():
        lines = given[chosen]
        rings = shapely.get_type_id(lines) == 2
        lines[rings] = shapely.polygons(lines[rings])
        lines, done = _refine(lines, where, progress, settings)
        lines[rings] = shapely.get_exterior_ring(lines[rings])
        made[chosen] = lines
        if details is not None:
            details.update(done)
        if done.given_crossing:
            warnings.warn(f"{done.given_crossing} pairs of given edges cross or touch, and may do so in the result",
                          BattenWarning, stacklevel=2)  # fmt: skip
    if hasattr(geometries, "geom_type") and hasattr(geometries, "index"):  # a GeoSeries
        return type(geometries)(made, index=geometries.index, crs=system, name=geometries.name)
    if isinstance(geometries, (list, tuple)):
        return type(geometries)(made.tolist())
    return made[0] if np.ndim(geometries) == 0 else made


def _refine(given: Any, space: str, progress: Progress, settings: dict[str, Any]) -> tuple[Any, Report]:
    """Refine geometries by the way that files take: as GeoJSON, which is read as the program reads it."""
    import shapely

    features = ",".join(f'{{"type":"Feature","properties":null,"geometry":{text}}}' for text in shapely.to_geojson(given))
    whole = f'{{"type":"FeatureCollection","features":[{features}]}}'.encode()
    free = lib.bat_curve_set_free
    coarse, fine = ffi.gc(ffi.new("bat_curve_set *"), free), ffi.gc(ffi.new("bat_curve_set *"), free)
    found = ffi.new("bat_curve_map_refine_report *")
    if "fairness" in settings:
        settings.setdefault("scheme", "learned")
    how = options("bat_curve_map_refine_options", settings)
    how.report = found
    reading = options("bat_curve_read_options", {"format": "geojson", "space": space})
    call(lib.bat_curve_read_memory, whole, len(whole), reading, coarse)
    with shown(progress, "smoothing"):
        call(lib.bat_curve_map_refine, coarse, how, fine)
    index = 0
    while note := lib.bat_curve_set_note(coarse, index):
        warnings.warn(ffi.string(note).decode(), BattenWarning, stacklevel=4)
        index += 1
    made, left = _assemble(given, fine, space, how.decimals)
    if left.any():
        memory, size = ffi.new("char **"), ffi.new("size_t *")
        writing = options("bat_curve_write_options", {"format": "geojson", "precision": how.decimals})
        call(lib.bat_curve_write_memory, fine, writing, memory, size)
        lines = take(memory[0], (size[0],), np.uint8).tobytes().splitlines()[1:-1]  # a feature each
        texts = [lines[i].rstrip(b",")[:-1].partition(b'"geometry":')[2].decode() for i in np.flatnonzero(left)]
        made[left] = shapely.from_geojson(texts)
    return made, report(found)


def _assemble(given: Any, fine: Any, space: str, decimals: int) -> tuple[Any, Any]:
    """Geometries of refined curves, and flags of those that only the writer of GeoJSON can make: they cross the
    antimeridian, come near a pole, are collections, have further coordinates, or lost parts."""
    import shapely

    count = fine.count
    points, offsets = np.empty((lib.batten_set_points(fine), 2)), np.empty(count + 1, np.int64)
    closed, polygon, feature = np.empty(count, np.bool_), np.empty(count, np.int64), np.empty(count, np.int64)
    lib.batten_set_arrays(fine, decimals if space == "sphere" else -1, pointer(points), pointer(offsets, "int64_t[]"), pointer(closed, "bool[]"),
                          pointer(polygon, "int64_t[]"), pointer(feature, "int64_t[]"))  # fmt: skip
    points = points[: offsets[-1]]
    parts, owner = shapely.get_parts(given, return_index=True)
    kinds, part_kinds = shapely.get_type_id(given), shapely.get_type_id(parts)
    expected = np.bincount(owner, np.where(part_kinds == 3, shapely.get_num_interior_rings(parts) + 1, 1), len(given))
    if (feature < 0).any():
        if expected.sum() != count:
            return given.copy(), np.ones(len(given), np.bool_)
        feature = np.repeat(np.arange(len(given)), expected.astype(np.int64))
    left = (np.bincount(feature, minlength=len(given)) != expected) | (kinds == 7) | shapely.has_z(given)
    points = np.insert(points, offsets[1:][closed], points[offsets[:-1][closed]], axis=0)
    offsets = offsets + np.concatenate([[0], np.cumsum(closed)])
    curve = np.repeat(np.arange(count), np.diff(offsets))
    if space == "sphere":
        far = np.abs(np.diff(points[:, 0], append=points[-1:, 0])) >= 180
        far[offsets[1:] - 1] = False
        left[feature[curve[far | (np.abs(points[:, 1]) > 89.999) | (np.abs(points[:, 0]) == 180)]]] = True
    made = given.copy()
    # Lines, and rings of polygons, of all features; then what they are parts of.
    for single, several, build, join in [(1, 5, shapely.linestrings, shapely.multilinestrings),
                                         (3, 6, shapely.linearrings, shapely.multipolygons)]:  # fmt: skip
        for kind in (single, several):
            chosen = ((kinds == kind) & ~left)[feature]
            if not chosen.any():
                continue
            keep = chosen[curve]
            pieces = build(points[keep], indices=_renumbered(curve[keep]))
            of = feature[chosen]
            if single == 3:
                part = _renumbered(polygon[chosen])
                pieces, of = shapely.polygons(pieces, indices=part), of[np.diff(part, prepend=-1) > 0]
            made[np.unique(of)] = pieces if kind == single else join(pieces, indices=_renumbered(of))
    return made, left


def _renumbered(indices: Any) -> Any:
    """Increasing indices as 0, 1, 2, … without gaps."""
    return np.cumsum(np.diff(indices, prepend=indices[:1]) > 0)
