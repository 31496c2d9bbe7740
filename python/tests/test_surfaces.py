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
        surface = batten.fit_surface(ball, shell=False, force=True)
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


@pytest.fixture(scope="module")
def torus():
    """Points of a torus, at random."""
    random = np.random.default_rng(3)
    u, v = random.uniform(0, 2 * np.pi, (2, 4000))
    keep = random.uniform(0, 1.4, 4000) < 1 + 0.4 * np.cos(v)  # even on the surface
    u, v = u[keep], v[keep]
    return np.stack([(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)], axis=1)


def test_a_closed_cloud_becomes_a_shell(torus, tmp_path, sphere_mesh):
    shell = batten.fit_surface(torus)
    assert isinstance(shell, batten.Shell) and shell.closed and shell.report.pieces == 1
    face = np.arange(len(shell))[:, None, None]
    u, v = np.linspace(0, 1, 5)[:, None], np.linspace(0, 1, 5)
    points, normals = shell(face, u, v), shell.normals(face, u, v)
    assert points.shape == (len(shell), 5, 5, 3)
    off = np.hypot(np.hypot(points[..., 0], points[..., 1]) - 1, points[..., 2]) - 0.4
    assert abs(off).max() < 0.02 and shell.report.volume == pytest.approx(2 * np.pi**2 * 0.16, rel=0.02)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1)
    centre = points * [1, 1, 0] / np.hypot(points[..., 0], points[..., 1])[..., None]
    assert (np.einsum("...d,...d", normals, points - centre) > 0.3).mean() > 0.99  # outwards
    # The corners of the patches are those of the faces.
    np.testing.assert_allclose(shell(np.arange(len(shell)), 0, 0), shell.patches[:, 0, 0, 0, 0], atol=1e-12)
    shell.to_step(tmp_path / "torus.step")
    assert (tmp_path / "torus.step").read_bytes().startswith(b"ISO-10303-21") and b"MANIFOLD_SOLID_BREP" in shell.to_step()
    assert isinstance(shell.control_mesh, batten.PolygonMesh) and batten.measure(shell.mesh(2).triangulate()).genus == 1
    again = pickle.loads(pickle.dumps(shell))
    assert np.array_equal(again(3, 0.2, 0.7), shell(3, 0.2, 0.7)) and again.to_step() == shell.to_step()
    assert shell._repr_png_()[:4] == b"\x89PNG" and draws(shell)
    pictures = {shell.picture(torus, view=view, width=120) for view in ("shaded", "zebra", "curvature")} | {shell.picture(torus, bands=[0.01], width=120)}
    assert len(pictures) == 4 and shell.picture(suffix="svg").startswith(b"<?xml")
    with pytest.raises(batten.BattenError, match="bands"):
        shell.picture(torus, bands=[0.2, 0.1])
    with pytest.raises(batten.BattenError, match="view"):
        shell.picture(view="none")
    ball = batten.fit_surface(sphere_mesh, shell=True, faces=24)
    assert ball.closed and batten.measure(ball.mesh(2).triangulate()).genus == 0


def test_what_is_no_disc_is_trimmed_or_becomes_a_shell():
    """A plate with a hole is trimmed, a pipe is an open shell."""
    x, y = np.random.default_rng(5).random((2, 3000))
    outside = np.hypot(x - 0.5, y - 0.5) > 0.25
    plate = np.stack([x, y, 0.2 * np.sin(3 * x)], axis=1)[outside]
    surface = batten.fit_surface(plate)
    assert isinstance(surface, batten.Surface) and surface.report.verdict.area < 0.9
    with pytest.raises(batten.BattenError, match="several boundary loops"):
        batten.fit_surface(plate, shell=False)
    angles, heights = np.random.default_rng(6).random((2, 10000))
    pipe = np.stack([np.cos(2 * np.pi * angles), np.sin(2 * np.pi * angles), 4 * heights], axis=1)
    shell = batten.fit_surface(pipe)
    assert isinstance(shell, batten.Shell) and not shell.closed and shell.report.holes == 2


def test_a_closed_gap_is_trimmed():
    points = np.random.default_rng(3).uniform(size=(2000, 2))
    points = points[(abs(points[:, 0] - 0.5) > 0.04) | (points[:, 1] < 0.4)]
    points = np.c_[points, 0.1 * points[:, 0] ** 2]
    patch, trimmed = batten.fit_surface(points, shell=False), batten.fit_surface(points)
    assert patch.report["verdict"]["doubt"] == "gap" and trimmed.report["verdict"]["doubt"] != "gap"
    areas = [surface.report["verdict"]["area"] / 0.952 for surface in (patch, trimmed)]
    assert areas[0] > 1.03 and abs(areas[1] - 1) < 0.015


def test_shells_refuse(torus):
    with pytest.raises(batten.InvalidArgument, match="face"):
        batten.fit_surface(torus, shell=True, faces=60)(10**6, 0, 0)
    with pytest.raises(TypeError, match="unknown option 'tolerence'; did you mean tolerance"):
        batten.fit_surface(torus, shell=True, tolerence=1)
    with pytest.raises(TypeError, match="no boundary, corners and parameters"):
        batten.fit_surface(torus, shell=True, corners=[0, 1, 2, 3])
    with pytest.raises(batten.BattenError) as caught:
        batten.fit_surface(torus, shell=False)
    assert caught.value.remedy == "shell"


def test_edges_of_a_trimmed_surface_are_chosen(random):
    plate = random.uniform(size=(1500, 3)) * [3, 2, 0]
    plate = plate[np.hypot(plate[:, 0] - 1.5, plate[:, 1] - 1) > 0.5]
    areas = {edges: batten.fit_surface(plate, trim=True, edges=edges).report.verdict.area for edges in ("auto", "exact", "fair")}
    assert areas["exact"] < 0.98 * areas["auto"] and areas["fair"] == pytest.approx(6 - np.pi / 4, rel=0.01)
    assert areas["auto"] == batten.fit_surface(plate, trim=True).report.verdict.area
    assert [row.name for row in batten.choices("surface_edges")] == list(areas)
    for words, settings in ("edges goes with trim", {"edges": "fair"}), ("'rough'", {"trim": True, "edges": "rough"}):
        with pytest.raises(batten.InvalidArgument, match=words):
            batten.fit_surface(plate, **settings)
    for settings in {"shell": True, "edges": "exact"}, {"trim": True, "edges": 1}:
        with pytest.raises(TypeError, match="edges"):
            batten.fit_surface(plate, **settings)


def test_simple_shapes_are_told(random):
    """Points on a cylinder tell its radius and its axis; those beside it tell none."""
    angle, height = random.uniform(0, 2, 1500), random.uniform(0, 20, 1500)
    for bulge in (0, 1):
        radius = 12 + bulge * np.sin(height / 5) + random.normal(0, 0.02, 1500)
        points = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)
        primitive = batten.fit_surface(points, trim=True).report.primitive
        assert primitive.kind == ("none" if bulge else "cylinder")
        assert bulge or (abs(primitive.radius - 12) < 0.02 and abs(primitive.axis[2]) > 0.9999)


def test_step_has_simple_shapes(random, tmp_path):
    """A plate with a round hole is a plane with a circle in STEP, as the program writes it; the spline is there on demand, and
    where the shape misses the tolerance."""
    points = random.uniform(0, 10, (3000, 2))
    points = np.pad(points[np.hypot(*(points - 5).T) > 2], ((0, 0), (0, 1)))
    surface = batten.fit_surface(points, trim=True)
    shaped, spline = surface.to_step(), surface.to_step(keep_spline=True)
    assert b"=PLANE(" in shaped and shaped.count(b"=CIRCLE(") == 1 and b"=B_SPLINE_SURFACE" not in shaped
    assert b"=PLANE(" not in spline and b"=B_SPLINE_SURFACE" in spline
    assert surface.write(tmp_path / "out.step") == b"" and (tmp_path / "out.step").read_bytes().count(b"=PLANE(") == 1
    assert pickle.loads(pickle.dumps(surface)).to_step() == shaped
    assert surface.write(format="json") == surface.write(format="json", keep_spline=True)
    points = np.column_stack([random.uniform(0, 10, (600, 2)), random.normal(0, 0.01, 600)])
    for tolerance, planes in ((0.02, 0), (0.1, 1)):
        assert batten.fit_surface(points, trim=True, tolerance=tolerance).to_step().count(b"=PLANE(") == planes
