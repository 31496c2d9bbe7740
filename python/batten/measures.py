"""Measures of curves and of meshes."""

from __future__ import annotations

from typing import Any

import numpy as np

from batten._core import Progress, Report, array, call, ffi, flag, lib, options, report, shown, takes
from batten.curves import Curve, _struct
from batten.meshes import Mesh
from batten.spaces import Space, space_of


def _is_mesh(given: Any) -> bool:
    pair = isinstance(given, tuple) and len(given) == 2 and all(np.ndim(part) == 2 for part in given)
    return (hasattr(given, "vertices") and hasattr(given, "faces")) or pair


@takes("bat_curve_measure_options", "bat_mesh_compare_options")
def measure(a: Any, b: Any = None, /, *, closed: bool | None = None, space: Space | str | None = None,
            progress: Progress = False, **settings: Any) -> Report:
    """Measure a curve or a mesh, or the distances between two of a kind.

    Parameters
    ----------
    a, b : array_like of shape (n, dimension), or meshes
        Curves; or a :class:`Mesh`, a ``trimesh.Trimesh`` or a pair of vertices and faces each.
    closed : bool, optional
        Whether curves are closed; by default what a :class:`Curve` knows, else open.
    space : Space or str, optional
        Where curves live; by default what a :class:`Curve` knows, else R^n.
    progress : bool or callable
        As of :func:`refine`.
    **settings
        Fields of ``bat_curve_measure_options`` or of ``bat_mesh_compare_options``.

    Returns
    -------
    Report
        Of a curve: bending energy, largest exterior angle, length, whether it is simple. Of two: mean and Hausdorff
        distances. Of a mesh: size, topology, area, volume, quality. Of two: Hausdorff and mean distances of the surfaces.

    Examples
    --------
    >>> batten.measure([[0, 0], [3, 0], [3, 4]]).length
    7.0
    >>> batten.measure([[0, 0], [1, 0]], [[0, 0], [1, 1]]).hausdorff
    1.0
    """
    given = [part for part in (a, b) if part is not None]
    with shown(progress, "measuring"):
        if _is_mesh(a):
            meshes = [Mesh.of(part) for part in given]
            structs = [mesh._struct() for mesh in meshes]
            if b is None and not settings:
                return _result(lib.bat_mesh_summarize, "bat_mesh_summary", *structs)
            if b is None:
                raise TypeError("options of distances need two meshes")
            return _result(lib.bat_mesh_compare, "bat_mesh_distance", *structs, options("bat_mesh_compare_options", settings))
        curves, keep = [], []
        for part in given:
            points = array(part, "curve", 0)
            own = part if isinstance(part, Curve) and part.space is not None else None
            where = space_of(space or (own.space if own is not None else None), points.shape[1])
            if where.functions:
                settings["threads"] = 1
            keep.append(points)
            joined = flag(closed, "closed") if closed is not None else own is not None and own.closed
            curves.append(ffi.new("bat_curve *", _struct(points, where, joined)))
        how = options("bat_curve_measure_options", settings)
        if b is not None:
            return _result(lib.bat_curve_compare, "bat_curve_distance", *curves, how)
        found = _result(lib.bat_curve_fairness, "bat_curve_fairness_values", *curves, how)
        if curves[0].space.dimension == 2 and ffi.string(curves[0].space.name) in (b"plane", b"euclidean", b"sphere", b"disk"):
            simple = ffi.new("bool *")
            call(lib.bat_curve_is_simple, *curves, simple)
            found["simple"] = bool(simple[0])
        return found


def _result(function: Any, kind: str, *arguments: Any) -> Report:
    """What a function of the library writes to a struct before its error."""
    made = ffi.new(f"{kind} *")
    call(function, *arguments, made)
    return report(made)
