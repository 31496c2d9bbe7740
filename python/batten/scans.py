"""Scans: points from files."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from batten._core import (BadFile, BattenError, BattenWarning, Floats, InvalidArgument, InvalidPoint, OutOfMemory, Unsupported,
                          call_on_file, check_options, ffi, lib, options, take)  # fmt: skip
from batten.meshes import Mesh, warn_of

#: Points that are decoded at once.
_CHUNK = 1 << 20
#: Odd factors of the keys of coordinates: parts of the golden ratio, of pi and of e.
_FACTORS = np.array([0x9E3779B97F4A7C15, 0x243F6A8885A308D3, 0xB7E151628AED2A6B], np.uint64)
#: Classes of LAS that are noise.
_NOISE = (7, 18)
#: The bits of the point format in LAS, at this place, that compression sets.
_AT_FORMAT, _COMPRESSED = 104, 0xC0
#: Coordinates of E57, and what marks invalid ones.
_E57_FIELDS = {("cartesianX", "cartesianY", "cartesianZ"): "cartesianInvalidState",
               ("sphericalRange", "sphericalAzimuth", "sphericalElevation"): "sphericalInvalidState"}  # fmt: skip


def read_points(path: str | os.PathLike[str], *, classes: int | Iterable[int] | str | None = None, format: str = "auto",
                strict: bool = False) -> Floats:  # fmt: skip
    """Read the points of a scan, of any format of the program, LAZ or E57.

    LAZ needs the packages laspy and lazrs, E57 pye57; the extra ``scans`` installs them. Scans of E57 are moved by their
    poses and joined. What is left out is told by warnings.

    Parameters
    ----------
    path : str or path
        A file. Of a mesh, the vertices are read.
    classes : int, sequence of int or str, optional
        The classes of LAS and LAZ that are read, as ``2`` for ground or ``"2,8"``; by default all but 7 and 18, noise.
    format : str
        One of ``choices("cloud_format")``; by default as the ending and the content tell.
    strict : bool
        Refuse points that repeat an earlier one, instead of leaving them out.

    Returns
    -------
    ndarray of shape (n, 3)

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "scan.xyz"
    ...     _ = file.write_text("494797.94 5420662.00 277.47\\n494797.81 5420659.50 277.59\\n")
    ...     batten.read_points(file)[0].tolist()
    [494797.94, 5420662.0, 277.47]
    """
    return read_scan(path, classes, format, strict)[0]


def read_scan(path: str | os.PathLike[str], classes: int | Iterable[int] | str | None = None, format: str = "auto",
              strict: bool = False) -> tuple[Floats, NDArray[Any] | None, int, Any]:  # fmt: skip
    """Points in the order of a file, the triangles of a patch, the number of leading points that are its boundary, and corners;
    None where the file has none."""
    settings = {"format": format, "strict": strict}
    if classes is not None:
        settings["classes"] = classes if isinstance(classes, str) else ",".join(map(str, classes if np.iterable(classes) else [classes]))
    check_options("bat_cloud_read_options", settings)
    found = _kind(path) if format in ("auto", "las") else None
    if found is None or (format == "las" and found is _e57_parts):
        return _by_library(path, settings)
    if classes is not None and found is _e57_parts:
        raise _failure(InvalidArgument, path, "only points of LAS files have classes")
    counts: dict[str, int] = {}
    parts: list[Floats] = []
    try:
        for part in found(path, settings.get("classes"), counts):
            finite = np.isfinite(part).all(axis=1)
            _count(counts, "that are not finite", ~finite)
            parts.append(part[finite])
    except (BattenError, OSError):
        raise
    except MemoryError as error:
        raise _failure(OutOfMemory, path, "there is not enough memory for its points") from error
    except Exception as error:  # these packages have no common class of failures
        raise _failure(BadFile, path, f"the file is damaged: {str(error).partition(chr(10))[0]}") from error
    points = np.concatenate([np.empty((0, 3)), *parts])
    repeated = _repeated(points)
    if strict and len(repeated):
        raise _failure(InvalidPoint, path, f"{len(repeated)} points repeat an earlier one")
    if len(points) == 0:
        raise _failure(BadFile, path, "; ".join(["there are no points", *(f"{n} {what} are left out" for what, n in counts.items() if n)]))
    counts["that repeat an earlier one"] = len(repeated)
    for what, count in counts.items():
        if count:
            warnings.warn(f"{count} points {what} are left out", BattenWarning, stacklevel=3)
    return np.delete(points, repeated, axis=0) if len(repeated) else points, None, 0, None


def _by_library(path: str | os.PathLike[str], settings: dict[str, Any]) -> tuple[Floats, NDArray[Any] | None, int, Any]:
    cloud, notes = ffi.gc(ffi.new("bat_cloud *"), lib.bat_cloud_free), ffi.gc(ffi.new("bat_mesh_notes *"), lib.bat_mesh_notes_free)
    how = options("bat_cloud_read_options", settings)
    how.notes = notes
    try:
        call_on_file(lib.bat_cloud_read, path, how, cloud)
    except BattenError as error:
        if error.remedy != "shell":  # which any mesh becomes
            raise
        mesh = Mesh.read(path, format=settings["format"])
        return mesh.vertices, mesh.faces, 0, None
    warn_of(notes, 5)
    if cloud.duplicates:
        warnings.warn(f"{cloud.duplicates} points that repeat an earlier one are left out", BattenWarning, stacklevel=4)
    count, triangles = cloud.count, cloud.triangle_count
    place = np.argsort(order_of(cloud))
    rank = np.empty_like(place)
    rank[place] = np.arange(count)
    points, cloud.points = take(cloud.points, (count, 3))[place], ffi.NULL
    faces, cloud.triangles = rank[take(cloud.triangles, (triangles, 3), np.uint32)] if triangles else None, ffi.NULL
    corners = rank[list(cloud.corners)] if cloud.has_corners else None
    return points, faces, 0 if triangles else cloud.boundary_count, corners


def order_of(cloud: Any) -> Any:
    """The index in the input of each point of a cloud."""
    if cloud.order == ffi.NULL:
        return np.arange(cloud.count)
    return np.array(ffi.unpack(cloud.order, cloud.count), np.int64)


def _failure(kind: type[BattenError], path: str | os.PathLike[str], text: str) -> BattenError:
    return kind(f"{os.fsdecode(path)}: {text}")


def _count(counts: dict[str, int], what: str, rows: NDArray[np.bool_]) -> None:
    counts[what] = counts.get(what, 0) + int(rows.sum())


def _repeated(points: Floats) -> NDArray[np.int64]:
    """The rows that repeat an earlier one. Keys of rows are sorted first, which is faster than rows."""
    bits = (points + 0.0).view(np.uint64)  # zero has one sign
    keys = ((bits ^ (bits >> np.uint64(29))) * _FACTORS).sum(axis=1, dtype=np.uint64)
    ordered = np.sort(keys)
    suspects = np.flatnonzero(np.isin(keys, ordered[1:][ordered[1:] == ordered[:-1]]))
    rows = points[suspects]
    order = np.lexsort(rows.T)
    return np.sort(suspects[order[1:][(rows[order[1:]] == rows[order[:-1]]).all(axis=1)]])


def _kind(path: str | os.PathLike[str]) -> Any:
    """The reader of a file that the library does not read, by its first bytes."""
    if not os.path.isfile(path):  # a pipe gives its bytes once
        return None
    try:
        with open(path, "rb") as file:
            head = file.read(_AT_FORMAT + 1)
    except OSError:  # the library tells it
        return None
    if head.startswith(b"ASTM-E57"):
        return _e57_parts
    return _laz_parts if head.startswith(b"LASF") and len(head) > _AT_FORMAT and head[_AT_FORMAT] & _COMPRESSED else None


def _laz_parts(path: str | os.PathLike[str], classes: str | None, counts: dict[str, int]) -> Iterator[Floats]:
    """Points of compressed LAS, with the rules of the library's reader of LAS."""
    try:
        import laspy
        import lazrs  # noqa: F401
    except ImportError as error:
        raise _failure(Unsupported, path, "compressed LAS (LAZ) needs the packages laspy and lazrs: pip install 'batten[scans]'") from error
    wanted = np.ones(256, bool)
    wanted[list(_NOISE)] = False
    if classes is not None:
        wanted[:] = False
        wanted[[int(number) for number in classes.split(",")]] = True
    with laspy.open(os.fsdecode(path)) as file:
        scale, offset = np.array(file.header.scales), np.array(file.header.offsets)
        if not (np.isfinite([scale, offset]).all() and scale.all()):
            raise _failure(BadFile, path, "a scale or an offset of the header is zero or not finite")
        count = 0
        for part in file.chunk_iterator(_CHUNK):
            count += len(part)
            withheld, named = np.asarray(part.withheld, bool), wanted[np.asarray(part.classification)]
            _count(counts, "that are withheld", withheld)
            _count(counts, "of the classes 7 and 18, noise," if classes is None else "of other classes", ~withheld & ~named)
            yield (np.stack([part.X, part.Y, part.Z], axis=1) * scale + offset)[~withheld & named]
        if count != file.header.point_count:
            raise _failure(BadFile, path, f"the file ends after {count} of {file.header.point_count} points")


def _e57_parts(path: str | os.PathLike[str], _: str | None, counts: dict[str, int]) -> Iterator[Floats]:
    """Points of all scans of an E57 file, moved by their poses: ASTM E2807."""
    try:
        import pye57
    except ImportError as error:
        raise _failure(Unsupported, path, "E57 needs the package pye57: pip install 'batten[scans]'") from error
    with pye57.E57(os.fsdecode(path)) as file:
        for i in range(file.scan_count):
            scan = file.get_header(i)
            fields = next((fields for fields in _E57_FIELDS if {*fields} <= {*scan.point_fields}), None)
            if fields is None:
                raise _failure(BadFile, path, f"scan {i} has no coordinates")
            state = _E57_FIELDS[fields]
            names = [*fields, state] if state in scan.point_fields else fields
            arrays, buffers = file.make_buffers(names, min(_CHUNK, max(scan.point_count, 1)))
            reader, move = scan.points.reader(buffers), _pose(scan.node)
            while count := reader.read():
                part = np.stack([arrays[name][:count] for name in fields], axis=1)
                if fields[0] == "sphericalRange":
                    r, azimuth, elevation = part.T
                    part = np.stack([r * np.cos(elevation) * np.cos(azimuth), r * np.cos(elevation) * np.sin(azimuth),
                                     r * np.sin(elevation)], axis=1)  # fmt: skip
                valid = arrays[state][:count] == 0 if state in arrays else np.ones(count, bool)
                _count(counts, "that are invalid", ~valid)
                yield move(part[valid])
            reader.close()


def _pose(scan: Any) -> Any:
    """The rigid motion of a scan of E57: the rotation of its quaternion, then its translation."""

    def numbers(name: str, parts: str, default: list[float]) -> Floats:
        there = scan.isDefined("pose") and scan["pose"].isDefined(name)
        return np.array([scan["pose"][name][part].value() for part in parts] if there else default, float)

    q, t = numbers("rotation", "wxyz", [1, 0, 0, 0]), numbers("translation", "xyz", [0, 0, 0])
    if not (np.isfinite(q).all() and np.isfinite(t).all() and q.any()):
        raise ValueError("the pose of a scan is not finite, or its quaternion zero")
    w, axis = q[0] / np.linalg.norm(q), q[1:] / np.linalg.norm(q)

    def move(points: Floats) -> Floats:
        twice = 2 * np.cross(axis, points)
        moved: Floats = points + w * twice + np.cross(axis, twice) + t
        return moved

    return move
