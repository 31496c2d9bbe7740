"""Maps: geometries of shapely and geopandas, whose shared borders stay shared."""

from __future__ import annotations

import math
import re
import struct
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal, TypeVar, overload

import numpy as np

from batten._core import (BattenError, BattenWarning, InvalidArgument, Progress, Report, Unsupported, call, check_options, ffi, lib, no_choice, options, pointer, report, shown,
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
    geometries : GeoSeries, GeoDataFrame, shapely geometry, or a list or array of them; or what pandas has of one column of them
        Points, missing and empty geometries come back as they are. Heights (Z) and measures (M) are refined too.
    space : {"sphere", "plane"}, optional
        By default the sphere for a geographic coordinate reference system, whose coordinates are longitudes and latitudes
        in degrees or in the unit of the system; else the plane.
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

    table, column = hasattr(geometries, "columns") and hasattr(geometries, "iloc"), -1
    series = geometries
    if table and hasattr(type(geometries), "to_crs"):
        series = geometries.geometry
    elif table:
        column = _column(geometries)
        series = geometries.iloc[:, column]
    system = getattr(getattr(series, "array", series), "crs", None)
    given = np.atleast_1d(np.asarray(series, dtype=object))
    if given.ndim != 1 or not (shapely.is_geometry(given) | shapely.is_missing(given)).all():
        raise TypeError("geometries of shapely are needed")
    settings = {"scheme": "learned", **settings} if "fairness" in settings else settings
    check_options("bat_curve_map_refine_options", settings)
    if isinstance(space, str) and (text := no_choice("bat_space", space)):
        raise InvalidArgument(f"space: {text}")
    chosen = np.isin(shapely.get_type_id(given), _LINES) & ~shapely.is_empty(given)
    notes: list[str] = []
    made = given.copy()
    if chosen.any():
        lines = given[chosen]
        rings = shapely.get_type_id(lines) == 2
        lines[rings] = shapely.polygons(lines[rings])
        rows = np.flatnonzero(chosen)
        with shown(progress, "smoothing"), _numbered(rows):
            lines, done = _every_coordinate(lines, space or space_of(system), degrees_of(system) if space != "plane" else 1.0, settings, notes)
        lines[rings] = shapely.get_exterior_ring(lines[rings])
        made[chosen] = lines
        if details is not None:
            details.update(done)
        notes = [_of_rows(note, rows) for note in notes]
        if done.given_crossing:
            notes.append(f"{done.given_crossing} pairs of given edges cross or touch, and may do so in the result")
    for note in notes:
        warnings.warn(note, BattenWarning, stacklevel=2)
    if hasattr(series, "index") and hasattr(series, "array"):  # of pandas or geopandas
        values = type(series.array)(made, crs=system) if hasattr(series.array, "geom_type") else made
        result = type(series)(values, index=series.index, name=series.name)
        result.attrs = dict(series.attrs)
        if column < 0:
            return geometries.set_geometry(result) if table else result
        whole = geometries.copy()
        whole.isetitem(column, result)
        return whole
    if hasattr(series, "geom_type") and hasattr(series, "crs"):  # a GeometryArray
        return type(series)(made, crs=system)
    if isinstance(geometries, (list, tuple)):
        return type(geometries)(made.tolist())
    return made[0] if np.ndim(geometries) == 0 else made


def _column(table: Any) -> int:
    """The column of a table of pandas that holds geometries."""
    import shapely

    found = []
    for i in range(table.shape[1]):
        values = np.asarray(table.iloc[:, i], dtype=object)
        if shapely.is_geometry(values).any() and (shapely.is_geometry(values) | shapely.is_missing(values)).all():
            found.append(i)
    if len(found) != 1:
        raise TypeError(f"a table with one column of geometries is needed, not {len(found)}; geopandas.GeoDataFrame(table, geometry=name) chooses one")
    return found[0]


def _of_rows(text: str, rows: Any) -> str:
    """A message with the numbers of the given geometries, where it has those of the lines among them."""
    return re.sub(r"\b(?:feature|geometry) (\d+)", lambda found: f"geometry {rows[int(found[1])]}", text)


@contextmanager
def _numbered(rows: Any) -> Iterator[None]:
    try:
        yield
    except ValueError as error:  # of the library, too
        error.args = tuple(_of_rows(text, rows) if isinstance(text, str) else text for text in error.args)
        if isinstance(error, BattenError) and error.curve is not None:
            error.curve = int(rows[error.curve])
        raise


def space_of(system: Any) -> str:
    """The space of maps of a coordinate reference system."""
    return "sphere" if system is not None and system.is_geographic else "plane"


def degrees_of(system: Any) -> float:
    """The unit of a geographic coordinate reference system, in degrees."""
    if system is None or not system.is_geographic or not system.axis_info:
        return 1.0
    unit = math.degrees(system.axis_info[0].unit_conversion_factor)
    return 1.0 if abs(unit - 1) < 1e-12 else unit


def _every_coordinate(given: Any, space: str, unit: float, settings: dict[str, Any], notes: list[str]) -> tuple[Any, Report]:
    """Refine geometries with all their coordinates, in units of so many degrees on the sphere. Measures (M) take the place of
    heights (Z) in a second call, since GeoJSON has only these."""
    import shapely

    measured = shapely.has_m(given) if hasattr(shapely, "has_m") else np.zeros(len(given), np.bool_)
    for i, geometry in enumerate(given):
        if not np.isfinite(_coordinates(geometry, geometry.has_z, measured[i])).all():
            raise ValueError(f"geometry {i}: coordinates that are finite are needed; shapely.force_2d() drops the others")
    if unit == 1 and not measured.any():
        return _refine(given, space, settings, notes)
    scale = np.array([unit, unit, 1.0])

    def plain(geometry: Any, z: bool, m: bool) -> Any:
        return _rebuilt(geometry, _coordinates(geometry, z, m) * scale[: 2 + z + m], z or m, False)

    made, done = _refine(np.array([plain(geometry, geometry.has_z, False) for geometry in given]), space, settings, notes)
    again = made
    if measured.any():
        again, _ = _refine(np.array([plain(geometry, False, m) for geometry, m in zip(given, measured)]), space, settings, [])
    for i, geometry in enumerate(made):
        rows = _coordinates(geometry, geometry.has_z, False) / scale[: 2 + geometry.has_z]
        if measured[i]:
            other = _coordinates(again[i], True, False)
            if len(other) != len(rows):
                raise Unsupported(f"geometry {i}: measures and heights differ in their points; shapely.force_2d() drops both")
            rows = np.column_stack([rows, other[:, 2]])
        made[i] = _rebuilt(geometry, rows, geometry.has_z, measured[i])
    return made, done


def _coordinates(geometry: Any, z: bool, m: bool) -> Any:
    import shapely

    return shapely.get_coordinates(geometry, include_z=z, include_m=True) if m else shapely.get_coordinates(geometry, include_z=z)


def _rebuilt(geometry: Any, rows: Any, z: bool, m: bool) -> Any:
    """A geometry with other coordinates, by way of WKB."""
    import shapely

    flat, begin = np.ascontiguousarray(rows, float), 0

    def points(count: int) -> bytes:
        nonlocal begin
        begin += count
        return flat[begin - count : begin].tobytes()

    def written(part: Any) -> bytes:
        kind = {0: 1, 1: 2, 2: 2}.get(part_kind := int(shapely.get_type_id(part)), part_kind)
        head = struct.pack("<BI", 1, kind + 1000 * z + 2000 * m)
        if kind == 1:
            return head + (points(1) if not part.is_empty else np.full(flat.shape[1], np.nan).tobytes())
        if kind == 2:
            return head + struct.pack("<I", len(part.coords)) + points(len(part.coords))
        if kind == 3:
            rings = [] if part.is_empty else [part.exterior, *part.interiors]
            return head + struct.pack("<I", len(rings)) + b"".join(written(ring)[5:] for ring in rings)
        return head + struct.pack("<I", len(part.geoms)) + b"".join(map(written, part.geoms))

    return shapely.from_wkb(written(geometry))


def _refine(given: Any, space: str, settings: dict[str, Any], notes: list[str]) -> tuple[Any, Report]:
    """Refine geometries by the way that files take: as GeoJSON, which is read as the program reads it."""
    import shapely

    features = ",".join(f'{{"type":"Feature","properties":null,"geometry":{text}}}' for text in shapely.to_geojson(given))
    whole = f'{{"type":"FeatureCollection","features":[{features}]}}'.encode()
    free = lib.bat_curve_set_free
    coarse, fine = ffi.gc(ffi.new("bat_curve_set *"), free), ffi.gc(ffi.new("bat_curve_set *"), free)
    found = ffi.new("bat_curve_map_refine_report *")
    how = options("bat_curve_map_refine_options", settings)
    how.report = found
    reading = options("bat_curve_read_options", {"format": "geojson", "space": space})
    call(lib.bat_curve_read_memory, whole, len(whole), reading, coarse)
    try:
        call(lib.bat_curve_map_refine, coarse, how, fine)
    except BattenError as error:
        if error.curve is not None:
            features = _features(_arrays(coarse, -1)[4], _curve_counts(given))
            curve, error.curve = error.curve, None if features is None else int(features[error.curve])
            error.args = (error.args[0].replace(f"curve {curve}", "a curve" if features is None else f"feature {error.curve}", 1),)
        raise
    while note := lib.bat_curve_set_note(coarse, len(notes)):
        notes.append(ffi.string(note).decode())
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
    points, offsets, closed, polygon, feature = _arrays(fine, decimals if space == "sphere" else -1)
    points = points[: offsets[-1], :2]
    kinds, expected = shapely.get_type_id(given), _curve_counts(given)
    feature = _features(feature, expected)
    if feature is None:
        return given.copy(), np.ones(len(given), np.bool_)
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


def _curve_counts(given: Any) -> Any:
    """The numbers of lines and rings of geometries."""
    import shapely

    parts, owner = shapely.get_parts(given, return_index=True)
    return np.bincount(owner, np.where(shapely.get_type_id(parts) == 3, shapely.get_num_interior_rings(parts) + 1, 1), len(given))


def _features(feature: Any, expected: Any) -> Any:
    """The geometry of each curve; None where it is not known, since some are no polygons and some were dropped or joined."""
    if (feature >= 0).all():
        return feature
    return np.repeat(np.arange(len(expected)), expected.astype(np.int64)) if expected.sum() == len(feature) else None


def _arrays(curves: Any, decimals: int) -> tuple[Any, Any, Any, Any, Any]:
    """Of a set of curves: points, in degrees with so many decimals unless these are negative; offsets; which are closed; their
    polygons and features, -1 for none."""
    count, width = curves.count, 2 if decimals >= 0 else curves.space.point_dim
    points, offsets = np.empty((lib.batten_set_points(curves), width)), np.empty(count + 1, np.int64)
    closed, polygon, feature = np.empty(count, np.bool_), np.empty(count, np.int64), np.empty(count, np.int64)
    lib.batten_set_arrays(curves, decimals, pointer(points), pointer(offsets, "int64_t[]"), pointer(closed, "bool[]"),
                          pointer(polygon, "int64_t[]"), pointer(feature, "int64_t[]"))  # fmt: skip
    return points, offsets, closed, polygon, feature


def _renumbered(indices: Any) -> Any:
    """Increasing indices as 0, 1, 2, … without gaps."""
    return np.cumsum(np.diff(indices, prepend=indices[:1]) > 0)
