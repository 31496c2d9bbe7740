"""Motions: splines in time."""

import pickle
import re

import numpy as np
import pytest

import batten
from conftest import draws

pytest.importorskip("scipy")
from scipy.interpolate import CubicSpline  # noqa: E402
from scipy.spatial.transform import Rotation, RotationSpline  # noqa: E402


def test_cubic_spline_of_scipy(random):
    times, values = np.cumsum(random.uniform(0.5, 2, 9)), random.normal(size=(9, 2))
    ours, theirs = batten.Motion(times, values, ends="not-a-knot", shape="smooth"), CubicSpline(times, values)
    at = np.linspace(times[0], times[-1], 50)
    np.testing.assert_allclose(ours(at), theirs(at), atol=1e-12)
    np.testing.assert_allclose(ours.velocity(at), theirs(at, 1), atol=1e-11)
    np.testing.assert_allclose(ours.acceleration(at), theirs(at, 2), atol=1e-10)


def test_rotation_spline_of_scipy_beside_ours():
    """Both follow a smooth motion; ours comes nearer."""
    def truth(t):
        return Rotation.from_rotvec(np.stack([np.sin(t), np.cos(2 * t) - 1, 0.5 * t], axis=-1))

    keys, at = np.linspace(0, 3, 10), np.linspace(0, 3, 200)
    ours, theirs = batten.Motion(keys, truth(keys)), RotationSpline(keys, truth(keys))
    errors = [(spline(at).inv() * truth(at)).magnitude().max() for spline in (ours, theirs)]
    assert errors[0] < errors[1] < 0.05
    np.testing.assert_allclose(ours(keys).as_matrix(), truth(keys).as_matrix(), atol=1e-14)
    assert ours(0.5).as_quat().shape == (4,) and ours.velocity(0.5).shape == (3,)
    for t in (0.5, np.float64(0.5), at[77]):  # one time goes its own way
        assert isinstance(ours(t), Rotation) and ours(t).single
        np.testing.assert_array_equal(ours(t).as_quat(), ours([t])[0].as_quat())
        np.testing.assert_array_equal((ours(t) * truth(t)).as_matrix(), (ours([t])[0] * truth(t)).as_matrix())


def test_forms_of_poses(random):
    rotations = Rotation.from_rotvec(np.cumsum(random.normal(size=(5, 3)) / 3, axis=0))
    places, times = random.normal(size=(5, 3)), np.arange(5.0)
    rigid = np.zeros((5, 4, 4))
    rigid[:, :3, :3], rigid[:, :3, 3], rigid[:, 3, 3] = rotations.as_matrix(), places, 1
    quaternions = rotations.as_quat()[:, [3, 0, 1, 2]]
    matrices, at = batten.Motion(times, rotations.as_matrix()), np.linspace(0, 4, 7)
    np.testing.assert_allclose(matrices(at), batten.Motion(times, rotations)(at).as_matrix(), atol=1e-13)
    both = batten.Motion(times, rigid)
    assert both(at).shape == (7, 4, 4) and both(1.5).shape == (4, 4) and both.velocity(at).shape == (7, 6)
    rows = batten.Motion(times, np.hstack([places, quaternions]), space="rigid")
    np.testing.assert_allclose(rows(at)[:, :3], both(at)[:, :3, 3], atol=1e-12)
    rigid[:, 3, 3] = 2
    with pytest.raises(ValueError, match="last row"):
        batten.Motion(times, rigid)
    with pytest.raises(batten.InvalidPoint, match="orthogonal"):
        batten.Motion(times, rotations.as_matrix() * 1.1)


def test_a_named_space_decides_the_form(random):
    """Square matrices are tensors where the space says so, and numbers are a motion on the line."""
    for side in (2, 3, 4):
        roots = random.normal(size=(5, side, side))
        tensors, at = roots @ roots.swapaxes(1, 2) + np.eye(side), np.linspace(0, 4, 9)
        rows, columns = np.triu_indices(side)
        motion = batten.Motion(range(5), tensors, space="spd")
        plain = batten.Motion(range(5), tensors[:, rows, columns], space="spd")
        assert motion.space.point_dim == side * (side + 1) // 2 and motion(0.5).shape == (side, side)
        np.testing.assert_array_equal(motion(at)[:, rows, columns], plain(at))
        np.testing.assert_array_equal(motion(at), motion(at).swapaxes(1, 2))
        np.testing.assert_allclose(motion.keys, tensors, rtol=1e-12)
        assert (np.linalg.eigvalsh(motion(at)) > 0).all()
    flat = batten.Motion(range(5), tensors[:, :3, :3], space="euclidean")
    assert flat.space.point_dim == 9 and flat([0.0, 1]) == pytest.approx(tensors[:2, :3, :3])
    tensors[1, 0, 1] += 0.1
    with pytest.raises(batten.InvalidPoint, match="matrix 1 is not symmetric"):
        batten.Motion(range(5), tensors, space="spd")
    with pytest.raises(batten.InvalidPoint, match="spd"):
        batten.Motion(range(5), tensors[:, :3, :3])
    with pytest.raises(ValueError, match="spd"):
        batten.Motion(range(5), tensors[:, :2, :2])


def test_numbers_are_a_motion_on_the_line():
    times, values = [0, 1, 2, 4], np.array([0.0, 1, 4, 2])
    motion, rows = batten.Motion(times, values), batten.Motion(times, values[:, None])
    at = np.linspace(0, 4, 12).reshape(3, 4)
    for ours, theirs in ((motion, rows), (motion.velocity, rows.velocity), (motion.acceleration, rows.acceleration)):
        assert ours(at).shape == (3, 4) and np.array_equal(ours(at), theirs(at)[..., 0])
        assert np.ndim(ours(0.5)) == 0 and ours(0.5) == theirs(0.5)[0]
    assert np.array_equal(motion.keys, values) and motion([1]).shape == (1,)
    assert batten.Motion([0, 1], [0.0, 1], velocities=[2, 0]).velocity([0, 1]) == pytest.approx([2, 0])
    assert batten.Motion([0, 1], [350.0, 370], wrap=360)(0.5) == pytest.approx(0)
    smoothed = batten.Motion(np.arange(30), np.arange(30) + np.tile([0.1, -0.1, 0.0], 10), sigma=0.1)
    assert smoothed.uncertainties.shape == (30,) and smoothed.uncertainty(at).shape == (3, 4)
    with pytest.raises(ValueError, match="4 coordinates"):
        batten.Motion([0, 1, 2, 3], [1.0, 0, 0, 0], space="rotation")


def test_times_of_pandas():
    pandas = pytest.importorskip("pandas")
    times = pandas.date_range("2026-01-01", periods=4, freq="2s")
    motion = batten.Motion(times, [[0.0], [2.0], [4.0], [6.0]])
    assert motion(times[0] + pandas.Timedelta("3s")) == pytest.approx(3)
    assert motion(times).ravel() == pytest.approx([0, 2, 4, 6]) and motion(5.0) == pytest.approx(5)
    assert motion(np.array(["2026-01-01T00:00:01"], "M8[s]")).ravel() == pytest.approx([1])


def test_dates_need_a_motion_with_dates():
    dates = np.array(["2026-01-01", "2026-01-02", "2026-01-03"], "M8[s]")
    for times in ([0, 1, 2], dates - dates[0]):
        motion = batten.Motion(times, [[0.0], [1.0], [3.0]])
        for call in (motion, motion.velocity, motion.acceleration, motion.uncertainty):
            for date in (dates[1], dates, dates[1].item()):
                with pytest.raises(TypeError, match="times: numbers or durations are needed"):
                    call(date)
        assert motion(np.timedelta64(1, "s")).shape == (1,)
    turns = Rotation.from_rotvec([[0, 0, 0], [0, 0, 1], [0, 0, 2]])
    with pytest.raises(TypeError, match="times: numbers or durations"):
        batten.Motion([0, 1, 2], turns, gyro=(dates, np.zeros((3, 3))))
    assert pickle.loads(pickle.dumps(batten.Motion(dates, turns)))(dates[1]).magnitude() == pytest.approx(1)


def test_closed_motions_and_extrapolation():
    circle = batten.Motion([0, 1, 2, 3], [[1.0, 0], [0, 1], [-1, 0], [0, -1]], closed=True, period=4)
    np.testing.assert_allclose(circle(0.5), circle(4.5), atol=1e-15)
    assert circle.range == (0, 4)
    line = batten.Motion([0, 1], [[0.0], [1.0]], extrapolate=True)
    assert line(3.0) == pytest.approx(3)
    with pytest.raises(ValueError, match="range|within|from"):
        batten.Motion([0, 1], [[0.0], [1.0]])(3.0)


def test_a_closing_key_ends_the_period():
    """A last pose that repeats the first is left out, and its time is the end of the period."""
    times, square = [0, 1, 2, 3], [[1.0, 0], [0, 1], [-1, 0], [0, -1]]
    plain, at = batten.Motion(times, square, closed=True, period=4), np.linspace(0, 8, 33)
    closing = batten.Motion([*times, 4], [*square, square[0]], closed=True)
    np.testing.assert_array_equal(closing(at), plain(at))
    assert closing.range == (0, 4) and len(closing.times) == 4 and b"<svg" in closing.picture()
    later = batten.Motion([*times, 4], [*square, square[0]], closed=True, period=5)
    np.testing.assert_array_equal(later(at), batten.Motion(times, square, closed=True, period=5)(at))
    given = np.ones((5, 2))
    assert batten.Motion([*times, 4], [*square, square[0]], closed=True, velocities=given).velocity(0) == pytest.approx([1, 1])
    turns = Rotation.from_rotvec(np.array([0, 1, 2, 1, 0])[:, None] * [0, 0, 1])
    assert batten.Motion([0, 1, 2, 3, 4], turns, closed=True).range == (0, 4)
    own = batten.Space("positive", 1, exp=lambda p, v: p * np.exp(v), log=lambda p, q: np.log(q / p))
    assert batten.Motion([0, 1, 2, 4], [[1.0], [4.0], [2.0], [1.0]], space=own, closed=True).range == (0, 4)
    for keys in (square, [*square, [1.0, 0.1]]):
        with pytest.raises(ValueError, match="period"):
            batten.Motion(range(len(keys)), keys, closed=True)


def test_pickles_and_pictures():
    motion = batten.Motion([0, 1, 2], Rotation.from_rotvec([[0, 0, 0], [0, 0, 1], [0, 1, 1]]))
    again = pickle.loads(pickle.dumps(motion))
    assert np.array_equal(again([0.3]).as_quat(), motion([0.3]).as_quat())
    assert motion._repr_svg_().startswith("<?xml") and draws(motion)


def test_pictures(random):
    """Paths, strips of poses and coordinates above their speeds; also closed motions and smoothed ones with outliers."""
    times, turns = np.arange(6.0), Rotation.from_rotvec(np.cumsum(random.normal(size=(6, 3)) / 3, axis=0))
    rigid = np.hstack([random.normal(size=(6, 3)), turns.as_quat()[:, [3, 0, 1, 2]]])
    red = "rgb(80%,20%,16%)"  # of the body's x axis
    assert "<svg" in batten.Motion(times, turns)._repr_svg_()
    assert red in re.sub(r"\.\d+(?=%)| ", "", batten.Motion(times, rigid, space="rigid")._repr_svg_())
    noisy = np.stack([np.arange(30.0), np.zeros(30)], axis=1)
    noisy[10, 1] = 5
    smoothed = batten.Motion(np.arange(30.0), noisy, sigma=0.1, outliers="tukey")
    assert len(smoothed.picture()) > len(smoothed.picture(legend=False))
    closed = batten.Motion([0, 1, 2], [[0, 0], [1, 0], [0, 1]], closed=True, period=5)
    assert closed.picture(suffix="png", title="closed")[1:4] == b"PNG"
    own = batten.Space("positive", 1, exp=lambda p, v: p * np.exp(v), log=lambda p, q: np.log(q / p))
    assert "<svg" in batten.Motion([0, 1, 2], [[1.0], [4.0], [2.0]], space=own)._repr_svg_()


def test_files_are_read(tmp_path):
    """A trajectory is read with its stamps, and one with velocities keeps these."""
    path = tmp_path / "a.txt"
    path.write_text("1311868171.131477 0 0 0 0 0 0 1\n1311868172.331406 1 0 0 0 0 0 1\n1311868173 1 1 0 0 0 0.6 0.8\n")
    with pytest.warns(batten.BattenWarning, match="a.txt: a TUM trajectory"):
        motion = batten.Motion.read(path)
    assert motion.space.name == "rigid" and abs(motion.times[0] - 1311868171.131477) < 1e-6
    assert np.allclose(motion(motion.times[1])[:3], [1, 0, 0])
    table = tmp_path / "b.csv"
    table.write_text("time_ns,x,y,vx,vy\n0,0,0,1,0\n1000000000,1,0,-2,0\n")
    with pytest.warns(batten.BattenWarning, match="nanoseconds"):
        motion = batten.Motion.read(table)
    assert np.allclose(motion.velocity([0, 1])[:, 0], [1, -2]) and motion.range == (0, 1)
    with pytest.raises(OSError):
        batten.Motion.read(tmp_path / "none.csv")


def test_files_are_read_as_the_program_reads_them(tmp_path):
    """Options of the reader, closed motions, and every note as a warning."""
    def written(name, text):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    long = written("long.tum", "1 0 0 0 0 0 0 2\n2 1 0 0 0 0 0 2\n3 2 0 1 0 0 0 2\n")
    with pytest.raises(batten.BattenError, match="project"):
        batten.Motion.read(long)
    assert batten.Motion.read(long, project=True)(2.0) == pytest.approx([1, 0, 0, 1, 0, 0, 0])
    twice = written("twice.tum", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 2 0 1 0 0 0 1\n")
    with pytest.warns(batten.BattenWarning, match="twice.tum: left out 1 row that has the time of the row before"):
        assert len(batten.Motion.read(twice).times) == 3
    more = written("more.csv", "time,x,y,temperature\n0,0,0,20\n1,1,0,21\n2,1,1,22\n")
    with pytest.warns(batten.BattenWarning, match="temperature"):
        batten.Motion.read(more)
    bare = written("bare.csv", "time,x,y\n0,0,0\n1,1,0\n2,1,1\n")
    assert batten.Motion.read(bare, columns="y,x")(1.0) == pytest.approx([0, 1])
    closed = written("closed.csv", "time,x,y\n0,1,0\n1,0,1\n2,-1,0\n3,0,-1\n4,1,0\n")
    assert batten.Motion.read(closed, closed=True).range == (0, 4) and len(batten.Motion.read(closed).times) == 5
    assert batten.Motion.read(closed, closed=True, period=5).range == (0, 5)
    told = written("told.csv", "# closed\ntime,x,y\n0,1,0\n1,0,1\n2,-1,0\n3,0,-1\n")
    assert batten.Motion.read(told).range == (0, 4) and batten.Motion.read(told, closed=False).range == (0, 3)
    ticks = written("ticks.csv", "time,x,y\n0,0,0\n1000,1,0\n2000,4,1\n")
    with pytest.warns(batten.BattenWarning, match="milliseconds"):
        assert batten.Motion.read(ticks, time_unit="milliseconds").range == (0, 2)
    angles = written("angles.csv", "time,roll,pitch,yaw\n0,0,0,0\n1,0,0,90\n2,0,0,170\n")
    with pytest.raises(batten.BattenError):
        batten.Motion.read(angles)
    with pytest.warns(batten.BattenWarning, match="degrees"):
        assert batten.Motion.read(angles, euler="zyx,degrees")(1.0) == pytest.approx([0.5**0.5, 0, 0, 0.5**0.5])
    kitti, times = written("k.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"), written("times.txt", "0\n0.5\n")
    with pytest.warns(batten.BattenWarning, match="camera"):
        assert batten.Motion.read(kitti, format="kitti", key_times=times).range == (0, 0.5)
    heading = written("heading.csv", "time,yaw\n0,350\n1,10\n2,20\n")
    with pytest.warns(batten.BattenWarning, match="yaw"):
        assert batten.Motion.read(heading, wrap=360)([0, 0.9, 1])[:, 0] == pytest.approx([350, 8, 10], abs=2)
    with pytest.raises(batten.BattenError, match="unit"):
        batten.Motion.read(ticks, time_unit="weeks")


def test_angles_go_the_shorter_way():
    """Headings wrap, as with the program's option: in the range of the keys, with velocities that do not jump."""
    motion = batten.Motion([0, 1, 2], [[350.0], [370.0], [30.0]], wrap=360)
    assert motion([0.0, 0.5, 1, 1.5])[:, 0] == pytest.approx([350, 0, 10, 20]) and motion.keys[:, 0] == pytest.approx([350, 10, 30])
    assert motion.velocity(0.5) == pytest.approx(20) and motion(1.25) == pytest.approx(15)
    around = batten.Motion([0, 1], [[170.0], [-170.0]], wrap=360)
    assert around([0.25, 0.75])[:, 0] == pytest.approx([175, -175])
    assert pickle.loads(pickle.dumps(around))(0.25) == pytest.approx(175)
    for settings in (dict(space="rotation", wrap=360), dict(wrap=-1)):
        with pytest.raises(ValueError, match="wrap"):
            batten.Motion([0, 1], [[1.0, 0, 0, 0], [0.8, 0.6, 0, 0]], **settings)
    round_trip = batten.Motion([0, 1, 2, 3, 4], [[0.0], [100], [180], [270], [0]], wrap=360, closed=True)
    np.testing.assert_allclose(round_trip([0, 1, 4, 5.0])[:, 0], [0, 100, 0, 100], atol=1e-9)
    np.testing.assert_allclose(round_trip.velocity(np.linspace(0, 4, 401))[:-1].mean(), 90, rtol=1e-3)
    np.testing.assert_allclose(round_trip.keys[:, 0], [0, 100, 180, 270], atol=1e-9)


@pytest.mark.parametrize("kind", ["rows", "single", "inner", "unprojected"])
def test_spaces_whose_tangent_vectors_have_a_number_too_many(kind, random):
    """A sphere of a user is that of the library, and is made by calls of many rows, few for each key."""
    calls = []

    def counted(function):
        def counting(*given):
            calls.append(given[0].shape)
            return function(*given) if kind != "single" or given[0].ndim == 1 else 1 / 0

        return counting

    def exp(p, v):
        size = np.linalg.norm(v, axis=-1, keepdims=True)
        return np.cos(size) * p + np.sinc(size / np.pi) * v

    def log(p, q):
        cosine = (p * q).sum(-1, keepdims=True)
        across = q - cosine * p
        sine = np.linalg.norm(across, axis=-1, keepdims=True)
        return across / np.maximum(sine, 1e-300) * np.arctan2(sine, cosine)

    unit = lambda x: x / np.linalg.norm(x, axis=-1, keepdims=True)  # noqa: E731
    more = {"unprojected": {}, "inner": dict(project=unit, inner=lambda p, u, v: 4 * np.dot(u, v))}.get(kind, dict(project=counted(unit)))
    own = batten.Space("mine", 3, exp=counted(exp), log=counted(log), **more)
    ring = unit(np.stack([np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6), 0.3 * np.cos(np.arange(12) * np.pi / 2)], axis=1))
    given, at = np.cross(ring, random.normal(size=(12, 3))), np.linspace(0, 11, 45)
    given[3] = np.nan
    clamped = dict(ends="clamped", end_velocity=np.cross(ring[-1], [1, 2, 3]))
    for settings in ({}, dict(velocities=given), dict(closed=True, period=12), *([clamped] if kind == "rows" else [])):
        calls.clear()
        ours, theirs = (batten.Motion(range(12), ring, space=space, **settings) for space in (own, "sphere"))
        assert len(calls) < 40 * 12 or kind in ("single", "unprojected") or "ends" in settings
        np.testing.assert_allclose(ours(at), theirs(at), atol=1e-11)
        np.testing.assert_allclose(ours.velocity(at), theirs.velocity(at), atol=1e-6)
        np.testing.assert_allclose(ours.acceleration(at[1:-1]), theirs.acceleration(at[1:-1]), atol=1e-6)
        assert ours.velocity(0.5).shape == (3,) and ours.velocity(at.reshape(5, 9)).shape == (5, 9, 3)
    assert kind != "rows" or b"<svg" in ours.picture()


def test_failures_in_spaces_of_a_user_come_out():
    """Also where the library's calls are prepared."""
    class Mine(Exception):
        pass

    def log(p, q):
        raise Mine

    own = batten.Space("mine", 2, exp=lambda p, v: p + v, log=log, project=lambda x: x)
    with pytest.raises(Mine):
        batten.Motion([0, 1, 2], [[0.0, 0], [1, 0], [1, 1]], space=own)


def test_the_noise_is_found(random):
    """A noise that is not told is found, and the stated deviations cover the truth."""
    times = np.linspace(0, 20, 600)
    truth = np.stack([np.sin(times), np.cos(0.7 * times)], axis=1)
    motion = batten.Motion(times, truth + 0.05 * random.normal(size=truth.shape), sigma="auto", outliers="huber")
    assert abs(motion.noise[0] / (0.05 * 2**0.5) - 1) < 0.1
    off = abs(motion.keys - truth)
    assert 0.9 < (off < 1.96 * motion.uncertainties).mean() < 0.99
    assert (motion.deviations < 5).all()
    between = np.linspace(0.01, 19.99, 2001)
    off = abs(motion(between) - np.stack([np.sin(between), np.cos(0.7 * between)], axis=1))
    assert 0.9 < (off < 1.96 * motion.uncertainty(between)).mean() < 0.99


def test_only_smoothed_motions_have_uncertainties():
    """A motion through its poses has none, which is no uncertainty of 0; so has one whose noise was not found."""
    times, values = np.arange(8.0), np.arange(8.0)[:, None] ** 2
    for settings, way in (({}, "sigma= tells"), (dict(sigma=0), "sigma= tells"), (dict(sigma="auto"), "sigma= takes a number")):
        motion = batten.Motion(times, values, **settings)
        for call in (lambda: motion.uncertainty(0.5), lambda: motion.uncertainties):
            with pytest.raises(batten.Unsupported, match=way) as failed:
                call()
            assert failed.value.remedy == "sigma"
        assert not motion.deviations.any()
    assert batten.Motion(times, values, sigma=0.5).uncertainty([0.5]) > 0


def test_rounded_points_move_onto_their_space():
    """Quaternions of four decimals, single precision and matrices are taken; worse ones with a warning, or refused."""
    turns = Rotation.from_rotvec([[0.1, 0.2, 0.3], [0.4, 0.2, 0.1], [0.9, 0.3, 0.1]])
    quaternions = turns.as_quat()[:, [3, 0, 1, 2]]
    exact = batten.Motion([0, 1, 2], quaternions, space="rotation")([0.5])
    for near in (quaternions.round(4), quaternions.astype(np.float32), turns.as_matrix().astype(np.float32)):
        made = batten.Motion([0, 1, 2], near, space="rotation")._at(np.array([0.5]), 0)
        assert np.allclose(made, exact, atol=2e-4)
    with pytest.warns(batten.BattenWarning, match="moved onto"):
        batten.Motion([0, 1, 2], 1.01 * quaternions, space="rotation")
    with pytest.raises(batten.InvalidPoint):
        batten.Motion([0, 1, 2], 2 * quaternions, space="rotation")
    assert np.allclose(batten.Motion([0, 1, 2], 2 * quaternions, space="rotation", project=True)([0.5]), exact)


def test_unknown_velocities_are_found():
    """Rows of NaN are velocities that the motion finds, for each part of a pose by itself."""
    poses = np.array([[0, 0, 0, 1, 0, 0, 0], [1, 0, 0, 1, 0, 0, 0], [3, 0, 0, 1, 0, 0, 0]], float)
    given = np.full((3, 6), np.nan)
    plain = batten.Motion([0, 1, 2], poses, space="rigid")
    assert np.array_equal(plain([0.5]), batten.Motion([0, 1, 2], poses, space="rigid", velocities=given)([0.5]))
    given[1, :3] = [7, 0, 0]
    assert np.allclose(batten.Motion([0, 1, 2], poses, space="rigid", velocities=given).velocity(1), [7, 0, 0, 0, 0, 0])
    given[1, 0] = np.nan
    with pytest.raises(batten.InvalidPoint):
        batten.Motion([0, 1, 2], poses, space="rigid", velocities=given)


def test_limits_give_new_times():
    """A line of length 5 within a speed of 3 and an acceleration of 2."""
    motion = batten.Motion([0, 9], [[0.0, 0.0], [3.0, 4.0]], max_speed=3, max_acceleration=2)
    assert motion.range[1] == pytest.approx(5 / 3 + 3 / 2, rel=1e-5)
    assert np.linalg.norm(motion.velocity(motion.range[1] / 2)) == pytest.approx(3, rel=1e-5)
    assert np.array_equal(motion.times, motion.range)


def test_a_gyroscope_turns_between_poses():
    """Rates with a bias beside noisy rotations about one axis, whose angle shakes between them."""
    random, fine, coarse = np.random.default_rng(1), np.arange(0, 30, 0.01), np.arange(0, 29.5, 0.5)
    angle = lambda t: np.sin(0.5 * t) + 0.2 * np.sin(11 * t)  # noqa: E731
    rates = np.zeros((len(fine), 3))
    rates[:, 2] = 0.5 * np.cos(0.5 * fine) + 2.2 * np.cos(11 * fine)
    rates += [0.1, -0.2, 0.3] + random.normal(0, 0.01, rates.shape)
    vectors = np.zeros((len(coarse), 3))
    vectors[:, 2] = angle(coarse)
    poses = Rotation.from_rotvec(vectors) * Rotation.from_rotvec(random.normal(0, 0.02, vectors.shape))
    motion = batten.Motion(coarse, poses, gyro=(fine, rates))
    assert (abs(motion.bias[0] - [0.1, -0.2, 0.3]) < 4.5 * motion.bias[1]).all()
    at = np.linspace(1, 28, 500)
    truth = np.zeros((500, 3))
    truth[:, 2] = angle(at)
    assert (motion(at).inv() * Rotation.from_rotvec(truth)).magnitude().max() < 0.02
    assert motion.uncertainty(at).max() < 0.02 and b"<svg" in motion.picture()
    with pytest.raises(ValueError, match="gyro"):
        batten.Motion(coarse, poses, gyro=(fine[1:], rates))


def test_an_accelerometer_moves_between_poses():
    """A body that does not turn, on a shaken circle: forces with a bias and gravity, every second one pose."""
    fine, coarse = np.arange(0, 20, 0.01), np.arange(0, 19.5, 1.0)
    place = lambda t: np.stack([np.cos(t) + 0.1 * np.sin(5 * t), np.sin(t), 0.1 * np.cos(4 * t)], axis=-1)  # noqa: E731
    forces = (place(fine + 1e-3) - 2 * place(fine) + place(fine - 1e-3)) / 1e-6 + [0.1, 0.2, 9.8]
    poses = np.column_stack([place(coarse), np.tile([1.0, 0, 0, 0], (len(coarse), 1))])
    at = np.linspace(1, 18, 300)
    motion = batten.Motion(coarse, poses, space="rigid", gyro=(fine, np.zeros((len(fine), 3)), forces))
    alone = batten.Motion(coarse, poses, space="rigid")
    error = lambda made: abs(made(at)[:, :3] - place(at)).max()  # noqa: E731
    assert motion.accelerometer["used"] and motion.accelerometer["explained"] > 0.99
    assert error(motion) < 0.01 * error(alone)
