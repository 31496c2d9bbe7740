"""Surfaces: spline surfaces fitted to scans."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from batten._core import (Floats, Progress, Report, array, call, chosen, drawn, family_of, ffi, lib, options, pointer, report, shown, take,
                          takes, written)  # fmt: skip
from batten.curves import axes_of, equal
from batten.meshes import Mesh


class Surface:
    """A hierarchical spline surface over [0, 1]^2, fitted to points. It is called with parameters u and v.

    Attributes
    ----------
    report : Report
        `rounds` of the fit, `reached`, `chosen` parameterization, `candidates`, `held_out_rms` (of points that were held
        out), `noise`, `below_noise`, the `verdict` with its `fault`, and more.
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

    def __init__(self, struct: Any, report: Report, points: Floats, parameters: Floats, distances: Floats) -> None:
        self._surface = ffi.gc(struct, lib.bat_spline_surface_free)
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

    def write(self, path: str | os.PathLike[str] | None = None, *, format: str = "auto", samples: int = 0) -> bytes:
        """Write the surface to a file, whose ending chooses the format: .xml, .step, .vtk, .obj or .json. Without a path, give
        a format, and get the bytes of the file."""
        how = options("bat_surface_write_options", {"format": format, "samples": samples})
        how.points, how.errors, how.point_count = pointer(self.points), pointer(self.distances), len(self.points)
        return written(lib.bat_surface_write, format, self._surface, how, path=path)

    def to_step(self, path: str | os.PathLike[str] | None = None) -> bytes:
        """STEP for programs of computer-aided design: to a file, or as bytes."""
        return self.write(path, format="step")

    def to_vtk(self, path: str | os.PathLike[str] | None = None, samples: int = 0) -> bytes:
        """VTK, with the points and their distances: to a file, or as bytes."""
        return self.write(path, format="vtk", samples=samples)

    def __repr__(self) -> str:
        return f"<Surface of {len(self.control)} functions, {len(self.points)} points, rms {self.report.rms:.3g}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (self.write(format="json"), self.report, self.points, self.parameters, self.distances)

    def plot(self, ax: Any = None, samples: int = 64, **style: Any) -> Any:
        """Draw the surface and the points with matplotlib; returns the axes."""
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


@takes("bat_surface_reconstruct_options")
def fit_surface(points: Any, faces: ArrayLike | None = None, /, *, boundary: int = 0, corners: ArrayLike | None = None,
                parameters: str | ArrayLike = "auto", progress: Progress = False, **settings: Any) -> Surface:
    """Fit a spline surface to the points of a scan.

    Parameters
    ----------
    points : array_like of shape (n, 3), Mesh or trimesh.Trimesh
        Scattered points of a patch, or a mesh of it.
    faces : array_like of shape (m, 3), optional
        The triangles of a mesh.
    boundary : int
        How many leading points are the boundary, in order around the loop; 0: it is found.
    corners : four indices, optional
        The points that become the corners (0, 0), (1, 0), (1, 1) and (0, 1); by default they are found.
    parameters : str or array_like of shape (n, 2)
        How the points get parameters, one of ``choices("surface_parameters")``; or the parameters.
    progress : bool or callable
        As of :func:`refine`.
    **settings
        Fields of ``bat_surface_reconstruct_options`` and its ``bat_surface_fit_options`` and ``bat_hierarchical_options``.

    Returns
    -------
    Surface

    Examples
    --------
    >>> t = np.linspace(0, 1, 12)
    >>> x, y = (part.ravel() for part in np.meshgrid(t, t))
    >>> surface = batten.fit_surface(np.stack([x, y, x * y], axis=1), tolerance=1e-3)
    >>> surface.report.reached, surface.report.verdict.fault, surface(0.5, [0.25, 0.75]).shape
    (True, 'none', (2, 3))
    """
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
    how = options("bat_surface_reconstruct_options", settings)
    if isinstance(parameters, str):
        how.parameters = chosen(family_of("bat_surface_parameters"), parameters).value
    if corners is not None:
        four = array(corners, "corners", None, np.uint64)
        if four.shape != (4,):
            raise ValueError(f"corners: four numbers are needed, not an array of shape {four.shape}")
        if not cloud.boundary_count:
            call(lib.bat_cloud_find_boundary, cloud)
        call(lib.bat_cloud_set_corners, cloud, pointer(four, "size_t[]"))
    order = _order(cloud)
    if not isinstance(parameters, str):
        own = array(parameters, "parameters", 2)
        if len(own) != len(given):
            raise ValueError(f"parameters: {len(given)} rows are needed, not {len(own)}")
        own = np.ascontiguousarray(own[order])
        how.given, how.parameters = pointer(own), lib.BAT_SURFACE_PARAMETERS_GIVEN
    result = ffi.new("bat_surface_result *")
    with shown(progress, "fitting"):
        call(lib.bat_surface_reconstruct, cloud, how, result)
    return _surface(result, _order(cloud), given)


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


def _order(cloud: Any) -> Any:
    """The index in the input of each point of a cloud."""
    if cloud.order == ffi.NULL:
        return np.arange(cloud.count)
    return np.array(ffi.unpack(cloud.order, cloud.count), np.int64)


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
