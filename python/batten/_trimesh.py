"""Meshes and scenes of trimesh: what they have beside vertices and faces goes through refinement and decimation."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from batten._core import BattenWarning, Report, ffi, lib

if TYPE_CHECKING:
    from batten.meshes import Mesh, MeshMap

#: The label of faces without names.
UNNAMED = Report()


def is_trimesh(given: Any) -> bool:
    return any(base.__module__.split(".")[0] == "trimesh" for base in type(given).__mro__)


def is_scene(given: Any) -> bool:
    return is_trimesh(given) and hasattr(given, "geometry") and hasattr(given, "graph")


def each(scene: Any, function: Callable[[Any], Any]) -> Any:
    """A scene whose meshes a function has changed."""
    made = scene.copy()
    made.metadata = copy.copy(scene.metadata)
    for name, part in scene.geometry.items():
        if hasattr(part, "faces"):
            made.geometry[name] = function(part)
    return made


class Parts:
    """The parts of a trimesh: those that are interpolated, as channels and texture; others, which the nearest vertex or the
    face before gives; and those of the whole mesh. Vertices that trimesh split along the seams of a texture are one again in
    `vertices` and `triangles`; `joined` is the vertex there of each given one, or None where none was split."""

    def __init__(self, given: Any) -> None:
        self.given, self.visual = given, given.visual
        kind = getattr(self.visual, "kind", None)
        self.uv = getattr(self.visual, "uv", None) if kind == "texture" else None
        self.joined = _joined(given) if self.uv is not None else None
        self.vertices, self.triangles = given.vertices, given.faces
        self.first: Any = slice(None)
        if self.joined is not None:
            self.first = np.unique(self.joined, return_index=True)[1]  # of the given vertices that are joined
            self.vertices, self.triangles = given.vertices[self.first], self.joined[given.faces]
        vertices: dict[tuple[str, str], Any] = {}
        faces: dict[tuple[str, str], Any] = {}
        if kind == "vertex":
            vertices["visual", "vertex_colors"] = self.visual.vertex_colors
        if kind == "face":
            faces["visual", "face_colors"] = self.visual.face_colors
        if kind == "texture":
            vertices |= {("texture", name): values for name, values in self.visual.vertex_attributes.items() if name != "uv"}
            if getattr(self.visual, "face_materials", None) is not None:
                faces["visual", "face_materials"] = self.visual.face_materials
        vertices |= {("vertex", name): values for name, values in given.vertex_attributes.items()}
        faces |= {("face", name): values for name, values in given.face_attributes.items()}
        self.smooth: dict[tuple[str, str], Any] = {}
        self.torn: dict[tuple[str, str], Any] = {}  # has several values where vertices are joined: linear in each face before
        self.nearest: dict[tuple[str, str], Any] = {}
        self.rough: list[str] = []  # of the nearest ones: numbers that are not finite
        self.faces: dict[tuple[str, str], Any] = {}
        for key, values in vertices.items():
            array = np.asarray(values)
            if len(array) == len(given.vertices):
                smooth = array.dtype.kind == "f" or "color" in key[1] and array.dtype == np.uint8
                if smooth and not np.isfinite(array).all():
                    self.rough.append(key[1])
                smooth = smooth and array.size > 0 and key[1] not in self.rough
                torn = smooth and self.joined is not None and not np.array_equal(array[self.first][self.joined], array)
                (self.torn if torn else self.smooth if smooth else self.nearest)[key] = array
        for key, values in faces.items():
            if len(values) == len(given.faces):
                self.faces[key] = np.asarray(values)

    def __bool__(self) -> bool:
        return self.uv is not None or bool(self.smooth or self.torn or self.nearest or self.faces)

    def mesh(self, kind: type[Mesh], by_face: bool) -> Mesh:
        """The mesh to refine or to decimate."""
        rest: dict[str, Any] = {}
        if self.smooth:
            columns = [values[self.first].reshape(len(self.vertices), -1) for values in self.smooth.values()]
            rest["channels"] = np.concatenate(columns, axis=1).astype(float)
        if self.uv is not None:
            rest.update(texture=self.uv, texture_faces=self.given.faces)
        if self.joined is not None and self.uv is not None:  # given vertices of one place and one texture coordinate are no seam
            _, one, each = np.unique(np.column_stack([self.joined, self.uv]), axis=0, return_index=True, return_inverse=True)
            rest.update(texture=self.uv[one], texture_faces=each.ravel()[self.given.faces])
        if (self.faces or self.nearest or self.torn) and by_face:
            rest.update(face_labels=np.arange(len(self.given.faces)), labels=[UNNAMED] * len(self.given.faces))
        return kind(self.vertices, self.triangles, **rest)

    def renumbered(self, rows: Any, names: tuple[str, ...]) -> Any:
        """Creases or corners of the given vertices, as those of the mesh."""
        if self.joined is None:
            return rows
        made = rows.copy()
        for name in names:
            if (rows[name] >= len(self.joined)).any():
                raise ValueError(f"vertex {rows[name].max()} is given; there are {len(self.joined)}")
            made[name] = self.joined[rows[name]]
        return made

    def refined(self, fine: Mesh) -> Any:
        """The trimesh of a refined mesh."""

        def places(corners: Any) -> tuple[Any, Any]:
            before = fine.face_labels[corners // 3]  # type: ignore[index]
            triangles = self.given.vertices[self.given.faces[before]]
            return before, _weights(triangles, fine.vertices[fine.faces.ravel()[corners]])

        return self._made(fine, fine, lambda: fine.face_labels, places)

    def decimated(self, coarse: Mesh, map: MeshMap | None) -> Any:
        """The trimesh of a decimated mesh."""
        if map is None:
            return self._made(coarse, coarse, None, None)
        middle = np.full((len(coarse.faces), 3), 1 / 3)
        return self._made(coarse, map.transfer(), lambda: map.to_fine(np.arange(len(coarse.faces)), middle)[0],
                          lambda corners: map.to_fine(corners // 3, np.eye(3)[corners % 3]))  # fmt: skip

    def _made(self, mesh: Mesh, rich: Mesh, faces: Any, places: Any) -> Any:
        """A trimesh from a mesh; from one with the channels and the texture; from what gives the face before; and from what
        gives the place of corners in faces before."""
        from trimesh import Trimesh
        from trimesh.visual import ColorVisuals, TextureVisuals

        # The vertex of the mesh that each vertex of the trimesh is, a corner of it, and the corners of faces.
        at, corners, triangles = np.arange(len(mesh.vertices)), np.zeros(len(mesh.vertices), np.int64), mesh.faces.astype(np.int64)
        corners[triangles.ravel()] = np.arange(triangles.size)
        if self.joined is not None:
            pairs = np.stack([triangles.ravel(), rich.texture_faces.ravel()], axis=1)  # type: ignore[union-attr]
            pairs, corners, split = np.unique(pairs, axis=0, return_index=True, return_inverse=True)
            at, triangles = pairs[:, 0], split.reshape(triangles.shape)
        for name in self.rough:
            warnings.warn(f"attribute '{name}' has values that are not finite: each vertex gets that of the nearest one", BattenWarning, stacklevel=4)
        values: dict[tuple[str, str], Any] = {}
        begin = 0
        for key, given in self.smooth.items():
            width = given[:1].size
            values[key] = _as(rich.channels[at, begin : begin + width], given)  # type: ignore[index]
            begin += width
        if self.nearest or self.torn:
            before, weights = places(corners)
            near = self.given.faces[before]
            values |= {key: given[near[np.arange(len(near)), np.argmax(weights, axis=1)]] for key, given in self.nearest.items()}
            values |= {key: _as(np.einsum("nc,nc...->n...", weights, given[near].astype(float)), given) for key, given in self.torn.items()}
        before = faces() if self.faces else None
        values |= {key: given[before] for key, given in self.faces.items()}
        visual = None
        if self.uv is not None:
            uv = np.empty((len(at), 2))
            uv[triangles] = rich.texture[rich.texture_faces]  # type: ignore[index]
            visual = TextureVisuals(uv=uv, material=self.visual.material, face_materials=values.get(("visual", "face_materials")))
            visual.vertex_attributes.update({name: values[key] for key in values for name in key[1:] if key[0] == "texture"})
        elif ("visual", "vertex_colors") in values or ("visual", "face_colors") in values:
            visual = ColorVisuals(face_colors=values.get(("visual", "face_colors")), vertex_colors=values.get(("visual", "vertex_colors")))
        elif hasattr(self.visual, "material"):
            visual = self.visual.copy()
        normals = None if mesh.vertex_normals is None else mesh.vertex_normals[at]
        made = Trimesh(mesh.vertices[at], triangles, vertex_normals=normals, visual=visual, process=False,
                       metadata=copy.copy(self.given.metadata))  # fmt: skip
        made.vertex_attributes.update({name: values[kind, name] for kind, name in values if kind == "vertex"})
        made.face_attributes.update({name: values[kind, name] for kind, name in values if kind == "face"})
        return made


def _joined(given: Any) -> Any:
    """The vertices of a trimesh with those of equal positions as one: the number of each. None where all differ, or where
    joining makes what is a manifold none."""
    order, each = np.unique(np.asarray(given.vertices) + 0.0, axis=0, return_index=True, return_inverse=True)[1:]
    if len(order) == len(each) or not len(given.faces):
        return None
    rank = np.empty(len(order), np.int64)
    rank[np.argsort(order)] = np.arange(len(order))  # in the order of the given vertices
    joined = rank[each.ravel()]
    vertices = given.vertices[np.sort(order)]
    return joined if _manifold(vertices, joined[given.faces]) or not _manifold(given.vertices, given.faces) else None


def _manifold(vertices: Any, faces: Any) -> bool:
    from batten.meshes import Mesh

    found = ffi.gc(ffi.new("bat_mesh_connectivity *"), lib.bat_mesh_connectivity_free)
    return bool(lib.bat_mesh_connect(Mesh(vertices, faces)._struct(), found, ffi.NULL) == lib.BAT_OK)


def _as(columns: Any, given: Any) -> Any:
    """Columns of numbers in the kind and the shape of what was given."""
    if given.dtype.kind == "u":
        columns = np.clip(np.rint(columns), 0, 255)
    return columns.astype(given.dtype).reshape(-1, *given.shape[1:])


def _weights(triangles: Any, points: Any) -> Any:
    """The barycentric coordinates of a point over each triangle, none below 0."""
    from trimesh.triangles import points_to_barycentric

    with np.errstate(all="ignore"):
        found = np.clip(np.nan_to_num(points_to_barycentric(triangles, points), posinf=0), 0, None)
    total = found.sum(axis=1, keepdims=True)
    return np.where(total > 0, found / np.where(total > 0, total, 1), 1 / 3)
