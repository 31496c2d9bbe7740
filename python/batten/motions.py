"""Motions: splines in time through poses, rotations and points of any space."""

from __future__ import annotations

import datetime
import functools
import math
import os
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from batten._core import BattenError, BattenWarning, Floats, InvalidPoint, Unsupported, array, call, call_on_file, drawn, ffi, flag, lib, like, options, pointer, takes, unmasked, written
from batten.curves import axes_of
from batten.spaces import Frames, Space, space_of

#: Numbers, dates or durations, one or several. Those of numpy and pandas are arrays to checkers of types.
Times = ArrayLike | datetime.date | datetime.timedelta | Sequence[datetime.date] | Sequence[datetime.timedelta]

#: The largest distance of a rounded point from its space.
_FAR = 0.05


#: Options of motions that have vectors, or evaluate the motion at points whose frames cost more than they save.
_POINTWISE = {"begin_velocity", "end_velocity", "max_speed", "max_acceleration"}


class Motion:
    """The spline through poses at their times. It is called with times, as splines of scipy are.

    Parameters
    ----------
    times : array_like of shape (n,)
        Increasing numbers, or dates and durations of Python, numpy or pandas, which count in seconds.
    poses : array_like, or Rotation or RigidTransform of scipy.spatial.transform
        Rows of points of the space: unit quaternions (w, x, y, z) for rotations; translation and quaternion, 7 numbers, for
        rigid motions. Matrices (n, 3, 3) are rotations, and (n, 4, 4) rigid motions, unless `space` says otherwise: with
        ``"spd"`` square matrices are tensors, with R^n any numbers. An array (n,) is a motion on the line. Results have the
        same form. Rounded points move onto the space, with a warning from 1e-3 on.
    space : Space or str, optional
        By default what `poses` are: rotations and matrices tell; else R^n. ``"rotation"`` and ``"rigid"`` take quaternions.
    velocities : array_like, optional
        The velocities at the times; by default, and where all numbers of a row are NaN, those that make the acceleration
        continuous. Of rigid motions this holds for the two parts by themselves.
    gyro : (times, rates) or (times, rates, forces), optional
        Angular rates of a gyroscope in the body's frame, rows of x, y and z in radians a second, between the poses. Its bias
        and the noise of both are found; see `bias`. `times` then has those of the rates, too. Translations follow the
        specific forces of an accelerometer beside it, in units of length a squared second; see `accelerometer`.
    project : bool
        Move points that are farther than 0.05 off their space onto it, too, and warn of none.
    closed : bool
        Whether the motion is periodic.
    period : float
        Of a closed motion: the time of a round; by default that until a last pose that repeats the first. Such a pose is
        left out.
    wrap : float
        Of R^n: coordinates are angles with this full turn, as 360, and go the shorter way from pose to pose. Results begin
        at 0, or lie around 0 where a pose is negative.
    **settings
        Fields of ``bat_motion_spline_options``.

    Examples
    --------
    >>> motion = batten.Motion([0, 1, 2, 3], [[0.0], [1.0], [8.0], [27.0]])
    >>> motion(1.5), motion.velocity(1.5)
    (array([3.375]), array([6.75]))
    >>> from scipy.spatial.transform import Rotation
    >>> turn = batten.Motion([0, 1, 2], Rotation.from_rotvec([[0, 0, 0], [0, 0, 1], [0, 0, 2]]))
    >>> turn([0.5, 1.5]).as_rotvec()[:, 2].round(9)
    array([0.5, 1.5])
    """

    space: Space
    times: Floats
    poses: Any

    @takes("bat_motion_spline_options")
    def __init__(self, times: Times, poses: Any, *, space: Space | str | None = None,
                 velocities: ArrayLike | None = None, gyro: tuple[Times, ...] | None = None, project: bool = False, closed: bool = False, period: float = 0.0,
                 wrap: float = 0.0, **settings: Any) -> None:
        closed = flag(closed, "closed")
        self._arguments = (times, poses), dict(space=space, velocities=velocities, gyro=gyro, project=project, closed=closed,
                                               period=period, wrap=wrap, **settings)
        self._origin: Any = None  # the first date; False where times are no dates
        keys, self._form, implied = _points(poses, project, space)
        self.space = space_of(implied if space is None else space, keys.shape[1])
        keys = _onto(self.space, keys, project)
        moments = self._seconds(times)
        self._origin = False if self._origin is None else self._origin
        if moments.shape != (len(keys),):
            raise ValueError(f"times: {len(keys)} numbers are needed, one for each pose, not an array of {moments.shape}")
        given: Any = velocities
        if velocities is not None:
            raw = unmasked(velocities, "velocities")
            raw = raw[:, None] if self._form == "numbers" and raw.ndim == 1 else raw
            unknown = np.isnan(raw) if raw.dtype.kind == "f" else np.zeros(raw.shape, bool)
            given = array(np.where(unknown, 0, raw), "velocities", self.space.tangent_dim)
            given = np.where(unknown.reshape(given.shape), np.nan, given) if unknown.any() else given
        if given is not None and len(given) != len(keys):
            raise ValueError(f"velocities: {len(keys)} rows are needed, not {len(given)}")
        self._turn, self._low = wrap, -wrap / 2 if (keys < 0).any() else 0.0
        if closed and _returns(self.space, keys):
            period = period or moments[-1] - moments[0]
            keys, moments, given = keys[:-1], moments[:-1], given if given is None else given[:-1]
        self._drift, self._begin = np.zeros(keys.shape[1]), moments[0] if len(moments) else 0.0
        if wrap:
            keys = _unwrapped(self.space, keys, wrap)
        if closed and not period > moments[-1] - moments[0]:
            raise ValueError(f"period: a closed motion needs one above {moments[-1] - moments[0]}, not {period}")
        if wrap and closed:
            # Whole rounds in a period are a drift, beside which the angles return.
            self._drift = wrap * np.round((keys[-1] - keys[0]) / wrap) / period
            keys = keys - self._drifted(moments)
            given = given if given is None else given - self._drift
        self._frames = Frames.of(self.space, keys) if self.space.functions and not _POINTWISE & set(settings) else None
        lying = given
        if self._frames is not None and given is not None:
            known = ~np.isnan(given).all(axis=1)
            lying = np.full((len(keys), self._frames.space.tangent_dim), np.nan)
            lying[known] = self._frames.coordinates(keys[known], given[known])
            off = abs(self._frames.vectors(keys[known], lying[known]) - given[known])
            if not (off <= 1e-9 * abs(given[known]).max(initial=0.0)).all():
                self._frames, lying = None, given
        self._inside = self.space if self._frames is None else self._frames.space
        kind = lib.BAT_HERMITE_TANGENTS_AUTO if given is None else lib.BAT_HERMITE_TANGENTS_VELOCITIES
        curve = ffi.new("bat_hermite_curve *", [self._inside.struct, pointer(keys), pointer(lying), pointer(moments), len(keys),
                                                closed, moments[0] + period - moments[-1] if closed else 0.0, kind])
        made = ffi.new("bat_motion_spline **")
        if self.space.functions:
            settings["threads"] = 1
        if isinstance(settings.get("sigma"), str) and settings["sigma"] == "auto":
            found = {"sigma": -1.0, "angle_sigma": -1.0} if self.space.name == "rigid" else {"sigma": -1.0}
            settings = {**settings, **found}
        how = options("bat_motion_spline_options", settings)
        if gyro is not None:
            when, *rows = self._seconds(gyro[0]), *(array(r, "gyro", 3) for r in gyro[1:])
            if any(when.shape != (len(r),) for r in rows):
                raise ValueError(f"gyro: {len(rows[0])} times are needed, one for each row of rates, not {when.shape}")
            forces = pointer(rows[1]) if len(rows) > 1 else ffi.NULL
            how.gyro = measured = ffi.new("bat_motion_gyro *", [pointer(when), pointer(rows[0]), len(when), forces])
        try:
            call(lib.bat_motion_spline_make, curve, how, made)
        except BattenError:
            if self._frames is None:
                raise
            self._frames, self._inside, curve.space, curve.tangents = None, self.space, self.space.struct, pointer(given)
            call(lib.bat_motion_spline_make, curve, how, made)
        self._spline = ffi.gc(made[0], lib.bat_motion_spline_free)
        made_keys = lib.bat_motion_spline_keys(self._spline)
        self.times = np.frombuffer(ffi.buffer(made_keys.times, 8 * made_keys.count)).copy()
        self.poses, self._keys, self._outliers = poses, keys, how.outliers

    def _seconds(self, times: Any) -> Floats:
        """Times as numbers: dates in seconds since the first one that the motion got, durations in seconds."""
        given = unmasked(times, "times")
        if given.dtype == object and given.size:
            given = np.array([_moment(time) for time in given.flat]).reshape(given.shape)
        if given.dtype.kind == "M" and self._origin is False:
            raise TypeError("times: numbers or durations are needed, as the motion was made with, not dates")
        if given.dtype.kind == "M":
            self._origin = given.flat[0] if self._origin is None and given.size else self._origin
            given = given - self._origin
        if given.dtype.kind == "m":
            given = given / np.timedelta64(1, "s")
        return array(given, "times", None)

    def _drifted(self, moments: Floats) -> Floats:
        return self._drift * (moments[..., None] - self._begin)  # type: ignore[no-any-return]

    def _at(self, times: Times, which: int) -> Floats:
        moments = self._seconds(times)
        widths = [self.space.point_dim, self._inside.tangent_dim, self._inside.tangent_dim]
        made = [np.empty((*moments.shape, width)) for width in widths]
        wanted = [pointer(made[i]) if i in (0, which) else ffi.NULL for i in range(3)]
        call(lib.bat_motion_spline_sample, self._spline, pointer(moments), moments.size, *wanted)
        if which and self._frames is not None:
            rows = self._frames.vectors(made[0].reshape(-1, widths[0]), made[which].reshape(-1, widths[1]))
            return rows.reshape(*moments.shape, self.space.tangent_dim)
        if self._drift.any() and which < 2:
            made[which] += self._drift if which else self._drifted(moments)
        return made[which]

    def __call__(self, times: Times) -> Any:
        """The poses at times, in the form of those that the motion was made of."""
        if isinstance(times, float) and not self._turn:  # without what arrays cost
            pose, is_rotation = np.empty(self.space.point_dim), self._form == "Rotation"
            call(lib.batten_pose, self._spline, times, is_rotation, pointer(pose))
            return _rotation(pose) if is_rotation else self._formed(pose)
        return self._formed(self._at(times, 0))

    def _formed(self, points: Floats) -> Any:
        """Points in the form of the given ones, and in the range of these where they are angles."""
        return _form(points - self._turn * np.floor((points - self._low) / self._turn) if self._turn else points, self._form)

    def _tangents(self, rows: Floats) -> Floats:
        """Rows for each number of a velocity; numbers where poses are numbers."""
        return rows[..., 0][()] if self._form == "numbers" else rows  # type: ignore[no-any-return]

    def velocity(self, times: Times) -> Floats:
        """Velocities: of rotations angular ones in the body's frame; of rigid motions translation, then rotation."""
        return self._tangents(self._at(times, 1))

    def acceleration(self, times: Times) -> Floats:
        """Accelerations, the covariant derivatives of the velocities."""
        return self._tangents(self._at(times, 2))

    @classmethod
    @like("Motion.__init__")
    def read(cls, path: str | os.PathLike[str], *, space: Space | str | None = None, project: bool = False, closed: bool | None = None, period: float = 0.0,
             format: str = "auto", columns: str | None = None, time_unit: str = "auto", euler: str | None = None,
             key_times: str | os.PathLike[str] | None = None, **settings: Any) -> Motion:
        """The motion in a file: TUM, EuRoC, KITTI or CSV, with its velocities. Times are seconds, of stamps since 1970.

        What the reader assumes and leaves out comes as a :class:`BattenWarning`.

        Parameters
        ----------
        path : str or path
            The file.
        space, project
            As of :class:`Motion`; by default the space that the file implies.
        closed, period
            As of :class:`Motion`; by default as the file tells. Without a period and a last pose that repeats the first, a
            closed motion goes on one mean step beyond the last pose.
        format : str
            By default that of the file's ending; :func:`choices` lists those of ``"curve_format"``.
        columns : str, optional
            Of CSV: the columns of the coordinates, as in ``"x,y"``.
        time_unit : str
            ``"seconds"``, ``"milliseconds"``, ``"microseconds"`` or ``"nanoseconds"``; by default what names and sizes tell.
        euler : str, optional
            Of CSV: the order and the unit of roll, pitch and yaw, as in ``"zyx,degrees"``.
        key_times : str or path, optional
            Of KITTI: the file of times.
        **settings
            Those of :class:`Motion`.
        """
        named = space.name if isinstance(space, Space) and not space.functions else space if isinstance(space, str) else None
        given: dict[str, Any] = {"space": named, "columns": columns, "euler": euler, "key_times": key_times if key_times is None else os.fspath(key_times)}
        given = {name: value for name, value in given.items() if value is not None}
        read = options("bat_curve_read_options", {"motion": True, "project": flag(project, "project"), "format": format, "time_unit": time_unit,
                                                  "closed": -1 if closed is None else int(flag(closed, "closed")), **given})  # fmt: skip
        made = ffi.new("bat_curve_set *")
        call_on_file(lib.bat_curve_read, path, read, made)
        notes: list[str] = []
        keys = ffi.new("bat_hermite_curve *")
        how = options("bat_motion_curves_options", {"method": "spline", "period": period})
        try:
            while note := lib.bat_curve_set_note(made, len(notes)):
                notes.append(ffi.string(note).decode(errors="replace"))
            if made.count > 1:
                notes.append(f"the file has {made.count} motions; this is the first")
            has_velocities = lib.bat_motion_has_velocities(made)
            call_on_file(lambda _, *given: lib.bat_motion_data(*given), path, made, 0, how, keys)
            where, origin = made.space, lib.bat_curve_set_time_origin(made)
            points = np.frombuffer(ffi.buffer(keys.points, 8 * keys.count * where.point_dim)).reshape(keys.count, -1).copy()
            if has_velocities:
                tangents = np.frombuffer(ffi.buffer(keys.tangents, 8 * keys.count * where.tangent_dim))
                settings.setdefault("velocities", tangents.reshape(keys.count, -1).copy())
            times = np.frombuffer(ffi.buffer(keys.times, 8 * keys.count)).copy()
            if goes_round := bool(keys.closed):
                period = times[-1] - times[0] + keys.closing_time
            space = space if isinstance(space, Space) else Space(ffi.string(where.name).decode(), where.point_dim)
        finally:
            lib.bat_hermite_free(keys)
            lib.bat_curve_set_free(made)
        for note in notes:
            warnings.warn(f"{os.fsdecode(path)}: {note}", BattenWarning, stacklevel=2)
        return cls(times + origin, points, space=space, project=project, closed=goes_round, period=period, **settings)

    def _key_rows(self, values: Any, columns: int) -> Floats:
        return np.frombuffer(ffi.buffer(values, 8 * len(self.times) * columns)).reshape(-1, columns).copy()

    @property
    def keys(self) -> Any:
        """The poses at the times: those given, or smoothed ones."""
        return self._formed(self._key_rows(lib.bat_motion_spline_keys(self._spline).points, self.space.point_dim) + self._drifted(self.times))

    @property
    def deviations(self) -> Floats:
        """The distances of the given poses from a smoothed motion, in units of its noise."""
        return self._key_rows(lib.bat_motion_spline_keys(self._spline).deviations, 1).ravel()

    def _check_smoothed(self) -> None:
        if any(self.noise) or self._arguments[1]["gyro"] is not None:
            return
        why = "the motion passes through its poses; sigma= tells their noise"
        if self._arguments[1].get("sigma", 0) not in (None, 0):
            why = "the poses, which are few or exact, tell no noise; sigma= takes a number"
        error = Unsupported(f"uncertainty: {why}")
        error.status, error.remedy = "unsupported", "sigma"
        raise error

    @property
    def uncertainties(self) -> Floats:
        """The standard deviations of the smoothed poses, for each number of a velocity.

        Raises :class:`Unsupported` for a motion that nothing smoothed.
        """
        self._check_smoothed()
        return self._tangents(self._key_rows(lib.bat_motion_spline_keys(self._spline).uncertainties, self.space.tangent_dim))

    def uncertainty(self, times: Times) -> Floats:
        """The standard deviations of a smoothed motion at times, for each number of a velocity.

        Raises :class:`Unsupported` for a motion that nothing smoothed.
        """
        moments = self._seconds(times)
        self._check_smoothed()
        made = np.empty((*moments.shape, self.space.tangent_dim))
        call(lib.bat_motion_spline_uncertainty, self._spline, pointer(moments), moments.size, pointer(made))
        return self._tangents(made)

    @property
    def noise(self) -> tuple[float, float]:
        """The noise of the poses, given or estimated; of rigid motions of translations and of rotations."""
        keys = lib.bat_motion_spline_keys(self._spline)
        return keys.sigma, keys.angle_sigma

    @property
    def bias(self) -> tuple[Floats, Floats]:
        """The bias of the gyroscope about x, y and z, and its standard deviations, in radians a second."""
        found = lib.bat_motion_spline_keys(self._spline).gyro
        return np.array(list(found.bias)), np.array(list(found.bias_sigma))

    @property
    def accelerometer(self) -> dict[str, Any]:
        """The accelerometer's bias, its standard deviations, gravity, the noise, the share of the energy of the poses' accelerations that it explains, and whether it is used."""
        found = lib.bat_motion_spline_keys(self._spline).force
        told = {name: np.array(list(getattr(found, name))) for name in ("bias", "bias_sigma", "gravity")}
        return {**told, "noise": found.noise, "explained": found.explained, "used": found.used}

    @property
    def range(self) -> tuple[float, float]:
        """The times of the first and of the last pose, in seconds."""
        keys = lib.bat_motion_spline_keys(self._spline)
        return keys.begin, keys.end

    def __repr__(self) -> str:
        return f"<Motion of {len(self.times)} poses in {self.space!r}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _motion, self._arguments

    def plot(self, ax: Any = None, samples: int = 500, **style: Any) -> Any:
        """Draw the coordinates against time with matplotlib; returns the axes."""
        times, axes = np.linspace(*self.range, samples), axes_of(ax, 1)
        axes.plot(times, self._at(times, 0), **style)
        return axes

    @takes("bat_motion_picture_options")
    def picture(self, *, suffix: str = "svg", **settings: Any) -> bytes:
        """The path with frames of the body, or a strip of poses, and the speeds below, as the bytes of a file (svg, png or
        pdf)."""
        curve = ffi.new("bat_curve *", [self._inside.struct, pointer(self._keys), len(self._keys), self._arguments[1]["closed"]])
        keyframes = ffi.new("bat_curve_set *", {"space": self._inside.struct, "curves": curve, "count": 1})
        return written(lib.bat_motion_splines_picture_write, suffix, keyframes, ffi.new("bat_motion_spline *[]", [self._spline]),
                       self._outliers, options("bat_motion_picture_options", settings))  # fmt: skip

    @drawn
    def _repr_svg_(self) -> str | None:
        return self.picture().decode()


def _moment(time: Any) -> Any:
    """A date or a duration of Python or pandas, as one of numpy; dates of a time zone in universal time."""
    if isinstance(time, datetime.datetime) and time.tzinfo is not None:
        time = time.astimezone(datetime.timezone.utc).replace(tzinfo=None)
    to_numpy = getattr(time, "to_numpy", None)
    if to_numpy is not None:
        return to_numpy()
    if isinstance(time, datetime.timedelta):
        return np.timedelta64(time, "us")
    return np.datetime64(time, "us") if isinstance(time, (datetime.datetime, datetime.date)) else time


def _motion(given: tuple[Any, Any], settings: dict[str, Any]) -> Motion:
    return Motion(*given, **settings)


def _warn(off: float, project: bool) -> None:
    if off > 1e-3 and not project:
        warnings.warn(f"poses: moved onto their space by up to {off:.2g}; project=True is silent", BattenWarning, stacklevel=4)


def _onto(space: Space, keys: Floats, project: bool) -> Floats:
    """The points, those that are off their space moved onto it."""
    if space.functions or not len(keys) or space.name not in ("rotation", "rigid", "sphere", "hyperbolic"):
        return keys
    try:
        near = space.project(keys)
    except BattenError:
        return keys
    off = abs(near - keys).max(axis=1)
    if off.max() > _FAR and not project:
        return keys
    _warn(off.max(), project)
    return np.where((off > 1e-12)[:, None], near, keys)


def _returns(space: Space, keys: Floats) -> bool:
    """Whether a closed motion ends with its first point again, up to rounding: the rule of ``bat_motion_data()``."""
    if len(keys) <= 3:
        return False
    apart = space.distance(keys[0], keys[1:])
    return bool(apart[-1] <= 1e-9 * apart.max())


def _unwrapped(space: Space, keys: Floats, turn: float) -> Floats:
    """Angles that go the shorter way from key to key, by the rule of ``bat_motion_data()``."""
    if space.name not in ("plane", "euclidean") or not 0 < turn < np.inf:
        what = "a positive number is needed" if space.name in ("plane", "euclidean") else f"is for numbers, not for {space!r}"
        raise ValueError(f"wrap: {what}")
    columns = keys.T.tolist()
    for column in columns:
        for i in range(1, len(column)):
            step = (column[i] - column[i - 1]) / turn
            column[i] -= turn * math.copysign(math.floor(abs(step) + 0.5), step) if math.isfinite(step) else 0.0
    return np.array(columns).T.copy()


def _triangles(tensors: Floats, project: bool) -> Floats:
    """The upper triangles of symmetric matrices."""
    turned = tensors.swapaxes(1, 2)
    off = abs(tensors - turned).max(axis=(1, 2), initial=0.0)
    bad = off > 1e-6 * abs(tensors).max(axis=(1, 2), initial=0.0)
    if bad.any() and not project:
        raise InvalidPoint(f"poses: matrix {np.flatnonzero(bad)[0]} is not symmetric; project=True takes the mean with its transpose")
    rows, columns = np.triu_indices(tensors.shape[1])
    return np.ascontiguousarray(((tensors + turned) / 2)[:, rows, columns])


def _points(poses: Any, project: bool, space: Space | str | None) -> tuple[Floats, Any, str | None]:
    """Rows of points, the form that they came in, and the space that it implies."""
    if hasattr(poses, "as_matrix") and hasattr(poses, "translation"):  # RigidTransform of scipy
        return _points(np.atleast_3d(poses.as_matrix()).reshape(-1, 4, 4), project, None)[0], "RigidTransform", "rigid"
    if hasattr(poses, "as_quat"):
        return array(np.atleast_2d(poses.as_quat())[:, [3, 0, 1, 2]], "poses", 4), "Rotation", "rotation"
    given = unmasked(poses, "poses")
    name = space.name if isinstance(space, Space) else space
    if given.ndim == 1:
        return array(given, "poses", None)[:, None], "numbers", None
    if given.ndim == 3 and name == "spd" and given.shape[1] == given.shape[2]:
        return _triangles(array(given, "poses", None), project), "tensors", "spd"
    if given.ndim == 3 and name not in (None, "rotation", "rigid", "spd"):
        return array(given, "poses", None).reshape(len(given), -1), given.shape[1:], None
    if given.ndim == 3 and given.shape[1:] not in ((3, 3), (4, 4)):
        raise ValueError(f"poses: a space is needed for arrays of shape {given.shape}, as space='spd' for tensors")
    if given.ndim != 3:
        return array(poses, "poses", 0), "points", None
    matrices, rows = array(given[:, :3, :3].reshape(-1, 9), "poses", 9), np.empty((len(given), 4))
    again = np.empty_like(matrices)
    for i in range(len(rows)):
        call(lib.bat_rotation_nearest, pointer(matrices[i]), pointer(rows[i]))
        lib.bat_rotation_to_matrix(pointer(rows[i]), pointer(again[i]))
    off = abs(again - matrices).max(initial=0.0)
    if off > _FAR and not project:
        raise InvalidPoint(f"poses: a matrix is {off:.2g} off an orthogonal one; project=True takes the nearest rotation, space='spd' takes tensors")
    _warn(off, project)
    if given.shape[1] == 3:
        return rows, "matrices", "rotation"
    if not np.array_equal(given[:, 3], np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(given), 4))):
        raise ValueError("poses: the last row of a rigid motion's matrix is (0, 0, 0, 1)")
    return np.hstack([given[:, :3, 3], rows]), "rigid matrices", "rigid"


@functools.cache
def _rotations() -> tuple[Any, dict[str, Any] | None]:
    """The class of rotations of scipy, whose constructor takes longer than six poses, and what it sets beside the quaternion;
    None where that is not known."""
    from scipy.spatial.transform import Rotation

    first, second = np.array([0.5, -0.5, 0.5, 0.5]), np.array([0.5, 0.5, 0.5, -0.5])
    found = dict(getattr(Rotation(first), "__dict__", {}))
    quaternion = found.pop("_quat", None)
    if found.keys() != {"_xp", "_single", "_backend"} or getattr(quaternion, "shape", None) != (1, 4):
        return Rotation, None
    made = object.__new__(Rotation)
    made.__dict__.update(found, _quat=second[None])
    return Rotation, found if np.array_equal(made.as_matrix(), Rotation(second).as_matrix()) else None


def _rotation(quaternion: Floats) -> Any:
    """The rotation of scipy of a unit quaternion (x, y, z, w)."""
    kind, attributes = _rotations()
    if attributes is None:
        return kind(quaternion)
    made = object.__new__(kind)
    made.__dict__.update(attributes, _quat=quaternion[None])
    return made


def _form(points: Floats, form: Any) -> Any:
    if form == "points":
        return points
    if form == "numbers":
        return points[..., 0][()]
    if isinstance(form, tuple):
        return points.reshape(*points.shape[:-1], *form)
    if form == "tensors":
        side = math.isqrt(2 * points.shape[-1])
        rows, columns = np.triu_indices(side)
        tensors = np.empty((*points.shape[:-1], side, side))
        tensors[..., rows, columns] = tensors[..., columns, rows] = points
        return tensors
    quaternions = points[..., -4:]
    from scipy.spatial.transform import Rotation

    if form == "Rotation":
        return Rotation(quaternions[..., [1, 2, 3, 0]] if points.ndim == 1 else quaternions.reshape(-1, 4)[:, [1, 2, 3, 0]])
    rotation = Rotation.from_quat(quaternions.reshape(-1, 4)[:, [1, 2, 3, 0]])
    matrices = rotation.as_matrix().reshape(*points.shape[:-1], 3, 3)
    if form == "matrices":
        return matrices
    made = np.zeros((*points.shape[:-1], 4, 4))
    made[..., :3, :3], made[..., :3, 3], made[..., 3, 3] = matrices, points[..., :3], 1
    if form == "RigidTransform":
        from scipy.spatial.transform import RigidTransform

        return RigidTransform.from_matrix(made)
    return made
