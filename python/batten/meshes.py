"""Meshes: refinement, decimation with its map, repair, pictures."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from batten._core import (BattenWarning, Floats, Progress, Report, array, call, call_on_file, check_options, drawn, ffi, hint, kept, lib, options, pointer, report, Rows, set_field, shown,
                          take, takes, written)  # fmt: skip
from batten._trimesh import UNNAMED, Parts, each, is_scene, is_trimesh
from batten.curves import axes_of, equal

if TYPE_CHECKING:
    from typing_extensions import Self

_CREASE = np.dtype([("a", np.uint32), ("b", np.uint32), ("sharpness", np.float64)], align=True)
_CORNER = np.dtype([("vertex", np.uint32), ("sharpness", np.float64)], align=True)
_POINT = np.dtype([("face", np.uint32), ("barycentric", np.float64, 3)], align=True)
_CLOSEST = np.dtype([("at", _POINT), ("position", np.float64, 3), ("distance", np.float64)], align=True)
Indices = NDArray[np.uint32]


#: The names of a label.
_LABEL = ("object", "group", "material", "smoothing")
#: Parts of a mesh beside its geometry.
_REST = ("channel_names", "face_labels", "labels", "material_files", "material_json", "rules")


class _Faces:
    """What triangle meshes and polygon meshes share: all but how faces lie in arrays."""

    _polygons: bool  # whether faces may have any number of corners
    vertices: Floats
    faces: Any
    channels: Floats | None
    texture: Floats | None
    texture_faces: Any
    creases: NDArray[Any]
    corners: NDArray[Any]
    vertex_normals: Floats | None = None
    channel_names: list[str] | None
    labels: list[Any] | None
    face_labels: Indices | None
    material_files: str | None
    material_json: str | None
    rules: dict[str, str] | None

    def _fill(self, vertices: Rows, channels: ArrayLike | None, texture: ArrayLike | None, creases: Any, corners: Any,
              rest: dict[str, Any]) -> None:
        """Check and set what is not faces."""
        self.vertices = array(vertices, "vertices", 3)
        self.channels = None if channels is None else array(channels, "channels", 0)
        self.texture = None if texture is None else array(texture, "texture", 2)
        self.creases, self.corners = _features(creases, _CREASE), _features(corners, _CORNER)
        for name, rows in (("channels", self.vertices), ("texture_faces", self.faces)):
            if getattr(self, name) is not None and len(getattr(self, name)) != len(rows):
                raise ValueError(f"{name}: {len(rows)} rows are needed")
        if (self.texture is None) != (self.texture_faces is None):
            raise ValueError("texture and texture_faces go together")
        for name in _REST:
            setattr(self, name, rest.pop(name, None))
        if self.face_labels is not None:
            self.face_labels = array(self.face_labels, "face_labels", None, np.uint32)
            if self.face_labels.shape != (self._face_count(),):
                raise ValueError(f"face_labels: {self._face_count()} numbers are needed")
        if self.channel_names is not None and len(self.channel_names) != (0 if self.channels is None else self.channels.shape[1]):
            raise ValueError("channel_names: a text for each channel is needed")
        if rest:
            name, known = next(iter(rest)), {"channels", "texture", "texture_faces", "creases", "corners", *_REST}
            raise TypeError(f"unknown part of a mesh: '{name}'; {hint(name, known)}")

    def _face_count(self) -> int:
        return len(self.faces)

    def _with(self, name: str, value: Any) -> Self:
        """The same mesh with another part."""
        made, parts = object.__new__(type(self)), dict(self.__dict__)
        made.__dict__.update(parts)
        made._fill(self.vertices, **{k: value if k == name else parts[k] for k in ("channels", "texture", "creases", "corners")},
                   rest={k: parts[k] for k in _REST if k != "channel_names" or name != "channels"})  # fmt: skip
        return made

    def _rows(self, given: Any, counts: tuple[int, int], triangles: bool) -> None:
        """Take the faces, and those of the texture, from a struct of so many faces and texture coordinates, whose faces are
        triangles or else have offsets."""
        raise NotImplementedError

    @classmethod
    @takes("bat_mesh_read_options")
    def read(cls, path: str | os.PathLike[str], **settings: Any) -> Self:
        """Read a file. What the file holds and a mesh cannot is told by warnings."""
        made, notes = ffi.new("bat_mesh *"), ffi.gc(ffi.new("bat_mesh_notes *"), lib.bat_mesh_notes_free)
        how = options("bat_mesh_read_options", settings)
        how.notes, how.polygons = notes, cls._polygons
        call_on_file(lib.bat_mesh_read, path, how, made)
        warn_of(notes)
        return cls._from(made)

    @takes("bat_mesh_write_options")
    def write(self, path: str | os.PathLike[str], *, vertex_normals: ArrayLike | None = None, **settings: Any) -> None:
        """Write a file, whose ending chooses the format of ``batten.choices("mesh_format")``."""
        notes = ffi.gc(ffi.new("bat_mesh_notes *"), lib.bat_mesh_notes_free)
        how = options("bat_mesh_write_options", settings)
        normals = self.vertex_normals if vertex_normals is None else array(vertex_normals, "vertex_normals", 3)
        if normals is not None and len(normals) != len(self.vertices):
            raise ValueError(f"vertex_normals: {len(self.vertices)} rows are needed")
        how.notes, how.vertex_normals = notes, pointer(normals)
        call_on_file(lib.bat_mesh_write, path, self._struct(), how)
        warn_of(notes)

    @classmethod
    def _from(cls, struct: Any) -> Self:
        """The mesh in a struct, which gives away its arrays."""
        mesh, owned = object.__new__(cls), ffi.gc(struct, lib.bat_mesh_free)

        def given(name: str, shape: tuple[int, ...], dtype: Any = np.float64) -> Any:
            memory = getattr(owned, name)
            setattr(owned, name, ffi.NULL)
            return take(memory, shape, dtype)

        vertices, faces, width = owned.vertex_count, owned.face_count, owned.channel_count
        mesh.channel_names = [_text(owned.channel_names[i]) for i in range(width)] if width else None
        count = owned.label_count
        named = count and bytes(ffi.buffer(owned.labels, count * ffi.sizeof("bat_mesh_label"))).strip(b"\0")
        rows = [owned.labels[i] for i in range(count)] if named else []
        mesh.labels = [Report((name, _text(getattr(row, name))) for name in _LABEL) for row in rows] or [UNNAMED] * count
        mesh.material_files, mesh.material_json = _text(owned.material_files), _text(owned.material_json)
        mesh.rules = dict(report(owned.rules)) if bytes(ffi.buffer(ffi.addressof(owned, "rules"))).strip(b"\0") else None
        mesh._rows(given, (faces, owned.texture_count), owned.offsets == ffi.NULL)
        mesh.vertices = given("positions", (vertices, 3))
        mesh.channels = given("channels", (vertices, width)) if width else None
        mesh.texture = given("texture", (owned.texture_count, 2)) if owned.texture_count else None
        mesh.creases = given("creases", (owned.crease_count,), _CREASE)
        mesh.corners = given("corners", (owned.corner_count,), _CORNER)
        mesh.face_labels = given("face_labels", (faces,), np.uint32) if owned.face_labels else None
        return mesh

    def _struct(self) -> Any:
        struct, keep = ffi.new("bat_mesh *"), []

        def text(value: str | None) -> Any:
            keep.append(ffi.NULL if value is None else ffi.new("char[]", value.encode()))
            return keep[-1]

        def rows(name: str, values: Any, kind: str, count: str | None = None) -> None:
            if values is not None:
                keep.append(ffi.cast(f"{kind} *", pointer(values, f"{kind}[]")) if len(values) else ffi.NULL)
                keep.append(values)
                setattr(struct, name, keep[-2])
                if count:
                    setattr(struct, count, len(values))

        rows("positions", self.vertices, "double", "vertex_count")
        rows("faces", self.faces, "uint32_t")
        struct.face_count = self._face_count()
        if hasattr(self, "offsets"):
            rows("offsets", self.offsets, "uint32_t")
        rows("texture", self.texture, "double", "texture_count")
        rows("texture_faces", self.texture_faces, "uint32_t")
        rows("channels", self.channels, "double")
        rows("creases", self.creases, "bat_mesh_crease", "crease_count")
        rows("corners", self.corners, "bat_mesh_corner", "corner_count")
        rows("face_labels", self.face_labels, "uint32_t")
        if self.channels is not None:
            struct.channel_count = self.channels.shape[1]
            names = self.channel_names or [f"channel{i}" for i in range(struct.channel_count)]
            keep.append(ffi.new("char *[]", [text(name) for name in names]))
            struct.channel_names = keep[-1]
        if self.labels:
            named = any(label is not UNNAMED for label in self.labels)
            keep.append(ffi.new("bat_mesh_label[]", len(self.labels)) if not named else ffi.new("bat_mesh_label[]", [{name: text(label.get(name)) for name in _LABEL} for label in self.labels]))
            struct.labels, struct.label_count = keep[-1], len(self.labels)
        for name, value in (self.rules or {}).items():
            set_field(struct.rules, name, value)
        struct.material_files, struct.material_json = text(self.material_files), text(self.material_json)
        kept[struct] = keep
        return struct

    def __iter__(self) -> Iterator[NDArray[Any]]:
        return iter((self.vertices, self.faces))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self.vertices)} vertices, {self._face_count()} faces>"


class Mesh(_Faces):
    """A triangle mesh. ``vertices, faces = mesh`` takes it apart.

    Parameters
    ----------
    vertices : array_like of shape (n, 3)
    faces : array_like of shape (m, 3)
        The vertices at each face's corners, counter-clockwise from outside.
    channels : array_like of shape (n, k), optional
        Further values at the vertices, such as colours.
    texture, texture_faces : array_like of shape (t, 2) and (m, 3), optional
        Texture coordinates, and those at each face's corners.
    creases : sequence of (a, b, sharpness), optional
        Edges that Loop's scheme keeps sharp.
    corners : sequence of (vertex, sharpness), optional
        Vertices that it keeps sharp.
    channel_names : list of str, optional
    face_labels : array_like of shape (m,), optional
        The row of `labels` of each face.
    labels : list of dict, optional
        Names that faces share: `object`, `group`, `material`, `smoothing`.
    material_files, material_json : str, optional
        The files of the materials of OBJ; the materials of glTF.
    rules : dict, optional
        What the mesh says about its refinement: `boundary`, `creasing` and `linear`, as of :func:`refine_mesh`.

    Attributes
    ----------
    vertex_normals : ndarray or None
        Normals of the limit surface, where :func:`refine_mesh` was called with `limit_normals`.

    Examples
    --------
    >>> tetrahedron = batten.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> tetrahedron
    <Mesh of 4 vertices, 4 faces>
    """

    _polygons = False
    faces: Indices
    texture_faces: Indices | None

    def __init__(self, vertices: Rows, faces: ArrayLike, *, channels: ArrayLike | None = None,
                 texture: ArrayLike | None = None, texture_faces: ArrayLike | None = None, creases: Any = (),
                 corners: Any = (), **rest: Any) -> None:
        self.faces = array(faces, "faces", 3, np.uint32)
        self.texture_faces = None if texture_faces is None else array(texture_faces, "texture_faces", 3, np.uint32)
        self._fill(vertices, channels, texture, creases, corners, rest)

    @classmethod
    def of(cls, mesh: Any, faces: ArrayLike | None = None) -> Mesh:
        """A mesh from a pair of arrays, or from anything with `vertices` and `faces`, such as a ``trimesh.Trimesh``."""
        if faces is not None:
            return cls(mesh, faces)
        if isinstance(mesh, Mesh):
            return mesh
        if isinstance(mesh, PolygonMesh):
            return mesh.triangulate()
        if is_trimesh(mesh) and hasattr(mesh, "faces"):
            return Parts(mesh).mesh(cls, by_face=False)
        if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
            return cls(mesh.vertices, mesh.faces)
        if isinstance(mesh, tuple) and len(mesh) == 2:
            return cls(*mesh)
        if is_scene(mesh):
            raise TypeError("a mesh is needed, not a scene: scene.to_mesh() joins its meshes")
        raise TypeError(f"a mesh is needed: vertices and faces, not {type(mesh).__name__}")

    def _rows(self, given: Any, counts: tuple[int, int], triangles: bool) -> None:
        self.faces = given("faces", (counts[0], 3), np.uint32)
        self.texture_faces = given("texture_faces", (counts[0], 3), np.uint32) if counts[1] else None

    def repair(self) -> Mesh:
        """A mesh whose faces form a manifold: repeated faces go, edges of more than two faces are cut. Warns of changes."""
        made, done = ffi.new("bat_mesh *"), ffi.new("bat_mesh_repair_report *")
        call(lib.bat_mesh_repair, self._struct(), done, made)
        if lib.bat_mesh_repair_places(done):
            changes = ", ".join(f"{name.replace('_', ' ')}: {n}" for name, n in report(done).items() if n)
            warnings.warn(f"the mesh was repaired ({changes})", BattenWarning, stacklevel=2)
        return Mesh._from(made)

    def weld(self, distance: float = 0.0) -> Mesh:
        """A mesh in which vertices within a distance of each other are one."""
        made = ffi.new("bat_mesh *")
        call(lib.bat_mesh_weld, self._struct(), distance, ffi.NULL, made)
        return Mesh._from(made)

    def closest(self, points: ArrayLike, threads: int = 0) -> Report:
        """The closest points of the mesh: `position`, `distance`, `face` and `barycentric` coordinates in it."""
        rows = array(points, "points", 3)
        found = np.empty(len(rows), _CLOSEST)
        call(lib.bat_mesh_closest, self._struct(), pointer(rows), len(rows), threads,
             ffi.from_buffer("bat_mesh_closest_point[]", found))  # fmt: skip
        return Report(position=found["position"], distance=found["distance"], face=found["at"]["face"],
                      barycentric=found["at"]["barycentric"])  # fmt: skip

    def normals(self, threads: int = 0) -> Floats:
        """Unit normals of the limit surface of Loop's scheme at the vertices."""
        made = np.empty_like(self.vertices)
        call(lib.bat_mesh_limit_normals, self._struct(), threads, pointer(made))
        return made

    def plot(self, ax: Any = None, *, interactive: bool = False, **style: Any) -> Any:
        """Draw the mesh with matplotlib; returns the axes. With `interactive`, by pyvista or k3d where they are installed;
        returns pyvista's plotter, whose ``show()`` shows it, or k3d's plot, which a notebook shows."""
        if interactive:
            return _interactive(self, style)
        axes = axes_of(ax, 3)
        axes.plot_trisurf(*self.vertices.T, triangles=self.faces, **style)
        return equal(axes)

    @takes("bat_mesh_picture_options")
    def picture(self, values: ArrayLike | None = None, *, suffix: str = "png", wires: bool = False, flat: bool = False,
                **settings: Any) -> bytes:
        """A shaded picture by the library, as the bytes of a file (png, svg or pdf). `values` at the vertices are shown as
        colours."""
        shown_values = None if values is None else array(values, "values", None)
        if shown_values is not None and shown_values.shape != (len(self.vertices),):
            raise ValueError(f"values: {len(self.vertices)} numbers are needed")
        struct = self._struct()  # alive during the call
        panel = ffi.new("bat_mesh_picture_panel *", [struct, ffi.NULL, pointer(shown_values), wires, flat])
        return written(lib.bat_mesh_picture_write, suffix, panel, 1, options("bat_mesh_picture_options", settings))

    @drawn
    def _repr_png_(self) -> bytes | None:
        return self.picture(wires=len(self.faces) <= 5000) if len(self.faces) else None


class PolygonMesh(_Faces):
    """A mesh of polygons, such as the quads of Catmull and Clark's scheme. ``vertices, faces = mesh`` takes it apart.

    Parameters
    ----------
    vertices : array_like of shape (n, 3)
    faces : array_like of shape (m, k), or a list of sequences
        The vertices at each face's corners, counter-clockwise from outside.
    texture_faces : array_like, optional
        As `faces`.
    **rest
        The other parts of a :class:`Mesh`.

    Attributes
    ----------
    faces, texture_faces : ndarray
        One behind the other.
    offsets : ndarray
        Face i has the corners ``offsets[i]`` to ``offsets[i + 1] - 1``.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    >>> quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    >>> batten.PolygonMesh(cube, quads)
    <PolygonMesh of 8 vertices, 6 faces>
    """

    _polygons = True
    offsets: Indices

    def __init__(self, vertices: Rows, faces: Any, *, channels: ArrayLike | None = None, texture: ArrayLike | None = None,
                 texture_faces: Any = None, creases: Any = (), corners: Any = (), **rest: Any) -> None:
        self.faces, self.offsets = _polygons(faces, "faces")
        self.texture_faces, ends = (None, self.offsets) if texture_faces is None else _polygons(texture_faces, "texture_faces")
        if not np.array_equal(ends, self.offsets):
            raise ValueError("texture_faces: as many corners as the faces have are needed")
        self._fill(vertices, channels, texture, creases, corners, rest)

    @classmethod
    def of(cls, mesh: Any, faces: Any = None) -> PolygonMesh:
        """A mesh of polygons from vertices and faces, or of the triangles of what :meth:`Mesh.of` takes."""
        if faces is not None:
            return cls(mesh, faces)
        if isinstance(mesh, PolygonMesh):
            return mesh
        if isinstance(mesh, tuple) and len(mesh) == 2:
            return cls(*mesh)
        made, triangles = ffi.new("bat_mesh *"), Mesh.of(mesh)
        call(lib.bat_mesh_triangulate, triangles._struct(), made)
        return cls._from(made)

    def _face_count(self) -> int:
        return len(self.offsets) - 1

    def _rows(self, given: Any, counts: tuple[int, int], triangles: bool) -> None:
        ends = np.arange(counts[0] + 1, dtype=np.uint32) * np.uint32(3)
        self.offsets = ends if triangles else given("offsets", (counts[0] + 1,), np.uint32)
        corners = int(self.offsets[-1])
        self.faces = given("faces", (corners,), np.uint32)
        self.texture_faces = given("texture_faces", (corners,), np.uint32) if counts[1] else None

    def __iter__(self) -> Iterator[Any]:
        """Vertices, and faces as an array of shape (m, k), or as a list of arrays where they have different numbers of
        corners."""
        sizes = np.diff(self.offsets)
        uniform = len(sizes) > 0 and (sizes == sizes[0]).all()
        return iter((self.vertices, self.faces.reshape(-1, sizes[0]) if uniform else np.split(self.faces, self.offsets[1:-1])))

    def triangulate(self) -> Mesh:
        """The mesh with its polygons cut into triangles."""
        made = ffi.new("bat_mesh *")
        call(lib.bat_mesh_triangulate, self._struct(), made)
        return Mesh._from(made)

    def normals(self, threads: int = 0) -> Floats:
        """Unit normals of the limit surface of Catmull and Clark's scheme at the vertices of a mesh of quads."""
        made = np.empty_like(self.vertices)
        call(lib.bat_mesh_limit_normals, self._struct(), threads, pointer(made))
        return made

    def plot(self, ax: Any = None, *, interactive: bool = False, **style: Any) -> Any:
        """Draw the mesh, as :meth:`Mesh.plot`."""
        return self.triangulate().plot(ax, interactive=interactive, **style)

    @takes("bat_mesh_picture_options")
    def picture(self, values: ArrayLike | None = None, *, suffix: str = "png", wires: bool = False, flat: bool = False,
                **settings: Any) -> bytes:
        """A shaded picture, as of :meth:`Mesh.picture`."""
        return self.triangulate().picture(values, suffix=suffix, wires=wires, flat=flat, **settings)

    @drawn
    def _repr_png_(self) -> bytes | None:
        return self.picture() if self._face_count() else None


def _interactive(mesh: Mesh, style: dict[str, Any]) -> Any:
    """A view of a mesh that can be turned."""
    try:
        import pyvista
    except ImportError:
        try:
            import k3d
        except ImportError:
            raise ImportError("interactive: one of the packages pyvista and k3d is needed") from None
        plot = k3d.plot()
        plot += k3d.mesh(mesh.vertices.astype(np.float32), mesh.faces, **style)
        return plot
    plotter = pyvista.Plotter()
    corners = np.insert(mesh.faces.astype(np.int64), 0, 3, axis=1)
    plotter.add_mesh(pyvista.PolyData(mesh.vertices, corners), **style)
    return plotter


def _polygons(faces: Any, name: str) -> tuple[Indices, Indices]:
    """Corners one behind the other, and the offsets of faces in them."""
    if isinstance(faces, (list, tuple)) and len({np.size(face) for face in faces}) > 1:
        rows = [array(face, f"{name}[{i}]", None, np.uint32).ravel() for i, face in enumerate(faces)]
        return np.concatenate(rows), np.cumsum([0, *map(len, rows)], dtype=np.uint32)
    square = array(faces, name, 0, np.uint32)
    return square.ravel(), np.arange(len(square) + 1, dtype=np.uint32) * np.uint32(square.shape[1])


def _text(memory: Any) -> Any:
    return None if memory == ffi.NULL else ffi.string(memory).decode(errors="replace")


def warn_of(notes: Any, stacklevel: int = 3) -> None:
    for i in range(notes.count):
        warnings.warn(_text(notes.texts[i]), BattenWarning, stacklevel=stacklevel)


def _features(rows: Any, kind: Any) -> NDArray[Any]:
    given = np.asarray([tuple(row) for row in rows], kind) if not isinstance(rows, np.ndarray) else rows
    return np.ascontiguousarray(given if given.dtype == kind else [tuple(row) for row in given.tolist()], kind)


_Mesh = TypeVar("_Mesh")


@overload
def refine_mesh(mesh: Rows, faces: Any, /, *, limit_normals: bool = False, channels: ArrayLike | None = None, creases: Any = None,
                corners: Any = None, progress: Progress = False, **settings: Any) -> Mesh | Any: ...
@overload
def refine_mesh(mesh: tuple[ArrayLike, Any], faces: None = None, /, *, limit_normals: bool = False, channels: ArrayLike | None = None,
                creases: Any = None, corners: Any = None, progress: Progress = False, **settings: Any) -> Mesh | Any: ...
@overload
def refine_mesh(mesh: _Mesh, faces: None = None, /, *, limit_normals: bool = False, channels: ArrayLike | None = None,
                creases: Any = None, corners: Any = None, progress: Progress = False, **settings: Any) -> _Mesh: ...
@takes("bat_mesh_refine_options")
def refine_mesh(mesh: Any, faces: Any = None, /, *, limit_normals: bool = False, channels: ArrayLike | None = None,
                creases: Any = None, corners: Any = None, progress: Progress = False, **settings: Any) -> Any:
    """Refine a mesh by subdivision.

    Parameters
    ----------
    mesh : array_like of shape (n, 3), Mesh, PolygonMesh, trimesh.Trimesh or trimesh.Scene
        The vertices, or a whole mesh. Colours, texture coordinates and attributes of a trimesh are refined with it.
    faces : array_like of shape (m, 3) or (m, k), or a list of sequences, optional
        The vertices at each face's corners. Polygons are refined by Catmull and Clark's scheme.
    limit_normals : bool
        With ``limit=True`` and Loop's or Catmull and Clark's scheme at the end: give the mesh `vertex_normals`, those of the limit surface.
    channels, creases, corners
        As of :class:`Mesh`, in the place of those that the mesh has. Creases and corners go with a scene of one mesh, channels
        not with trimesh.
    progress : bool or callable
        As of :func:`refine`.
    **settings
        Fields of ``bat_mesh_refine_options``.

    Returns
    -------
    Mesh, PolygonMesh, trimesh.Trimesh or trimesh.Scene
        The last two where one came in.

    Examples
    --------
    >>> vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    >>> fine, triangles = batten.refine_mesh(vertices, faces, scheme="loop", levels=3)
    >>> fine.shape, triangles.shape
    ((130, 3), (256, 3))
    >>> cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    >>> quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    >>> batten.refine_mesh(cube, quads, levels=2)
    <PolygonMesh of 98 vertices, 96 faces>
    """
    if channels is not None and is_trimesh(mesh):
        raise TypeError("channels: meshes of trimesh carry vertex_attributes in their place")
    if is_scene(mesh):
        check_options("bat_mesh_refine_options", settings)
        parts = dict(limit_normals=limit_normals, progress=progress, **settings)
        several = sum(hasattr(part, "faces") for part in mesh.geometry.values()) > 1
        for name, value in (("creases", creases), ("corners", corners)):
            if value is not None and several:
                raise TypeError(f"{name}: a scene of one mesh is needed, whose vertices they number; refine the meshes of scene.geometry one by one")
        return each(mesh, lambda part: refine_mesh(part, creases=creases, corners=corners, **parts))
    theirs = Parts(mesh) if is_trimesh(mesh) else None
    coarse = _coarse(mesh if theirs is None else theirs.mesh(Mesh, by_face=True), faces, settings.get("scheme"))
    for name, part in (("creases", creases), ("corners", corners), ("channels", channels)):
        if part is not None:
            coarse = coarse._with(name, part)
    if theirs is not None:
        coarse.creases, coarse.corners = theirs.renumbered(coarse.creases, ("a", "b")), theirs.renumbered(coarse.corners, ("vertex",))
    fine, fallback = ffi.new("bat_mesh *"), ffi.new("size_t *")
    how, normals = options("bat_mesh_refine_options", settings), ffi.new("double **")
    how.limit_normals = normals if limit_normals else ffi.NULL
    with shown(progress, "refining"):
        call(lib.bat_mesh_refine, coarse._struct(), how, fine, fallback)
    if fallback[0]:
        warnings.warn(f"the learned scheme fell back to a classical one in {fallback[0]} places", BattenWarning, stacklevel=2)
    made = (PolygonMesh if fine.offsets != ffi.NULL else type(coarse))._from(fine)
    if normals[0] != ffi.NULL:
        made.vertex_normals = take(normals[0], made.vertices.shape)
    return made if theirs is None else theirs.refined(Mesh.of(made))


def _coarse(mesh: Any, faces: Any, scheme: Any) -> _Faces:
    """A mesh to refine: one of polygons where it has some, or where the scheme makes some."""
    corners = mesh[1] if faces is None and isinstance(mesh, tuple) and len(mesh) == 2 else faces
    polygons = isinstance(mesh, PolygonMesh) or scheme == "catmull-clark"
    if isinstance(corners, (list, tuple)):
        polygons |= any(isinstance(face, (list, tuple, np.ndarray)) and len(face) > 3 for face in corners)
    elif isinstance(corners, np.ndarray):
        polygons |= corners.ndim == 2 and corners.shape[1] > 3
    return (PolygonMesh if polygons else Mesh).of(mesh, faces)


class MeshMap:
    """The bijective map between a decimated mesh and the fine one. It is called with points of the coarse mesh.

    Attributes
    ----------
    fine, coarse : Mesh
        The two meshes.
    """

    fine: Mesh
    coarse: Mesh

    def __init__(self, fine: Mesh, coarse: Mesh, struct: Any) -> None:
        self.fine, self.coarse, self._map = fine, coarse, ffi.gc(struct, lib.bat_mesh_map_free)

    def __call__(self, points: ArrayLike, *, inverse: bool = False) -> Floats:
        """Positions on the fine mesh of points near the coarse one; with `inverse` the other way."""
        begin, end = (self.fine, self.coarse) if inverse else (self.coarse, self.fine)
        near = begin.closest(points)
        faces, weights = (self.to_coarse if inverse else self.to_fine)(near.face, near.barycentric)
        positions: Floats = np.einsum("nc,ncd->nd", weights, end.vertices[end.faces[faces]])
        return positions

    def _carry(self, function: Any, faces: ArrayLike, barycentric: ArrayLike) -> tuple[Indices, Floats]:
        weights = array(barycentric, "barycentric", 3)
        points = np.empty(len(weights), _POINT)
        given = array(faces, "faces", None, np.uint32)
        if given.shape != (len(weights),):
            raise ValueError(f"faces: {len(weights)} numbers are needed, not an array of shape {given.shape}")
        points["face"], points["barycentric"] = given, weights
        call(function, self._map, ffi.from_buffer("bat_mesh_point[]", points), len(points))
        return points["face"], points["barycentric"]

    def to_fine(self, faces: ArrayLike, barycentric: ArrayLike) -> tuple[Indices, Floats]:
        """Faces and barycentric coordinates on the fine mesh of points of the coarse one."""
        return self._carry(lib.bat_mesh_map_to_fine, faces, barycentric)

    def to_coarse(self, faces: ArrayLike, barycentric: ArrayLike) -> tuple[Indices, Floats]:
        """Faces and barycentric coordinates on the coarse mesh of points of the fine one."""
        return self._carry(lib.bat_mesh_map_to_coarse, faces, barycentric)

    def transfer(self, refined: Mesh | None = None, levels: int = 0) -> Mesh:
        """The coarse mesh, or its refinement by `levels` levels of a scheme that splits faces in four, with the texture and
        the channels of the fine mesh."""
        made = ffi.new("bat_mesh *")
        call(lib.bat_mesh_copy, (refined or self.coarse)._struct(), made)
        mesh = ffi.gc(made, lib.bat_mesh_free)
        call(lib.bat_mesh_map_transfer, self._map, self.fine._struct(), self.coarse._struct(), levels, mesh)
        ffi.gc(mesh, None)
        return Mesh._from(made)

    def __repr__(self) -> str:
        return f"<MeshMap from {len(self.coarse.faces)} to {len(self.fine.faces)} faces>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (self.fine, self.coarse, written(lib.bat_mesh_map_write, "map", self._map))


def _unpickled(fine: Mesh, coarse: Mesh, content: bytes) -> MeshMap:
    made = ffi.new("bat_mesh_map **")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "batten.map"
        file.write_bytes(content)
        call(lib.bat_mesh_map_read, bytes(file), fine._struct(), coarse._struct(), made)
    return MeshMap(fine, coarse, made[0])


class Decimation:
    """A decimated mesh, and its map to the fine one; ``mesh, map = batten.decimate(…)`` takes it apart.

    Attributes
    ----------
    mesh : Mesh, trimesh.Trimesh or trimesh.Scene
    map : MeshMap or None
        Of a scene, a dictionary of those of its meshes.
    bound : float or None
        With `error`: no point of either surface is farther than this from the other, which is proven.
    """

    mesh: Any
    map: Any
    bound: float | None

    def __init__(self, mesh: Any, map: Any, bound: float | None = None) -> None:
        self.mesh, self.map, self.bound = mesh, map, bound

    def __iter__(self) -> Iterator[Any]:
        return iter((self.mesh, self.map))

    def __repr__(self) -> str:
        return f"Decimation(mesh={self.mesh!r}, map={self.map!r}, bound={self.bound!r})"

    def plot(self, ax: Any = None, *, interactive: bool = False, **style: Any) -> Any:
        """Draw the decimated mesh, as :meth:`Mesh.plot`."""
        return Mesh.of(self.mesh).plot(ax, interactive=interactive, **style)

    @drawn
    def _repr_png_(self) -> bytes | None:
        return Mesh.of(self.mesh)._repr_png_()


@takes("bat_mesh_decimate_options")
def decimate(mesh: Any, triangles: ArrayLike | None = None, /, *, map: bool = True, progress: Progress = False,
             **settings: Any) -> Decimation:
    """Decimate a mesh by edge collapses, with a bijective map between both meshes.

    Parameters
    ----------
    mesh, triangles
        As of :func:`refine_mesh`. Vertices of a trimesh that seams of its texture split count once.
    map : bool
        False: no map, which is faster.
    progress : bool or callable
        As of :func:`refine`.
    **settings
        Fields of ``bat_mesh_decimate_options``.

    Returns
    -------
    Decimation
        The coarse mesh, a ``trimesh.Trimesh`` where one came in, and the map, which is called with points.

    Examples
    --------
    >>> corners, faces = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    >>> fine = batten.refine_mesh(corners, faces, scheme="loop", levels=4)
    >>> coarse, map = batten.decimate(fine, vertices=100)
    >>> coarse
    <Mesh of 100 vertices, 196 faces>
    >>> float(fine.closest(map(coarse.vertices)).distance.max()) < 1e-12
    True
    """
    how, bound = options("bat_mesh_decimate_options", settings), ffi.new("double *")
    if not {"vertices", "faces", "ratio", "tolerance"} & set(settings):
        raise TypeError("decimate needs one of vertices, faces, ratio and tolerance")
    if is_scene(mesh):
        check_options("bat_mesh_decimate_options", settings)
        found = {name: decimate(part, map=map, progress=progress, **settings) for name, part in mesh.geometry.items() if hasattr(part, "faces")}
        parts = iter(found.values())
        maps = {name: part.map for name, part in found.items()} if map else None
        bounds = [part.bound for part in found.values() if part.bound is not None]
        return Decimation(each(mesh, lambda _: next(parts).mesh), maps, max(bounds, default=None))
    theirs = Parts(mesh) if is_trimesh(mesh) else None
    fine, coarse = Mesh.of(mesh, triangles), ffi.new("bat_mesh *")
    made = ffi.new("bat_mesh_map **") if map or theirs else ffi.NULL
    how.distance = bound
    with shown(progress, "decimating"):
        call(lib.bat_mesh_decimate, fine._struct(), how, coarse, made)
    left = Mesh._from(coarse)
    most = how.faces or int(np.ceil(how.ratio * len(fine.faces)))
    for wanted, rows, name in ((how.vertices, left.vertices, "vertices"), (most, left.faces, "faces")):
        if 0 < wanted < len(rows):
            warnings.warn(f"decimation ends at {len(rows)} {name}, not {wanted}: no further edge can collapse", BattenWarning, stacklevel=2)
    way = MeshMap(fine, left, made[0]) if made != ffi.NULL else None
    return Decimation(left if theirs is None else theirs.decimated(left, way), way if map else None,
                      bound[0] if how.tolerance else None)  # fmt: skip
