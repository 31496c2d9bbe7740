"""Surfaces: spline surfaces fitted to scans."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from batten._core import (BattenError, Floats, Progress, Report, array, call, chosen, drawn, family_of, ffi, flag, kept, lib, options, pointer, report, shown, take,
                          takes, written)  # fmt: skip
from batten.curves import axes_of, equal
from batten.meshes import Mesh, PolygonMesh
from batten.scans import order_of, read_scan


class Surface:
    """A hierarchical spline surface over [0, 1]^2, fitted to points. It is called with parameters u and v.

    Attributes
    ----------
    report : Report
        `rounds` of the fit, `reached`, `chosen` parameterization, `candidates`, `held_out_rms` (of points that were held
        out), `noise`, `below_noise`, the `verdict` with its `fault`, the `primitive` that the points lie on (its `kind` is
        ``"none"``, or ``"cylinder"``, with `radius`, `axis` and more), and others.
    points, parameters, distances : ndarray
        The fitted points, the parameters of each and its distance from the surface, in the order of the input.
    control : ndarray
        The control points.
    """

    report: Report
    points: Floats
    parameters: Floats
    distances: Floats
    control: Floats

    def __init__(self, struct: Any, report: Report, points: Floats, parameters: Floats, distances: Floats, shaped: bool = False) -> None:
        self._surface, self._shaped = ffi.gc(struct, lib.bat_spline_surface_free), shaped
        self.report, self.points, self.parameters, self.distances = report, points, parameters, distances
        count = lib.bat_hierarchical_space_functions(struct.space)
        self.control = np.array(ffi.unpack(struct.control, count * struct.dimension)).reshape(count, struct.dimension)

    def _evaluate(self, u: ArrayLike, v: ArrayLike, derivatives: int) -> Floats:
        rows = np.stack(np.broadcast_arrays(array(u, "u", None), array(v, "v", None)), axis=-1)
        made = np.empty((*rows.shape[:-1], (1, 3, 6)[derivatives], self.control.shape[1]))
        count = rows.size // 2
        call(lib.bat_spline_surface_evaluate, self._surface, pointer(rows), count, derivatives, pointer(made))
        return made

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """The points of the surface at parameters, which are broadcast: an array of shape (…, 3)."""
        return self._evaluate(u, v, 0)[..., 0, :]

    def derivatives(self, u: ArrayLike, v: ArrayLike, order: int = 1) -> Floats:
        """The derivatives S_u and S_v, of order 2 S_uu, S_uv and S_vv: an array of shape (…, 2 or 3, 3)."""
        if order not in (1, 2):
            raise ValueError(f"order: 1 or 2 is needed, not {order}")
        return self._evaluate(u, v, order)[..., slice(1, 3) if order == 1 else slice(3, 6), :]

    def normals(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """Unit normals of the surface at parameters."""
        made = np.cross(*np.moveaxis(self.derivatives(u, v), -2, 0))
        normals: Floats = made / np.linalg.norm(made, axis=-1, keepdims=True)
        return normals

    def mesh(self, samples: int = 64) -> Mesh:
        """The surface as a mesh of samples x samples vertices."""
        t, n = np.linspace(0, 1, samples), samples
        first = (np.arange(n - 1)[:, None] + n * np.arange(n - 1)).ravel(order="F")
        faces = np.stack([first, first + 1, first + n + 1, first, first + n + 1, first + n], axis=1).reshape(-1, 3)
        return Mesh(self(t[None, :], t[:, None]).reshape(-1, 3), faces)

    def write(self, path: str | os.PathLike[str] | None = None, *, format: str = "auto", samples: int = 0, keep_spline: bool = False) -> bytes:
        """Write the surface to a file, whose ending chooses the format: .xml, .step, .vtk, .obj or .json. Without a path, give
        a format, and get the bytes of the file.

        Where the points lie on a plane, sphere, cylinder or cone, within the tolerance of the fit, STEP has this shape, with
        lines and circles as edges. With `keep_spline`, it has the spline also then.
        """
        how = options("bat_surface_write_options", {"format": format, "samples": samples})
        how.points, how.errors, how.point_count = pointer(self.points), pointer(self.distances), len(self.points)
        shape = ffi.new("bat_surface_primitive *")
        for name, value in self.report["primitive"].items() if self._shaped and not keep_spline else ():
            setattr(shape, name, chosen(family_of("bat_surface_primitive_kind"), value).value if name == "kind" else
                    value.tolist() if isinstance(value, np.ndarray) else value)  # fmt: skip
        return written(lib.bat_surface_write_shape, format, self._surface, shape, how, ffi.NULL, ffi.NULL, path=path)

    def to_step(self, path: str | os.PathLike[str] | None = None, *, keep_spline: bool = False) -> bytes:
        """STEP for programs of computer-aided design, as :meth:`write`: to a file, or as bytes."""
        return self.write(path, format="step", keep_spline=keep_spline)

    def to_vtk(self, path: str | os.PathLike[str] | None = None, samples: int = 0) -> bytes:
        """VTK, with the points and their distances: to a file, or as bytes."""
        return self.write(path, format="vtk", samples=samples)

    def __repr__(self) -> str:
        return f"<Surface of {len(self.control)} functions, {len(self.points)} points, rms {self.report.rms:.3g}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (self.write(format="json"), self.report, self.points, self.parameters, self.distances, self._shaped)

    def plot(self, ax: Any = None, samples: int = 64, *, interactive: bool = False, **style: Any) -> Any:
        """Draw the surface and the points with matplotlib; returns the axes. With `interactive`, the surface as
        :meth:`Mesh.plot`."""
        if interactive:
            return self.mesh(samples).plot(interactive=True, **style)
        axes, t = axes_of(ax, 3), np.linspace(0, 1, samples)
        axes.plot_surface(*np.moveaxis(self(t[None, :], t[:, None]), -1, 0), **style)
        axes.scatter(*self.points.T, s=1, c="black")
        return equal(axes)

    @drawn
    def _repr_png_(self) -> bytes | None:
        cloud = ffi.new("bat_cloud *", {"points": pointer(self.points), "count": len(self.points)})
        row = ffi.new("bat_surface_picture_row *", [ffi.NULL, cloud, self._surface, pointer(self.distances),
                                                    pointer(self.parameters)])  # fmt: skip
        return written(lib.bat_surface_picture_write, "png", row, 1, options("bat_surface_picture_options", {}))


class Shell:
    """A smooth surface of any shape, closed or open, of four-sided faces that share their sides. It is called with faces and
    parameters u and v in them.

    Attributes
    ----------
    control_mesh : PolygonMesh
        The control points: quads, with creases.
    patches : ndarray of shape (faces, spans, spans, 4, 4, 3)
        Bézier points of the bicubic patches of each face, in rows of v.
    closed : bool
        Whether it has no boundary.
    report : Report
        `points`, `noise`, `rms`, `held_out`, `volume`, `pieces`, `holes`, and more.
    """

    control_mesh: PolygonMesh
    patches: Floats
    closed: bool
    report: Report

    def __init__(self, control_mesh: PolygonMesh, patches: Floats, closed: bool, report: Report) -> None:
        self.control_mesh, self.patches, self.closed, self.report = control_mesh, patches, closed, report

    def _struct(self) -> Any:
        cage = self.control_mesh._struct()
        struct = ffi.new("bat_shell *", [cage[0], len(self), self.patches.shape[1], pointer(self.patches), self.closed])
        kept[struct] = [cage, self.patches]
        return struct

    def _evaluate(self, face: ArrayLike, u: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        given = np.broadcast_arrays(array(face, "face", None, np.int64), array(u, "u", None), array(v, "v", None))
        faces, places = np.ascontiguousarray(given[0], np.int64), np.stack(given[1:], axis=-1)
        points, normals = np.empty((*faces.shape, 3)), np.empty((*faces.shape, 3))
        call(lib.batten_shell_evaluate, self._struct(), pointer(faces, "int64_t[]"), pointer(places), faces.size, pointer(points), pointer(normals))
        return points, normals

    def __call__(self, face: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
        """The points of faces at parameters in [0, 1], which are broadcast: an array of shape (…, 3)."""
        return self._evaluate(face, u, v)[0]

    def normals(self, face: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
        """Unit normals, outwards of a closed shell."""
        return self._evaluate(face, u, v)[1]

    def mesh(self, samples: int = 6) -> PolygonMesh:
        """The shell as a mesh of samples x samples quads of each patch."""
        made = ffi.new("bat_mesh *")
        call(lib.bat_shell_tessellate, self._struct(), samples, made)
        return PolygonMesh._from(made)

    def write(self, path: str | os.PathLike[str] | None = None, *, format: str = "auto", samples: int = 0, unit: str = "mm") -> bytes:
        """Write the shell to a file, whose ending chooses the format: .step, or .obj and other meshes of quads. Without a path,
        give a format, and get the bytes of the file."""
        how = options("bat_surface_write_options", {"format": format, "samples": samples, "unit": unit})
        return written(lib.bat_shell_write, format, self._struct(), how, path=path)

    def to_step(self, path: str | os.PathLike[str] | None = None) -> bytes:
        """STEP, whose closed parts are solids: to a file, or as bytes."""
        return self.write(path, format="step")

    def __len__(self) -> int:
        """The number of faces."""
        return len(self.patches)

    def __repr__(self) -> str:
        return f"<{'Closed' if self.closed else 'Open'} shell of {len(self)} faces, rms {self.report.rms:.3g}>"

    def plot(self, ax: Any = None, *, interactive: bool = False, samples: int = 6, **style: Any) -> Any:
        """Draw the shell, as :meth:`Mesh.plot`."""
        return self.mesh(samples).plot(ax, interactive=interactive, **style)

    def picture(self, points: ArrayLike | None = None, *, view: str = "shaded", bands: ArrayLike = (), suffix: str = "png", **settings: Any) -> bytes:
        """A picture by the library, as the bytes of a file (png, svg or pdf): the shell with the sides of its faces, or its
        `view` ``"zebra"`` or ``"curvature"``. Points are drawn beside it in colours of their distances, or of `bands` of these."""
        given, limits = None if points is None else array(points, "points", 3), array(bands, "bands", None)
        inspection = ffi.new("bat_surface_inspection *", [chosen(family_of("bat_surface_view"), view).value, pointer(limits), limits.size])
        return written(lib.bat_shell_picture_write, suffix, ffi.NULL, self._struct(), pointer(given), 0 if given is None else len(given), inspection,
                       options("bat_surface_picture_options", settings))  # fmt: skip

    @drawn
    def _repr_png_(self) -> bytes | None:
        return self.picture()


def _shell(given: Any, faces: Any, how: Any, progress: Progress, resume: str | os.PathLike[str] | None) -> Shell:
    made, found = ffi.gc(ffi.new("bat_shell *"), lib.bat_shell_free), ffi.new("bat_shell_report *")
    mesh = Mesh.of(given, faces) if faces is not None or hasattr(given, "faces") else None
    given = None if mesh is not None else array(given, "points", 3)
    points, count = (ffi.NULL, 0) if mesh is not None else (pointer(given), len(given))
    with shown(progress, "fitting"):
        call(lib.bat_shell_reconstruct_in_steps, points, count, ffi.NULL if mesh is None else mesh._struct(), how,
             ffi.NULL if resume is None else os.fsencode(resume), made, found)  # fmt: skip
    patches, made.patches = take(made.patches, (made.face_count, made.spans, made.spans, 4, 4, 3)), ffi.NULL
    cage = ffi.new("bat_mesh *")
    call(lib.bat_mesh_copy, ffi.addressof(made, "cage"), cage)
    return Shell(PolygonMesh._from(cage), patches, made.closed, report(found))


def _unpickled(content: bytes, *rest: Any) -> Surface:
    struct = ffi.new("bat_spline_surface *")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "batten.json"
        file.write_bytes(content)
        call(lib.bat_surface_read, bytes(file), struct)
    return Surface(struct, *rest)


def _owned(values: Any) -> Any:
    """A copy of an array in memory that the library may free."""
    memory = lib.malloc(max(values.nbytes, 1))
    if memory == ffi.NULL:
        raise MemoryError
    ffi.memmove(memory, values, values.nbytes)
    return memory


@overload
@takes("bat_shell_reconstruct_options")
def fit_surface(points: Any, faces: ArrayLike | None = None, /, *, shell: Literal[True], progress: Progress = False,
                resume: str | os.PathLike[str] | None = None, **settings: Any) -> Shell: ...
@overload
@takes("bat_surface_reconstruct_options")
def fit_surface(points: Any, faces: ArrayLike | None = None, /, *, shell: Literal[False], boundary: int = 0,
                corners: ArrayLike | None = None, parameters: str | ArrayLike = "auto", edges: str = "auto",
                progress: Progress = False, **settings: Any) -> Surface: ...
@overload
def fit_surface(points: Any, faces: ArrayLike | None = None, /, *, shell: bool | None = None, boundary: int = 0,
                corners: ArrayLike | None = None, parameters: str | ArrayLike = "auto", edges: str = "auto",
                progress: Progress = False, resume: str | os.PathLike[str] | None = None, **settings: Any) -> Surface | Any: ...
@takes("bat_surface_reconstruct_options")
def fit_surface(points: Any, faces: ArrayLike | None = None, /, *, shell: bool | None = None, boundary: int = 0,
                corners: ArrayLike | None = None, parameters: str | ArrayLike = "auto", edges: str = "auto",
                progress: Progress = False, resume: str | os.PathLike[str] | None = None, **settings: Any) -> Any:
    """Fit a spline surface to the points of a scan: one patch, or a shell of any shape.

    Parameters
    ----------
    points : array_like of shape (n, 3), Mesh, trimesh.Trimesh or path
        Scattered points of a patch, or a mesh of it, or a file of them, as of :func:`read_points`.
    faces : array_like of shape (m, 3), optional
        The triangles of a mesh.
    shell : bool, optional
        True: a :class:`Shell`, whose options are `tolerance`, `faces` (about this number), `spans` (of a face, in each
        direction), `crease` (edges of a mesh beyond this angle stay sharp, in radians), `fill_holes`, `force` and `threads`.
        False: a :class:`Surface`. By default a patch, trimmed, or a
        shell, whichever is right first, unless arguments ask for a patch.
    boundary : int
        How many leading points are the boundary, in order around the loop; 0: it is found.
    corners : four indices, optional
        The points that become the corners (0, 0), (1, 0), (1, 1) and (0, 1); by default they are found.
    parameters : str or array_like of shape (n, 2)
        How the points get parameters, one of ``choices("surface_parameters")``; or the parameters.
    edges : str
        Of a trimmed surface, one of ``choices("surface_edges")``: ``"exact"`` cuts along polygons of the points, ``"fair"``
        along smooth curves.
    progress : bool or callable
        As of :func:`refine`.
    resume : path, optional
        A file in which a shell keeps what it has found, and from which a stopped one goes on. It goes when the shell is made.
    **settings
        Fields of ``bat_surface_reconstruct_options`` and its ``bat_surface_fit_options`` and ``bat_hierarchical_options``.

    Returns
    -------
    Surface or Shell

    Examples
    --------
    >>> t = np.linspace(0, 1, 12)
    >>> x, y = (part.ravel() for part in np.meshgrid(t, t))
    >>> surface = batten.fit_surface(np.stack([x, y, x * y], axis=1), tolerance=1e-3)
    >>> surface.report.reached, surface.report.verdict.fault, surface(0.5, [0.25, 0.75]).shape
    (True, 'none', (2, 3))
    """
    whole = shell is not None and flag(shell, "shell")
    outlined = bool(boundary) or corners is not None
    if whole and (outlined or not isinstance(parameters, str) or parameters != "auto" or edges != "auto"):
        raise TypeError("shell: a shell has no boundary, corners and parameters of one square, and no edges to trim")
    how = options("bat_shell_reconstruct_options" if whole else "bat_surface_reconstruct_options", settings)
    if isinstance(points, (str, os.PathLike)):
        if faces is not None:
            raise TypeError("faces: a file has its own")
        points, faces, leading, four = read_scan(points)
        boundary, corners = (boundary, corners) if outlined else (leading, four)
    if whole:
        return _shell(points, faces, how, progress, resume)
    how.parameters = lib.BAT_SURFACE_PARAMETERS_GIVEN
    if isinstance(parameters, str):
        how.parameters = chosen(family_of("bat_surface_parameters"), parameters).value
    follow = options("bat_shell_reconstruct_options", {})
    leads_on = shell is None and lib.bat_shell_follows(how, outlined, ffi.new("bat_error *", {"remedy": b"shell"}), follow)
    patch: Surface | None = None
    for trim in (how.trim, True):
        how.trim = trim
        try:
            made = _patch(points, faces, boundary, corners, parameters, edges, progress, how)
        except BattenError as error:
            if patch is not None and error.status not in ("cancelled", "no memory"):
                return patch
            if not leads_on or error.remedy not in ("trim", "shell"):
                raise
            if error.remedy == "shell":
                break
        else:
            verdict = made.report["verdict"]
            if not leads_on or verdict["doubt"] not in ("gap", "area") or trim:
                closes = patch is not None and verdict["doubt"] == "gap" and verdict["doubt_size"] >= patch.report["verdict"]["doubt_size"]
                return patch if patch is not None and (closes or verdict["fault"] != "none") else made
            patch = made
    return _shell(points, faces, follow, progress, resume)


def _patch(points: Any, faces: Any, boundary: int, corners: Any, parameters: Any, edges: str, progress: Progress, how: Any) -> Surface:
    """A surface of one patch."""
    if not isinstance(edges, str):
        raise TypeError(f"edges: a name is needed, not {edges!r}")
    cloud = ffi.gc(ffi.new("bat_cloud *"), lib.bat_cloud_free)
    if faces is not None or hasattr(points, "faces"):
        mesh = Mesh.of(points, faces)
        call(lib.bat_cloud_from_mesh, mesh._struct(), cloud)
        given = mesh.vertices
    else:
        given = array(points, "points", 3)
        if not 0 <= boundary <= len(given):
            raise ValueError(f"boundary: 0 to {len(given)} is needed, not {boundary}")
        cloud.points, cloud.count, cloud.boundary_count = ffi.cast("double *", _owned(given)), len(given), boundary
    if corners is not None:
        four = array(corners, "corners", None, np.uint64)
        if four.shape != (4,):
            raise ValueError(f"corners: four numbers are needed, not an array of shape {four.shape}")
        if not cloud.boundary_count:
            call(lib.bat_cloud_find_boundary, cloud)
        call(lib.bat_cloud_set_corners, cloud, pointer(four, "size_t[]"))
    order = order_of(cloud)
    if not isinstance(parameters, str):
        own = array(parameters, "parameters", 2)
        if len(own) != len(given):
            raise ValueError(f"parameters: {len(given)} rows are needed, not {len(own)}")
        own = np.ascontiguousarray(own[order])
        how.given = pointer(own)
    result = ffi.new("bat_surface_result *")
    with shown(progress, "fitting"):
        call(lib.bat_surface_reconstruct_edges, cloud, how, chosen(family_of("bat_surface_edges"), edges).value, result)
    primitive = ffi.new("bat_surface_primitive *")
    call(lib.bat_surface_find_primitive, cloud, result, primitive)
    surface = _surface(result, order_of(cloud), given)
    surface.report["primitive"] = report(primitive)
    surface._shaped = not (0 < how.fit.tolerance < primitive.largest and surface.report["reached"])
    return surface


def cloud_noise(points: ArrayLike) -> float:
    """Estimate the noise of a scan: the standard deviation of a coordinate.

    Examples
    --------
    >>> x, y = np.random.default_rng(1).uniform(size=(2, 2000))
    >>> flat = np.stack([x, y, np.random.default_rng(2).normal(0, 0.01, 2000)], axis=1)
    >>> 0.008 < batten.cloud_noise(flat) < 0.012
    True
    """
    given, sigma = array(points, "points", 3), ffi.new("double *")
    cloud = ffi.new("bat_cloud *", {"points": pointer(given), "count": len(given)})
    call(lib.bat_cloud_noise, cloud, sigma)
    return float(sigma[0])


def _surface(result: Any, order: Any, given: Floats) -> Surface:
    rounds = [report(result.report.rounds[i]) for i in range(result.report.count)]
    found = report(result)
    fit = found.pop("report")
    found.update(fit, rounds=rounds, candidates=found["candidates"][: result.candidate_count],
                 **{name: rounds[-1][name] for name in ("functions", "levels", "rms", "largest", "within")})  # fmt: skip
    del found["surface"], found["count"]
    parameters, distances = np.full((len(given), 2), np.nan), np.full(len(given), np.nan)
    parameters[order] = take(result.parameters, (len(order), 2))
    distances[order] = take(result.report.distances, (len(order),))
    lib.free(result.report.rounds)
    keep = np.sort(order)
    surface = ffi.new("bat_spline_surface *", result.surface)
    return Surface(surface, found, given[keep], parameters[keep], distances[keep])
