"""Curves: refinement, analysis of schemes, pictures."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from batten._core import (BattenWarning, Floats, Progress, Report, array, call, call_named, drawn, ffi, flag, lib, options, pointer, report, Rows, shared_options, shown,
                          take, takes, written)
from batten.spaces import Space, space_of


class Curve(np.ndarray[Any, np.dtype[np.float64]]):
    """The points of a curve: an array with a space that draws itself.

    Rows of it, as in ``curve[2:5]``, are an open curve. What is computed from it is a plain array.

    Attributes
    ----------
    space : Space
        Where the points live.
    closed : bool
        Whether the last point joins the first.
    channels : ndarray or None
        Further values at the points.
    corners : ndarray or None
        Flags of points at which the curve was cut.
    """

    space: Space | None
    closed: bool
    channels: Floats | None
    corners: NDArray[np.bool_] | None

    def __array_finalize__(self, other: Any) -> None:
        self.__dict__.update(other.__dict__ if isinstance(other, Curve) else _BARE)

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        return _plain(array) if array.ndim else array[()]

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        found = super().__array_function__(function, types, arguments, keywords)
        return _plain(found) if isinstance(found, Curve) else found

    def __getitem__(self, index: Any) -> Any:
        found = _plain(self)[index]
        rows = isinstance(index, slice) or (isinstance(index, (list, np.ndarray)) and np.ndim(index) == 1)
        if not rows or found.ndim != 2 or self.ndim != 2:
            return found
        parts = {name: part if part is None else part[index] for name, part in (("channels", self.channels), ("corners", self.corners))}
        return _curve(found, {"space": self.space, "closed": False, **parts})

    @property
    def T(self) -> Any:  # type: ignore[override]
        return _plain(self).T

    def __reduce__(self) -> tuple[Any, ...]:
        return _curve, (np.asarray(self), self.__dict__)

    def plot(self, ax: Any = None, **style: Any) -> Any:
        """Draw the curve with matplotlib, by its first three coordinates; returns the axes."""
        points = np.vstack([self, self[:1]]) if self.closed else np.asarray(self)
        axes = axes_of(ax, min(points.shape[1], 3))
        axes.plot(*points[:, :3].T, **style)
        return equal(axes)

    @drawn
    def _repr_svg_(self) -> str | None:
        return picture([self]) if self.ndim == 2 and len(self) > 1 and self.space is not None else None


#: The attributes of a curve that nothing is known of.
_BARE = {"space": None, "closed": False, "channels": None, "corners": None}


def _plain(curve: Any) -> Any:
    return curve.view(np.ndarray)


def _leaving(name: str) -> Any:
    """A method of arrays whose result is no curve."""

    def method(self: Curve, *arguments: Any, **keywords: Any) -> Any:
        return getattr(_plain(self), name)(*arguments, **keywords)

    method.__name__, method.__doc__ = name, getattr(np.ndarray, name).__doc__
    return method


for _name in ("transpose", "reshape", "ravel", "flatten", "astype", "squeeze", "swapaxes", "diagonal", "take", "repeat", "compress", "choose"):
    setattr(Curve, _name, _leaving(_name))


def _curve(points: Floats, attributes: dict[str, Any]) -> Curve:
    curve = points.view(Curve)
    curve.__dict__.update(attributes)
    return curve


class Curves(Sequence[Curve]):
    """Several curves, whose points lie one behind the other, as in GeoArrow.

    Attributes
    ----------
    points : ndarray
        The points of all curves.
    offsets : ndarray
        Curve i has the points ``offsets[i]`` to ``offsets[i + 1] - 1``.
    space, closed
        As of :class:`Curve`, for all curves.
    """

    points: Floats
    offsets: NDArray[np.int64]
    space: Space
    closed: bool

    def __init__(self, points: Floats, offsets: NDArray[np.int64], space: Space, closed: bool) -> None:
        self.points, self.offsets, self.space, self.closed = points, offsets, space, closed

    def __len__(self) -> int:
        return len(self.offsets) - 1

    @overload
    def __getitem__(self, index: int) -> Curve: ...
    @overload
    def __getitem__(self, index: slice) -> list[Curve]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        begin, end = self.offsets[range(len(self))[index] :][:2]
        return _curve(self.points[begin:end], {"space": self.space, "closed": self.closed})

    def __repr__(self) -> str:
        return f"<{len(self)} curves, {len(self.points)} points, {self.space!r}>"

    def plot(self, ax: Any = None, **style: Any) -> Any:
        """Draw all curves with matplotlib; returns the axes."""
        for curve in self:
            ax = curve.plot(ax, **style)
        return ax

    @drawn
    def _repr_svg_(self) -> str | None:
        return picture(self) if 0 < len(self) <= 1000 else None


def axes_of(ax: Any, dimension: int) -> Any:
    """The axes to draw in: those given, or new ones with equal scales."""
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.figure().add_subplot(projection="3d" if dimension == 3 else None)
        ax.set_aspect("equal" if dimension == 2 else "auto")
    return ax


def equal(axes: Any) -> Any:
    """Axes of three dimensions with equal scales for what they show."""
    if hasattr(axes, "get_zlim"):
        axes.set_aspect("equal")
    return axes


def _struct(points: Floats, space: Space, closed: bool, channels: Floats | None = None, corners: Any = None) -> Any:
    width = 0 if channels is None else channels.shape[1]
    return [space.struct, pointer(points), len(points), flag(closed, "closed"), pointer(channels), width,
            pointer(corners, "unsigned char[]")]  # fmt: skip


def picture(curves: Any, **given: Any) -> str:
    """A picture of curves in one space, as SVG. Options are those of ``bat_curve_picture_options``."""
    keep = [array(curve, "curve", 0) for curve in curves]
    structs = [ffi.new("bat_curve *", _struct(points, curve.space, curve.closed)) for points, curve in zip(keep, curves)]
    layers = ffi.new("bat_curve_picture_layer[]", [{"curve": struct} for struct in structs])
    panel = ffi.new("bat_curve_picture_panel *", [layers, len(structs)])
    return written(lib.bat_curve_picture_write, "svg", panel, 1, options("bat_curve_picture_options", given)).decode()


def chart(lines: list[tuple[Floats, Floats]], label: str = "") -> str:
    """A chart of lines, given by x and y, as SVG."""
    keep = [[array(values, "chart", None) for values in line] for line in lines] + [ffi.new("char[]", label.encode())]
    series = ffi.new("bat_chart_series[]", [[pointer(x), pointer(y), len(x)] for x, y in keep[:-1]])
    made = ffi.new("bat_chart *", lib.bat_chart_defaults())
    made.series, made.series_count, made.x_label = series, len(series), keep[-1]
    return written(lib.bat_chart_write, "svg", made, 1, options("bat_curve_picture_options", {})).decode()


def _joined(points: Any, offsets: ArrayLike | None) -> tuple[Floats, NDArray[np.int64] | None]:
    """Points and offsets of curves that are given as a list of arrays or as both."""
    if offsets is None and not isinstance(points, np.ndarray) and isinstance(points, (list, tuple, Curves)) and len(points) and np.ndim(points[0]) == 2:
        parts = [array(part, f"curve {i}", 0) for i, part in enumerate(points)]
        if len({part.shape[1] for part in parts}) > 1:
            raise ValueError("points of all curves need the same number of coordinates")
        return np.concatenate(parts), np.cumsum([0, *map(len, parts)], dtype=np.int64)
    joined = array(points, "points", 0)
    if offsets is None:
        return joined, None
    ends = array(offsets, "offsets", None, np.int64)
    if ends.ndim != 1 or len(ends) < 1 or ends[0] != 0 or ends[-1] != len(joined) or (np.diff(ends) < 0).any():
        raise ValueError(f"offsets: increasing numbers from 0 to the number of points, {len(joined)}, are needed")
    return joined, ends


def _opened(points: Floats, ends: Any, *rest: Any) -> Any:
    """Points, offsets and further rows of closed curves, without last points that repeat the first."""
    if ends is None and (len(points) < 3 or points[0, 0] != points[-1, 0]):
        return points, ends, *rest
    bounds = np.array([0, len(points)]) if ends is None else ends
    first, last = bounds[:-1], bounds[1:] - 1
    repeated = (last > first + 2) & (points[np.minimum(first, len(points) - 1)] == points[last]).all(axis=1) if len(points) else first < 0
    if not repeated.any():
        return points, ends, *rest
    keep = np.ones(len(points), np.bool_)
    keep[last[repeated]] = False
    rows = [np.asarray(part)[keep] if part is not None and len(part) == len(points) else part for part in rest]
    return points[keep], None if ends is None else ends - np.concatenate([[0], np.cumsum(repeated)]), *rows


_REFINED = ffi.typeof("batten_refined *")
_Several = Curves | Sequence[NDArray[Any]] | Sequence[Sequence[Sequence[float]]]


@overload
def refine(points: Any, offsets: ArrayLike, *, space: Space | str | None = None, closed: bool = False,
           progress: Progress = False, **settings: Any) -> Curves: ...
@overload
def refine(points: _Several, offsets: None = None, *, space: Space | str | None = None, closed: bool = False,
           progress: Progress = False, **settings: Any) -> Curves: ...
@overload
def refine(points: Rows, offsets: None = None, *, space: Space | str | None = None, closed: bool = False,
           channels: ArrayLike | None = None, corners: ArrayLike | None = None, progress: Progress = False,
           **settings: Any) -> Curve: ...
@takes("bat_curve_refine_options")
def refine(points: Any, offsets: ArrayLike | None = None, *, space: Space | str | None = None, closed: bool = False,
           channels: ArrayLike | None = None, corners: ArrayLike | None = None, progress: Progress = False,
           **settings: Any) -> Any:
    """Refine curves by repeated subdivision.

    Parameters
    ----------
    points : array_like of shape (n, dimension), or a list of such arrays
        The points of a curve; C-contiguous arrays of float64 are not copied.
    offsets : array_like of shape (m + 1,), optional
        Cuts `points` into m curves: curve i has the points ``offsets[i]`` to ``offsets[i + 1] - 1``.
    space : Space or str, optional
        Where the points live; by default R^n.
    closed : bool
        Whether the last point of each curve joins the first. A last point that equals the first is left out.
    channels : array_like of shape (n, k), optional
        Further values at the points of one curve, which are refined with them.
    corners : array_like of n flags, optional
        Where one curve is cut.
    progress : bool or callable
        True: a progress bar of tqdm, where it is installed. A function gets the share done, and stops the call by False.
    **settings
        Fields of ``bat_curve_refine_options``.

    Returns
    -------
    Curve or Curves
        An array of points; for several curves, their points and offsets.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> batten.refine(square, closed=True, levels=3).shape
    (32, 2)
    >>> batten.refine([square, square[:3]], scheme="chaikin", levels=1).offsets
    array([ 0,  8, 14])
    """
    if type(points) is np.ndarray and offsets is None:
        joined, ends = array(points, "points", 0), None
    elif hasattr(points, "geom_type"):
        raise TypeError("points: arrays are needed; batten.smooth() takes geometries of shapely and geopandas")
    else:
        joined, ends = _joined(points, offsets)
    where = space_of(space, joined.shape[1])
    if flag(closed, "closed"):
        joined, ends, channels, corners = _opened(joined, ends, channels, corners)
    if "fairness" in settings:
        settings.setdefault("scheme", "learned")
    if where.functions:
        settings["threads"] = 1
    if ends is not None:
        if channels is not None or corners is not None:
            raise ValueError("channels and corners go with a single curve")
        how = options("bat_curve_refine_options", settings)
        done = how.report = ffi.new("bat_curve_refine_report *")
        result: Any = _refine_many(joined, ends, where, closed, how, progress)
    else:
        how, keep = shared_options("bat_curve_refine_options", settings)
        values = None if channels is None else array(channels, "channels", 0)
        flags = None if corners is None else (array(corners, "corners", None) != 0).astype(np.uint8)
        if (values is not None and len(values) != len(joined)) or (flags is not None and flags.shape != (len(joined),)):
            raise ValueError(f"channels and corners: a row for each of the {len(joined)} points is needed")
        refined = ffi.new(_REFINED)
        fine, done, width = refined.curve, refined.report, 0 if values is None else values.shape[1]
        with shown(progress, "refining"):
            call(lib.batten_refine, where.struct, pointer(joined), len(joined), closed, pointer(values), width,
                 pointer(flags, "unsigned char[]"), how, refined)  # fmt: skip
        count = fine.count
        result = _curve(take(fine.points, (count, where.point_dim)), {
            "space": where, "closed": bool(closed),
            "channels": None if values is None else take(fine.channels, (count, fine.channel_count)),
            "corners": None if fine.corners == ffi.NULL else take(fine.corners, (count,), np.bool_)})  # fmt: skip
    if ends is None and type(points) is not np.ndarray and type(points).__module__.split(".")[0] == "xarray":
        bare = points.drop_vars([name for name, values in points.coords.items() if points.dims[0] in values.dims])
        result = type(points)(result, dims=points.dims, coords=bare.isel({points.dims[0]: 0}).coords, attrs=points.attrs, name=points.name)
    if done.given_crossing or done.left_crossing:
        warnings.warn(f"{done.given_crossing} given and {done.left_crossing} refined curves cross themselves",
                      BattenWarning, stacklevel=2)  # fmt: skip
    return result


def _refine_many(points: Floats, offsets: NDArray[np.int64], space: Space, closed: bool, how: Any, progress: Progress) -> Curves:
    memory = ffi.new("double **")
    ends = np.zeros(len(offsets), np.int64)
    every = ffi.new("bat_curve *", _struct(points, space, closed))
    with shown(progress, "refining"):
        call(lib.batten_refine_ragged, every, pointer(offsets, "int64_t[]"), len(offsets) - 1, how, memory,
             pointer(ends, "int64_t[]"))  # fmt: skip
    return Curves(take(memory[0], (int(ends[-1]), space.point_dim)), ends, space, bool(closed))


class Analysis(Report):
    """What is proven of a linear scheme; drawn as its basic limit function. See :func:`analyze`."""

    def basis(self, level: int = 6) -> tuple[Floats, Floats]:
        """Where and what the values of the basic limit function are, at multiples of 2^-level."""
        basis = ffi.new("bat_basis *")
        call(lib.bat_mask_basis, _mask(self["mask"], self["first"]), level, basis)
        values = take(basis.values, (basis.count,))
        return basis.first + np.arange(len(values)) / 2**level, values

    def plot(self, ax: Any = None, **style: Any) -> Any:
        """Draw the basic limit function with matplotlib; returns the axes."""
        axes = axes_of(ax, 1)
        axes.plot(*self.basis(), **style)
        return axes

    @drawn
    def _repr_svg_(self) -> str | None:
        return chart([self.basis()])

    def __reduce__(self) -> tuple[Any, ...]:
        return Analysis, (dict(self),)


def _mask(coefficients: Any, first: int | None) -> Any:
    numbers = array(coefficients, "mask", None).reshape(-1)
    if not 1 <= len(numbers) <= lib.BAT_MASK_MAX:
        raise ValueError(f"mask: 1 to {lib.BAT_MASK_MAX} numbers are needed, not {len(numbers)}")
    return ffi.new("bat_mask *", [numbers.tolist(), len(numbers), -(len(numbers) // 2) if first is None else first])


@takes("bat_mask_analyze_options")
def analyze(scheme: str | ArrayLike, *, first: int | None = None, **settings: Any) -> Analysis:
    """Analyse a linear scheme: convergence, smoothness with proven bounds, stencils, eigenvalues.

    Parameters
    ----------
    scheme : str or array_like
        The name of a linear scheme, or the coefficients of its mask.
    first : int, optional
        The index of the first coefficient; by default the mask is centred.
    **settings
        Fields of ``bat_mask_analyze_options``.

    Returns
    -------
    Analysis
        Fields of ``bat_analysis``, and the arrays `mask`, `eigenvalues`, `matrix`, `limit` and `tangent`.

    Examples
    --------
    >>> four_point = batten.analyze("four-point")
    >>> four_point.converges, four_point.smooth_proven, four_point.reproduction_degree
    ('proven', 1, 3)
    >>> batten.analyze([0.25, 0.75, 0.75, 0.25]).limit
    array([0.5, 0.5])
    """
    if isinstance(scheme, str):
        named = ffi.new("bat_curve_scheme *")
        call_named(lib.bat_curve_scheme_by_name, scheme, named)
        if named.kind != lib.BAT_CURVE_SCHEME_KIND_LINEAR:
            raise ValueError(f"'{scheme}' is not a linear scheme, and has no mask to analyse")
        mask = ffi.addressof(named, "mask")
    else:
        mask = _mask(scheme, first)
    found = ffi.gc(ffi.new("bat_analysis *"), lib.bat_analysis_free)
    call(lib.bat_mask_analyze, mask, options("bat_mask_analyze_options", settings), found)
    size, eigen = found.matrix_size, [found.eigenvalues[i] for i in range(found.eigenvalue_count)]
    analysis = Analysis(report(found))
    for name in ("mask", "quotient", "limit", "tangent", "vertex"):
        part = analysis[name]
        analysis[name] = np.array((part["weights"] if "weights" in part else part["coefficients"])[: part["count"]])
    analysis.update(first=found.mask.first, eigenvalues=np.array([complex(e.real, e.imaginary) for e in eigen]),
                    matrix=np.array(ffi.unpack(found.matrix, size * size)).reshape(size, size))  # fmt: skip
    return analysis
