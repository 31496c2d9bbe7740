"""Spaces: the manifolds in which points live."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from batten._core import BattenError, CutLocus, Floats, InvalidPoint, array, call, call_named, ffi, keep_exception, lib, pointer, Rows

#: The functions of a space in Python, and the status that the library gets where one fails.
_NEEDED = ("exp", "log")
_GIVEN = ("exp", "log", "distance", "inner", "transport", "project", "fault")


class Space:
    """A Riemannian manifold: one of the library by its name, or one whose functions are written in Python.

    Parameters
    ----------
    name : str
        ``"plane"``, ``"euclidean"``, ``"sphere"``, ``"disk"``, ``"rotation"``, ``"rigid"``, ``"spd"`` or ``"hyperbolic"``;
        any other name with functions of your own.
    point_dim : int
        How many numbers store a point; 0 for the usual number.
    weight : float
        Of ``"rigid"``: how many radians a unit of length counts as much as.
    exp, log : callable, optional
        ``exp(p, tangent)`` and ``log(p, q)``. Like all functions of a space, they take arrays of shape ``(..., point_dim)``
        and ``(..., tangent_dim)``. Given both, the space is one of your own. An exception stops the call of the library
        and comes out of it; a :class:`CutLocus` says that the geodesic is not unique.
    distance, inner, transport, project, fault : callable, optional
        ``distance(p, q)``; ``inner(p, u, v)``, by default the scalar product; ``transport(p, q, tangent)``, by default one
        step of the pole ladder, which is exact in symmetric spaces; ``project(coordinates)``, by default what it gets, which
        motions need to be fast where tangent vectors have more numbers than the manifold has dimensions;
        ``fault(p)``, None for a point of the space, else the reason as a text.
    dimension, tangent_dim : int, optional
        Of the manifold, and how many numbers store a tangent vector; by default ``tangent_dim`` and ``point_dim``.
    injectivity : float, optional
        The injectivity radius.

    Examples
    --------
    >>> sphere = batten.Space("sphere")
    >>> float(sphere.distance([1, 0, 0], [0, 1, 0]))
    1.5707963267948966
    >>> logarithmic = batten.Space(  # positive numbers, with |log(q / p)| as the distance
    ...     "positive", 1, exp=lambda p, v: p * np.exp(v), log=lambda p, q: np.log(q / p))
    >>> batten.refine([[1.0], [4.0]], space=logarithmic, scheme="log-exp-4", levels=1).ravel()
    array([1., 2., 4.])
    """

    name: str
    point_dim: int
    tangent_dim: int

    def __init__(self, name: str, point_dim: int = 0, *, weight: float = 1.0, dimension: int = 0, tangent_dim: int = 0,
                 injectivity: float = math.inf, **functions: Callable[..., Any]) -> None:
        self._arguments = (name, point_dim), dict(weight=weight, dimension=dimension, tangent_dim=tangent_dim,
                                                  injectivity=injectivity, **functions)
        self.name, self.functions, self.struct = name, functions, ffi.new("bat_space *")
        if set(functions) - set(_GIVEN):
            raise TypeError(f"a space has no function '{min(set(functions) - set(_GIVEN))}'; there are {', '.join(_GIVEN)}")
        if not functions:
            call_named(lib.bat_space_by_name, name, point_dim, self.struct)
            if name == "rigid":
                call(lib.bat_rigid, weight, self.struct)
        elif not {"exp", "log"} <= set(functions) or point_dim < 1:
            raise TypeError("a space of your own needs exp, log and point_dim")
        else:
            self._single: dict[str, bool] = {}
            self._handle, self._name = ffi.new_handle(self), ffi.new("char[]", name.encode())
            tangent_dim = tangent_dim or point_dim
            self.struct[0] = {
                "name": self._name, "dimension": dimension or tangent_dim, "point_dim": point_dim,
                "tangent_dim": tangent_dim, "injectivity": injectivity, "weight": weight, "parameters": self._handle,
                **{name: getattr(lib, f"batten_{name}") for name in (*_GIVEN, "exp_rows", "log_rows", "transport_rows")}}  # fmt: skip
            if "inner" not in functions:
                self.struct.inner = lib.bat_euclidean(tangent_dim).inner
            call(lib.bat_space_check, self.struct, ffi.NULL, 0)
        self.point_dim, self.tangent_dim = self.struct.point_dim, self.struct.tangent_dim

    def __reduce__(self) -> tuple[Any, ...]:
        return functools.partial(Space, *self._arguments[0], **cast(Any, self._arguments[1])), ()

    def __repr__(self) -> str:
        return f"Space({self.name!r}, {self.point_dim})"

    def _transport(self, p: Floats, q: Floats, v: Floats) -> Any:
        """The user's transport, or one step of the pole ladder, of one row or many."""
        if "transport" in self.functions:
            return self.functions["transport"](p, q, v)
        exp, log = self.functions["exp"], self.functions["log"]
        # Transport is linear: the vector gets a length at which the ladder neither rounds nor passes the cut locus.
        length = np.linalg.norm(v, axis=-1, keepdims=True)
        step = min(1.0, self.struct.injectivity / 8) / np.where(length > 0, length, 1.0)
        middle, ahead = exp(p, np.asarray(log(p, q)) / 2), exp(p, step * v)
        made = np.asarray(log(q, exp(ahead, 2 * np.asarray(log(ahead, middle))))) / -step
        return np.where(length > 0, made, v)

    def _batch(self, function: Callable[..., Any], widths: str, result: str, *arrays: ArrayLike) -> Floats:
        """Call a batch function with rows that are broadcast. Widths: p of points, t of tangents, 1 of numbers."""
        width = {"p": self.point_dim, "t": self.tangent_dim, "1": 1}
        given = [array(values, "array", None) for values in arrays]
        given = [values if kind != "1" else values[..., None] for values, kind in zip(given, widths)]
        for values, kind in zip(given, widths):
            if values.shape[-1:] != (width[kind],):
                raise ValueError(f"arrays whose last axis has {width[kind]} numbers are needed, not {values.shape}")
        shape = np.broadcast_shapes(*(values.shape[:-1] for values in given))
        rows = [array(np.broadcast_to(v, (*shape, v.shape[-1])).reshape(-1, v.shape[-1]), "array", 0) for v in given]
        made = np.empty((*shape, width[result]))
        call(function, self.struct, *map(pointer, rows), len(rows[0]), pointer(made))
        return made if result != "1" else made[..., 0]

    def distance(self, p: ArrayLike, q: ArrayLike) -> Floats:
        """Geodesic distances of points."""
        return self._batch(lambda *given: lib.bat_space_distances(*given[:-1]) or 0, "pp", "1", p, q)

    def log(self, p: ArrayLike, q: ArrayLike) -> Floats:
        """The tangent vectors at `p` that exp() takes to `q`."""
        return self._batch(lib.bat_space_logs, "pp", "t", p, q)

    def exp(self, p: ArrayLike, tangent: ArrayLike) -> Floats:
        """End points of geodesics that begin at `p` with a velocity, after unit time."""
        return self._batch(lib.bat_space_exps, "pt", "p", p, tangent)

    def transport(self, p: ArrayLike, q: ArrayLike, tangent: ArrayLike) -> Floats:
        """Tangent vectors at `p`, transported to `q` along the shortest geodesic."""
        return self._batch(lib.bat_space_transports, "ppt", "t", p, q, tangent)

    def geodesic(self, p: ArrayLike, q: ArrayLike, share: ArrayLike) -> Floats:
        """Points at shares of the geodesics from `p` to `q`: 0 gives `p`, 1 gives `q`."""
        return self._batch(lib.bat_space_geodesics, "pp1", "p", p, q, share)

    def project(self, coordinates: ArrayLike) -> Floats:
        """The nearest points of the space, for coordinates that were rounded."""
        return self._batch(lib.bat_space_project, "p", "p", coordinates)


@functools.lru_cache(64)
def _named(name: str, point_dim: int) -> Space:
    return Space(name, point_dim)


def space_of(space: Space | str | None, columns: int) -> Space:
    """A space from what a caller named it by, for points of so many numbers; None: R^n."""
    if not isinstance(space, Space):
        if space is not None and not isinstance(space, str):
            raise TypeError(f"space: a Space or the name of one is needed, not {space!r}")
        space = _named("euclidean" if space is None else space, columns)
    if space.point_dim != columns:
        raise ValueError(f"points of {space!r} have {space.point_dim} numbers, not {columns}")
    return space


class Frames:
    """A space of a user whose tangent vectors lie across those of a space around, with coordinates in their place.

    The library makes motions of such coordinates from calls of many rows, and motions of other ones point by point. `space`
    has them: numbers of an orthonormal basis of the tangent space, which depends on the point alone.
    """

    space: Space

    def __init__(self, around: Space, reach: float, rank: int) -> None:
        self._around, self._reach, self._rank, self._many = around, reach, rank, False
        self._fixed: list[Floats] = []
        self._found: dict[bytes, tuple[Floats, Floats]] = {}
        given = around.functions
        functions: dict[str, Any] = {name: given[name] for name in ("distance", "project", "fault") if name in given}
        functions["exp"] = lambda p, a: given["exp"](p, self.vectors(p, a))
        functions["log"] = lambda p, q: self.coordinates(p, np.asarray(given["log"](p, q), np.float64))
        functions["transport"] = lambda p, q, a: self.coordinates(q, np.asarray(around._transport(p, q, self.vectors(p, a)), np.float64))
        self.space = Space(around.name, around.point_dim, dimension=rank, tangent_dim=rank, injectivity=around.struct.injectivity, **functions)

    @classmethod
    def of(cls, around: Space, points: Floats) -> Frames | None:
        """Frames for motions through points. None where tangent vectors have no number too many, or it is not known."""
        if not {"exp", "log", "project"} <= set(around.functions) or len(points) < 2 or not np.isfinite(points).all():
            return None
        for share in (8, 512):
            reach = min(abs(points - points[0]).max() / share, around.struct.injectivity / 8)
            try:
                made = cls(around, reach, around.tangent_dim)
                made._many = made._takes_rows(points[0])
                ranks = {made._basis(point)[1] for point in points}
                if len(ranks) == 1 and 0 < (rank := ranks.pop()) < around.tangent_dim:
                    many, made = made._many, cls(around, reach, rank)
                    made._many = many
                    return made
            except Exception:  # of functions that fail away from the space; calls of the library tell it where it matters
                continue
        return None

    def _logs(self, p: Floats, many: bool) -> Floats:
        """Logarithms at p of points around it, by calls of many rows or of one."""
        project, log, steps = self._around.functions["project"], self._around.functions["log"], self._reach * np.eye(len(p))
        near = p + np.concatenate([steps, -steps])
        with np.errstate(all="ignore"):
            if many:
                return np.asarray(log(np.broadcast_to(p, near.shape).copy(), np.asarray(project(near), np.float64)), np.float64)
            points = [np.asarray(project(q), np.float64).reshape(-1) for q in near]
            return np.array([np.asarray(log(p, q), np.float64).reshape(-1) for q in points])

    def _takes_rows(self, p: Floats) -> bool:
        one = self._logs(p, False)
        try:
            many = self._logs(p, True)
        except Exception:
            return False
        return many.shape == one.shape and bool(np.allclose(many, one, rtol=1e-12, atol=1e-12 * abs(one).max()))

    def _basis(self, p: Floats) -> tuple[Floats, int]:
        """An orthonormal basis of the logarithms of points around p, and their rank, which is 0 where that is not clear."""
        _, sizes, basis = np.linalg.svd(self._logs(p, self._many))
        rank = int((sizes > 1e-10 * sizes[0]).sum())
        return basis, rank if sizes[rank - 1] > 1e-4 * sizes[0] else 0

    def _aligned(self, basis: Floats) -> Floats:
        """The basis of the same space that is nearest to a fixed one, so that it is continuous. No fixed one is near
        everywhere: the first that is near enough, in directions in which no data has its symmetries."""
        if not self._fixed:
            draws = np.random.default_rng(1).normal(size=(16, *basis.shape))
            self._fixed = [np.linalg.qr(draw.T)[0].T for draw in draws]
        parts = []
        for fixed in self._fixed:
            left, sizes, right = np.linalg.svd(fixed @ basis.T)
            parts.append((sizes[-1], left @ right))
            if sizes[-1] > 0.3:
                break
        turn: Floats = max(parts, key=lambda part: part[0])[1]
        return turn @ basis

    def _at(self, p: Floats) -> tuple[Floats, Floats]:
        """The matrices that take coordinates to vectors at p, and back."""
        key = p.tobytes()
        found = self._found.get(key)
        if found is None:
            (basis, rank), inner = self._basis(p), self._around.functions.get("inner")
            if rank != self._rank:
                raise InvalidPoint(f"the tangent vectors at {p} have {rank} dimensions, not {self._rank}")
            basis = self._aligned(basis[:rank])
            back = basis.T
            if inner is not None:
                root = np.linalg.cholesky([[float(inner(p, u, v)) for v in basis] for u in basis])
                basis, back = np.linalg.solve(root, basis), back @ root
            if len(self._found) >= 65536:
                self._found.clear()
            found = self._found[key] = basis, back
        return found

    def _turned(self, points: Floats, rows: Floats, way: int) -> Floats:
        if points.ndim == 1:
            return np.asarray(rows @ self._at(points)[way])
        turned: Floats = np.einsum("ni,nij->nj", rows, np.array([self._at(point)[way] for point in points]).reshape(len(points), rows.shape[1], -1))
        return turned

    def vectors(self, points: Floats, coordinates: Floats) -> Floats:
        """The tangent vectors of a user at points that have coordinates."""
        return self._turned(points, coordinates, 0)

    def coordinates(self, points: Floats, vectors: Floats) -> Floats:
        """The coordinates of tangent vectors at points."""
        return self._turned(points, vectors, 1)


def _refuse(bad: Any, rows: Floats, name: str, fault: str) -> None:
    """Refuse the first row that is bad."""
    if bad.any():
        index = int(np.flatnonzero(bad)[0])
        error = InvalidPoint(f"{name}: point {index}, ({', '.join(f'{number:.10g}' for number in rows[index])}), {fault}")
        error.status, error.index = "invalid point", index
        raise error


def from_lonlat(degrees: Rows) -> Floats:
    """Points of the sphere, unit vectors, from longitudes and latitudes in degrees.

    Raises :class:`InvalidPoint` for a latitude outside -90 to 90 degrees and for numbers that are not finite.

    Examples
    --------
    >>> batten.from_lonlat([[90.0, 0.0]]).round(12)
    array([[0., 1., 0.]])
    """
    given = array(degrees, "degrees", 2)
    _refuse(~np.isfinite(given).all(axis=1), given, "degrees", "is not finite")
    _refuse(np.abs(given[:, 1]) > 90, given, "degrees", "has a latitude outside -90 to 90 degrees; longitudes come first")
    given = np.radians(given)
    cos = np.cos(given[:, 1])
    return np.stack([cos * np.cos(given[:, 0]), cos * np.sin(given[:, 0]), np.sin(given[:, 1])], axis=1)


def to_lonlat(points: Rows) -> Floats:
    """Longitudes and latitudes in degrees of points of the sphere; other vectors have those of their directions.

    Raises :class:`InvalidPoint` for the zero vector and for numbers that are not finite.

    Examples
    --------
    >>> batten.to_lonlat([[0.0, 1.0, 0.0]])
    array([[90.,  0.]])
    """
    given = array(points, "points", 3)
    _refuse(~np.isfinite(given).all(axis=1), given, "points", "is not finite")
    _refuse(~given.any(axis=1), given, "points", "is zero, which has no direction")
    x, y, z = given.T
    degrees: Floats = np.degrees(np.stack([np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))], axis=1))
    return degrees


# Functions of the library's struct that call those in Python.


def _row(space: Any, numbers: Any, kind: str = "point_dim") -> Floats:
    width = getattr(space, kind)
    return np.frombuffer(ffi.buffer(numbers, 8 * width), np.float64).copy()


def _put(made: Any, result: Any, width: int) -> int:
    values = np.asarray(made, np.float64).reshape(-1)
    if len(values) != width:
        raise ValueError(f"a function of a space returned {len(values)} numbers, not {width}")
    if not np.isfinite(values).all():
        return int(lib.BAT_INVALID_POINT)
    ffi.memmove(result, np.ascontiguousarray(values), 8 * width)
    return 0


def _failed(kind: Any, exception: Any, trace: Any) -> int | None:
    if isinstance(exception, CutLocus):
        return int(lib.BAT_CUT_LOCUS)
    if not isinstance(exception, InvalidPoint):
        keep_exception(kind, exception, trace)
    return None


def _callback(name: str) -> Callable[[Callable[..., Any]], Any]:
    number = name in ("distance", "inner")
    error: Any = math.nan if number else ffi.NULL if name == "fault" else lib.BAT_INVALID_POINT
    return ffi.def_extern(f"batten_{name}", error=error, onerror=keep_exception if number else _failed)  # type: ignore


def _own(space: Any) -> Space:
    return ffi.from_handle(space.parameters)  # type: ignore[no-any-return]


@_callback("exp")
def _exp(space: Any, p: Any, tangent: Any, q: Any) -> int:
    made = _own(space).functions["exp"](_row(space, p), _row(space, tangent, "tangent_dim"))
    return _put(made, q, space.point_dim)


@_callback("log")
def _log(space: Any, p: Any, q: Any, tangent: Any) -> int:
    return _put(_own(space).functions["log"](_row(space, p), _row(space, q)), tangent, space.tangent_dim)


def _rows(space: Any, numbers: Any, count: int, kind: str = "point_dim") -> Floats:
    width = getattr(space, kind)
    return np.frombuffer(ffi.buffer(numbers, 8 * width * count), np.float64).reshape(count, width).copy()


def _put_rows(space: Space, name: str, one: Callable[..., Any], given: tuple[Floats, ...], result: Any, width: int) -> int:
    """Call a function with many rows; where it takes single ones alone, the library calls it row by row."""
    if space._single.get(name, False):
        return int(lib.BAT_UNSUPPORTED)
    try:
        made = np.asarray(one(*given), np.float64)
        good = made.shape == (len(given[0]), width) and bool(np.isfinite(made).all())
        if good and name not in space._single:
            last = np.asarray(one(*(rows[-1] for rows in given)), np.float64).reshape(-1)
            good = np.allclose(last, made[-1], rtol=1e-12, atol=1e-12 * abs(made).max())
            space._single[name] = not good
    except Exception:
        good = False
    if not good:
        return int(lib.BAT_UNSUPPORTED)
    ffi.memmove(result, np.ascontiguousarray(made), made.nbytes)
    return 0


@_callback("exp_rows")
def _exp_rows(space: Any, p: Any, tangents: Any, count: int, q: Any) -> int:
    own, given = _own(space), (_rows(space, p, count), _rows(space, tangents, count, "tangent_dim"))
    return _put_rows(own, "exp", own.functions["exp"], given, q, space.point_dim)


@_callback("log_rows")
def _log_rows(space: Any, p: Any, q: Any, count: int, tangents: Any) -> int:
    own, given = _own(space), (_rows(space, p, count), _rows(space, q, count))
    return _put_rows(own, "log", own.functions["log"], given, tangents, space.tangent_dim)


@_callback("transport_rows")
def _transport_rows(space: Any, p: Any, q: Any, tangents: Any, count: int, made: Any) -> int:
    own, given = _own(space), (_rows(space, p, count), _rows(space, q, count), _rows(space, tangents, count, "tangent_dim"))
    return _put_rows(own, "transport", own._transport, given, made, space.tangent_dim)


@_callback("inner")
def _inner(space: Any, p: Any, u: Any, v: Any) -> float:
    u, v = _row(space, u, "tangent_dim"), _row(space, v, "tangent_dim")
    inner = _own(space).functions.get("inner")
    return float(np.dot(u, v) if inner is None else inner(_row(space, p), u, v))


@_callback("distance")
def _distance(space: Any, p: Any, q: Any) -> float:
    functions, p, q = _own(space).functions, _row(space, p), _row(space, q)
    if "distance" in functions:
        return float(functions["distance"](p, q))
    tangent = functions["log"](p, q)
    return math.sqrt(functions["inner"](p, tangent, tangent) if "inner" in functions else np.dot(tangent, tangent))


@_callback("project")
def _project(space: Any, coordinates: Any, point: Any) -> int:
    given = _row(space, coordinates)
    project = _own(space).functions.get("project")
    return _put(given if project is None else project(given), point, space.point_dim)


@_callback("transport")
def _transport(space: Any, p: Any, q: Any, tangent: Any, made: Any) -> int:
    made_of = _own(space)._transport(_row(space, p), _row(space, q), _row(space, tangent, "tangent_dim"))
    return _put(made_of, made, space.tangent_dim)


@_callback("fault")
def _fault(space: Any, p: Any) -> Any:
    own, point = _own(space), _row(space, p)
    fault = own.functions.get("fault")
    reason = None if fault is None else fault(point)
    if reason is None and not np.isfinite(point).all():
        reason = "not finite"
    own._reason = None if reason is None else ffi.new("char[]", str(reason).encode())  # type: ignore[attr-defined]
    return ffi.NULL if reason is None else own._reason  # type: ignore[attr-defined]
