"""Meshes and scenes of trimesh: what they have beside vertices and faces goes through refinement and decimation."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from batten._core import Report

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
    face before gives; and those of the whole mesh."""

    def __init__(self, given: Any) -> None:
        self.given, self.visual = given, given.visual
        kind = getattr(self.visual, "kind", None)
        self.uv = getattr(self.visual, "uv", None) if kind == "texture" else None
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
        self.nearest: dict[tuple[str, str], Any] = {}
        self.faces: dict[tuple[str, str], Any] = {}
        for key, values in vertices.items():
            array = np.asarray(values)
            if len(array) == len(given.vertices):
                smooth = array.dtype.kind == "f" or "color" in key[1] and array.dtype == np.uint8
                (self.smooth if smooth else self.nearest)[key] = array
        for key, values in faces.items():
            if len(values) == len(given.faces):
                self.faces[key] = np.asarray(values)

    def __bool__(self) -> bool:
        return self.uv is not None or bool(self.smooth or self.nearest or self.faces)

    def mesh(self, kind: type[Mesh], by_face: bool) -> Mesh:
        """The mesh to refine or to decimate."""
        rest: dict[str, Any] = {}
        if self.smooth:
            columns = [values.reshape(len(values), -1) for values in self.smooth.values()]
            rest["channels"] = np.concatenate(columns, axis=1).astype(float)
        if self.uv is not None:
            rest.update(texture=self.uv, texture_faces=self.given.faces)
        if self.faces and by_face:
            rest.update(face_labels=np.arange(len(self.given.faces)), labels=[UNNAMED] * len(self.given.faces))
        return kind(self.given.vertices, self.given.faces, **rest)

    def refined(self, coarse: Mesh, fine: Mesh) -> Any:
        """The trimesh of a refined mesh."""
        return self._made(fine, fine, lambda: fine.face_labels, lambda: nearest(coarse, *_places(coarse.closest(fine.vertices))))

    def decimated(self, fine: Mesh, coarse: Mesh, map: MeshMap | None) -> Any:
        """The trimesh of a decimated mesh."""
        if map is None:
            return self._made(coarse, coarse, None, None)
        middle = np.full((len(coarse.faces), 3), 1 / 3)
        at = np.zeros(len(coarse.vertices), np.uint32)  # a corner of each vertex
        at[coarse.faces.ravel()] = np.arange(coarse.faces.size)
        return self._made(coarse, map.transfer(), lambda: map.to_fine(np.arange(len(coarse.faces)), middle)[0],
                          lambda: nearest(fine, *map.to_fine(at // 3, np.eye(3)[at % 3])))  # fmt: skip

    def _made(self, mesh: Mesh, rich: Mesh, faces: Any, vertices: Any) -> Any:
        """A trimesh from a mesh; from one with the channels and the texture; and from what gives the face before and the
        nearest vertex before."""
        from trimesh import Trimesh
        from trimesh.visual import ColorVisuals, TextureVisuals

        values: dict[tuple[str, str], Any] = {}
        begin = 0
        for key, given in self.smooth.items():
            width = given[:1].size
            columns = rich.channels[:, begin : begin + width]  # type: ignore[index]
            if given.dtype.kind == "u":
                columns = np.clip(np.rint(columns), 0, 255)
            values[key] = columns.astype(given.dtype).reshape(-1, *given.shape[1:])
            begin += width
        before = vertices() if self.nearest else None
        values |= {key: given[before] for key, given in self.nearest.items()}
        before = faces() if self.faces else None
        values |= {key: given[before] for key, given in self.faces.items()}
        visual = None
        if self.uv is not None:
            uv = np.empty((len(mesh.vertices), 2))
            uv[rich.faces] = rich.texture[rich.texture_faces]  # type: ignore[index]
            visual = TextureVisuals(uv=uv, material=self.visual.material, face_materials=values.get(("visual", "face_materials")))
            visual.vertex_attributes.update({name: values[key] for key in values for name in key[1:] if key[0] == "texture"})
        elif ("visual", "vertex_colors") in values or ("visual", "face_colors") in values:
            visual = ColorVisuals(face_colors=values.get(("visual", "face_colors")), vertex_colors=values.get(("visual", "vertex_colors")))
        elif hasattr(self.visual, "material"):
            visual = self.visual.copy()
        made = Trimesh(mesh.vertices, mesh.faces.astype(np.int64), vertex_normals=mesh.vertex_normals, visual=visual, process=False,
                       metadata=copy.copy(self.given.metadata))  # fmt: skip
        made.vertex_attributes.update({name: values[kind, name] for kind, name in values if kind == "vertex"})
        made.face_attributes.update({name: values[kind, name] for kind, name in values if kind == "face"})
        return made


def _places(found: Report) -> tuple[Any, Any]:
    return found.face, found.barycentric


def nearest(mesh: Mesh, faces: Any, weights: Any) -> Any:
    """The vertices that are nearest to points of faces."""
    return mesh.faces[faces, np.argmax(weights, axis=1)]
