"""Surfaces: from scans to splines."""

import pickle

import numpy as np
import pytest

import batten
from conftest import draws


def test_a_saddle(patch):
    surface = batten.fit_surface(patch, tolerance=1e-3)
    assert surface.report.reached and surface.distances.max() < 1e-3 and surface.report.verdict.fault == "none"
    np.testing.assert_allclose(np.linalg.norm(surface(*surface.parameters.T) - patch, axis=1), surface.distances, atol=1e-12)
    u, v = 0.4, 0.7
    h = 1e-6
    slope = (surface(u + h, v) - surface(u - h, v)) / (2 * h)
    np.testing.assert_allclose(surface.derivatives(u, v)[0], slope, atol=1e-6)
    assert surface.derivatives(u, v, 2).shape == (3, 3)
    assert abs(surface.normals([0.5, 0.5], [0.1, 0.9])[:, 2]).min() > 0.5
    assert len(surface.mesh(5).faces) == 32
    with pytest.raises(batten.InvalidPoint):
        surface(1.5, 0)


def test_points_in_another_order(patch, random):
    order = random.permutation(len(patch))
    surface = batten.fit_surface(patch[order], tolerance=1e-3)
    np.testing.assert_allclose(surface(*surface.parameters.T), patch[order], atol=2e-3)
    assert np.array_equal(surface.distances, batten.fit_surface(patch, tolerance=1e-3).distances[order])


def test_parameters_corners_and_meshes_are_taken(patch):
    given = batten.fit_surface(patch, parameters=patch[:, :2], corrections=0, functions=16)
    np.testing.assert_allclose(given.parameters, patch[:, :2])
    chosen = batten.fit_surface(patch, corners=[0, 11, 143, 132])
    np.testing.assert_allclose(chosen.parameters[[0, 11, 143, 132]], [[0, 0], [1, 0], [1, 1], [0, 1]])
    mesh = given.mesh(9)
    assert batten.fit_surface(mesh, parameters="mean-value").report.chosen == "mean-value"


def test_files_pickles_and_pictures(patch, tmp_path):
    surface = batten.fit_surface(patch, functions=16)
    assert surface.to_step().startswith(b"ISO-10303-21") and surface.to_vtk().startswith(b"# vtk")
    surface.to_step(tmp_path / "out.step")
    assert (tmp_path / "out.step").stat().st_size > 500
    again = pickle.loads(pickle.dumps(surface))
    assert np.array_equal(again(0.3, 0.4), surface(0.3, 0.4)) and again.report.rms == surface.report.rms
    assert surface._repr_png_()[:4] == b"\x89PNG" and draws(surface)
    with pytest.raises(batten.FileAccess):
        surface.to_step("/nowhere/out.step")


def test_a_wrong_surface_is_refused_unless_forced(random):
    ball = random.normal(size=(600, 3))  # no patch at all
    with pytest.raises(batten.BattenError) as caught:
        batten.fit_surface(ball)
    assert "--" not in str(caught.value)
    try:
        surface = batten.fit_surface(ball, force=True)
    except batten.BattenError as error:
        assert "force" not in str(error)
    else:
        assert surface.report.verdict.fault != "none"


def test_points_are_held_out(random):
    x, y = random.uniform(size=(2, 1500))
    points = np.stack([x, y, np.sin(4 * x) * y + random.normal(0, 0.01, 1500)], axis=1)
    report = batten.fit_surface(points).report
    assert report.held_out_count >= 100 and 0.005 < report.held_out_rms < 0.02 and 0.005 < report.noise < 0.02
    assert np.isfinite(report.rounds[0].held_out) and report.functions < 400
