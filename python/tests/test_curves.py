"""Curves: what refinement and analysis compute, and what their results are."""

import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import batten
from conftest import draws


def test_given_points_stay(circle):
    fine = batten.refine(circle, closed=True, levels=4)
    assert fine.shape == (12 * 16, 2)
    assert np.array_equal(fine[::16], circle)


def test_chaikin_is_the_quadratic_spline():
    fine = batten.refine([[0.0], [4.0], [8.0]], scheme="chaikin", levels=1, closed=True)
    assert sorted(np.asarray(fine).ravel()) == [1, 2, 3, 5, 6, 7]


def test_spaces_by_name(random):
    for name, columns in [("sphere", 3), ("rotation", 4), ("disk", 2), ("spd", 6), ("hyperbolic", 3)]:
        space = batten.Space(name, columns)
        if name == "disk":
            points = random.uniform(-0.5, 0.5, (5, 2))
        elif name == "spd":
            points = np.array([1.0, 0, 0, 1, 0, 1]) * np.arange(1, 6)[:, None]
        elif name == "hyperbolic":
            flat = random.normal(size=(5, 2))
            points = np.column_stack([np.sqrt(1 + (flat**2).sum(axis=1)), flat])
        else:
            points = space.project(random.normal(size=(5, columns)))
        fine = batten.refine(points, space=name, levels=2, simple="never")
        assert fine.shape == (17, columns)
        assert space.distance(space.geodesic(points[:-1], points[1:], np.ones(4)), points[1:]).max() < 1e-7
        assert space.distance(fine[:-1], fine[1:]).max() < space.distance(points[:-1], points[1:]).max()


def test_the_equator_of_the_sphere_stays():
    angles = np.radians([0, 50, 130, 170, 260])
    fine = batten.refine(np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1), space="sphere", closed=True)
    assert np.abs(fine[:, 2]).max() < 1e-12


def test_degrees(random):
    degrees = np.stack([random.uniform(-180, 180, 9), random.uniform(-90, 90, 9)], axis=1)
    np.testing.assert_allclose(batten.to_lonlat(batten.from_lonlat(degrees)), degrees, atol=1e-12)


@pytest.mark.parametrize("degrees", [[50, 170], [10, 91], [10, -90.001], [0, np.nan], [np.inf, 0]])
def test_degrees_off_the_sphere_are_refused(degrees):
    with pytest.raises(batten.InvalidPoint, match="degrees: point 1, ") as caught:
        batten.from_lonlat([[0, 90], degrees, [0, 100]])
    assert (caught.value.index, caught.value.status) == (1, "invalid point")


@pytest.mark.parametrize("vector", [[0, 0, 0], [0, np.nan, 1], [np.inf, 0, 0]])
def test_vectors_without_a_direction_are_refused(vector):
    with pytest.raises(batten.InvalidPoint, match="points: point 1, ") as caught:
        batten.to_lonlat([[0, 0, 1], vector])
    assert caught.value.index == 1


def test_channels_and_corners(circle):
    fine = batten.refine(circle, scheme="four-point", channels=np.arange(12.0)[:, None], corners=np.arange(12) == 5, levels=2)
    np.testing.assert_allclose(fine.channels[::4, 0], np.arange(12))
    assert list(np.flatnonzero(fine.corners)) == [20]


def test_ragged_curves_are_refined_one_by_one(random):
    lengths = random.integers(3, 9, 2200)
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    points = random.normal(size=(offsets[-1], 2))
    many = batten.refine(points, offsets, levels=2, simple="never")
    assert len(many) == 2200
    for i in (0, 1, 2047, 2048, 2199):
        single = batten.refine(points[offsets[i] : offsets[i + 1]], levels=2)
        assert np.array_equal(many[i], single)
    listed = batten.refine([points[offsets[i] : offsets[i + 1]] for i in range(10)], levels=2)
    assert np.array_equal(listed.points, many.points[: many.offsets[10]])


def test_failures_of_ragged_curves_name_the_curve():
    points = np.tile([[0.0, 0], [1, 0], [1, 1]], (2200, 1))
    points[3 * 2100 + 1] = np.nan
    with pytest.raises(batten.InvalidPoint, match="curve 2100") as caught:
        batten.refine(points, np.arange(0, 6601, 3))
    assert (caught.value.curve, caught.value.index, caught.value.status) == (2100, 1, "invalid point")


def test_threads_change_nothing(circle):
    results = [batten.refine(circle, levels=9, threads=threads) for threads in (1, 2, 3)]
    assert all(np.array_equal(results[0], other) for other in results[1:])


def test_threads_from_the_environment():
    code = "import batten; batten.refine([[0, 0], [1, 1]])"
    run = subprocess.run([sys.executable, "-c", code], env=os.environ | {"BATTEN_THREADS": "9999"}, stderr=subprocess.PIPE)
    assert b"threads is 9999" in run.stderr


def test_no_copy_of_results(circle):
    fine = batten.refine(circle, levels=8)
    assert fine.flags.writeable and fine.flags.c_contiguous
    fine[0] = 7
    assert fine[0, 0] == 7


@pytest.mark.parametrize("convert", [
    np.asfortranarray, lambda a: a.astype(np.float32).astype(np.float64), lambda a: np.repeat(a, 2, axis=0)[::2],
    lambda a: a.astype(">f8"), lambda a: a.tolist(), lambda a: memoryview(a)])  # fmt: skip
def test_any_layout(circle, convert):
    circle = circle.astype(np.float32).astype(np.float64)
    readonly = circle.copy()
    readonly.flags.writeable = False
    expected = batten.refine(circle)
    assert np.array_equal(batten.refine(convert(circle)), expected)
    assert np.array_equal(batten.refine(readonly), expected)


def test_unaligned_points(circle):
    memory = np.zeros(circle.nbytes + 1, np.uint8)
    unaligned = memory[1:].view(np.float64).reshape(circle.shape)
    unaligned[:] = circle
    assert np.array_equal(batten.refine(unaligned), batten.refine(circle))


def test_pickles(circle):
    fine = batten.refine(circle, closed=True, space="plane")
    again = pickle.loads(pickle.dumps(fine))
    assert np.array_equal(again, fine) and again.closed and again.space.name == "plane"
    many = pickle.loads(pickle.dumps(batten.refine([circle, circle])))
    assert len(many) == 2 and np.array_equal(many[1], batten.refine(circle))


def test_pictures(circle):
    fine = batten.refine(circle, closed=True)
    assert fine._repr_svg_().startswith("<?xml") and draws(fine)
    assert batten.refine([circle, circle + 3])._repr_svg_().startswith("<?xml")
    analysis = batten.analyze("chaikin")
    assert analysis._repr_svg_().startswith("<?xml") and draws(analysis)


def test_warnings_for_curves_that_cross():
    bow = [[0, 0], [1, 1], [1, 0], [0, 1]]
    with pytest.warns(batten.BattenWarning, match="cross themselves"):
        batten.refine(bow, closed=True)


def test_analysis_of_masks():
    four_point = batten.analyze("four-point")
    assert (four_point.smooth_proven, four_point.is_interpolatory, four_point.reproduction_degree) == (1, True, 3)
    np.testing.assert_allclose(four_point.eigenvalues.real, [1, 0.5, 0.25, 0.125], atol=1e-12)
    for order in (1, 2, 3):  # B-splines of degree k are C^(k - 1)
        assert batten.analyze(f"lane-riesenfeld:order={order}").smooth_proven == order - 1
    assert batten.analyze([1 / 4, 3 / 4, 3 / 4, 1 / 4]).exponent_lower == pytest.approx(2)
    x, y = batten.analyze("chaikin").basis(3)
    assert y.sum() == pytest.approx(8) and len(x) == len(y)
    assert pickle.loads(pickle.dumps(four_point)).depth == four_point.depth
    with pytest.raises(ValueError, match="not a linear scheme"):
        batten.analyze("learned")


def test_measures(circle):
    square = batten.refine([[0, 0], [1, 0], [1, 1], [0, 1]], closed=True, scheme="mask:1/2,1,1/2", levels=3)
    found = batten.measure(square)
    assert found.length == pytest.approx(4) and found.g1 == pytest.approx(np.pi / 2) and found.simple
    assert batten.measure(circle, circle + [0, 0.5]).hausdorff == pytest.approx(0.5)
    assert batten.measure([[1.0, 0, 0]], [[0, 1.0, 0]], space="sphere", geodesic=True).hausdorff == pytest.approx(np.pi / 2)


def test_choices():
    families = ["curve_scheme", "mesh_scheme", "space", "motion_scheme", "curve_end_rule", "surface_format"]
    assert all(row.name for family in families for row in batten.choices(family))
    with pytest.raises(ValueError, match="no family 'x'"):
        batten.choices("x")


def test_what_leaves_the_space_is_a_plain_array():
    curve = batten.refine(batten.from_lonlat([[0, 0], [40, 10], [80, 0]]), space="sphere", levels=3)
    for plain in (curve[:, :2], curve[:, 0], curve[3], curve - curve.mean(axis=0), curve.T, curve == curve, curve.sum(axis=0), 2 * curve,
                  curve.reshape(-1), curve.astype(np.float32), np.concatenate([curve, curve]), np.cross(curve, curve), curve.ravel(),
                  curve[None], np.vstack([curve]), curve @ np.eye(3), np.where(curve > 0, curve, 0)):  # fmt: skip
        assert type(plain) is np.ndarray
    assert isinstance(curve.sum(), np.float64) and isinstance(curve.max(), np.float64)


def test_rows_of_a_curve_are_an_open_curve(circle):
    curve = batten.refine(circle, closed=True, levels=2, channels=circle[:, :1], corners=[1] + 11 * [0])
    for rows in (curve[3:9], curve[[1, 2, 3]], curve[curve[:, 0] > 0]):
        assert isinstance(rows, batten.Curve) and rows.space is curve.space and not rows.closed
        assert len(rows.channels) == len(rows.corners) == len(rows)
    whole = curve.copy()
    assert whole.closed and np.array_equal(whole.channels, curve.channels)
    assert np.shares_memory(curve[2:4], curve)


def test_no_picture_is_no_failure(circle):
    curve = batten.refine(circle, closed=True)
    broken = curve.copy()
    broken[3] = np.nan
    sphere = batten.refine(batten.from_lonlat([[0, 0], [40, 10]]), space="sphere").copy()
    sphere *= 2
    off = batten.refine(batten.from_lonlat([[0, 0], [40, 10]]), space="sphere")
    off[:] = 2
    for result in (broken, off, curve[:0], curve[:1], batten.refine([circle, circle])):
        assert result._repr_svg_() is None or result._repr_svg_().startswith("<?xml")
    assert broken._repr_svg_() is None and off._repr_svg_() is None and curve._repr_svg_() is not None
    mesh = batten.Mesh(np.full((3, 3), np.nan), [[0, 1, 2]])
    assert mesh._repr_png_() is None
