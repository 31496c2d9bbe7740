"""Meshes: refinement, decimation and its map, measures."""

import pickle
import signal
import sys
import threading
import time

import numpy as np
import pytest

import batten
from conftest import draws


def test_loop_is_that_of_trimesh():
    trimesh = pytest.importorskip("trimesh")
    cube = trimesh.creation.box()
    fine = batten.refine_mesh(cube, scheme="loop", levels=2)
    theirs, _ = trimesh.remesh.subdivide_loop(cube.vertices, cube.faces, iterations=2)
    assert isinstance(fine, trimesh.Trimesh) and fine.is_watertight
    np.testing.assert_allclose(np.sort(fine.vertices.round(9), axis=0), np.sort(theirs.round(9), axis=0), atol=1e-8)
    coarse, _ = batten.decimate(fine, vertices=40)
    assert isinstance(coarse, trimesh.Trimesh) and len(coarse.vertices) == 40


def test_faces_of_any_integers(tetrahedron):
    for kind in (np.int64, np.int32, np.uint8, np.float64):
        fine, faces = batten.refine_mesh(tetrahedron.vertices, tetrahedron.faces.astype(kind), levels=1)
        assert fine.shape == (10, 3) and faces.dtype == np.uint32


def test_creases_and_channels(tetrahedron):
    sharp = [(0, 1, 10.0), (1, 2, 10.0), (2, 0, 10.0)]
    fine = batten.refine_mesh(*tetrahedron, scheme="loop", levels=1, creases=sharp, channels=[[0], [1], [2], [3.0]])
    assert len(fine.creases) == 6 and fine.channels.shape == (10, 1) and fine.creases["sharpness"].min() >= 9
    assert not np.array_equal(fine.vertices, batten.refine_mesh(*tetrahedron, scheme="loop", levels=1).vertices)


def test_the_map_goes_there_and_back(sphere_mesh, random):
    coarse, map = batten.decimate(sphere_mesh, vertices=60)
    faces = random.integers(0, len(coarse.faces), 500)
    weights = random.dirichlet([1, 1, 1], 500)
    back, same = map.to_coarse(*map.to_fine(faces, weights))
    points = np.einsum("nc,ncd->nd", weights, coarse.vertices[coarse.faces[faces]])
    again = np.einsum("nc,ncd->nd", same, coarse.vertices[coarse.faces[back]])
    np.testing.assert_allclose(again, points, atol=1e-9)
    np.testing.assert_allclose(map(map(points), inverse=True), points, atol=1e-7)
    assert sphere_mesh.closest(map(points)).distance.max() < 1e-12
    restored = pickle.loads(pickle.dumps(map))
    assert np.array_equal(restored(points), map(points))
    assert batten.decimate(sphere_mesh, vertices=60, map=False).map is None


def test_measures(tetrahedron, sphere_mesh):
    one = batten.measure(tetrahedron)
    assert (one.vertices, one.faces, one.closed, one.genus) == (4, 4, True, 0) and one.volume == pytest.approx(1 / 6)
    two = batten.measure(tetrahedron, (tetrahedron.vertices + [0, 0, 0.1], tetrahedron.faces), samples=1000)
    assert 0 < two.mean < two.hausdorff <= 0.1 + 1e-9
    near = sphere_mesh.closest(sphere_mesh.vertices[:5] + 1)
    assert near.barycentric.sum(axis=1) == pytest.approx(1) and len(near.face) == 5
    assert sphere_mesh.normals().shape == sphere_mesh.vertices.shape


def test_repair_and_weld(tetrahedron):
    soup = batten.Mesh(tetrahedron.vertices[tetrahedron.faces].reshape(-1, 3), np.arange(12).reshape(4, 3))
    assert len(soup.weld().vertices) == 4
    doubled = batten.Mesh(tetrahedron.vertices, np.vstack([tetrahedron.faces, tetrahedron.faces[:1]]))
    with pytest.raises(batten.NotManifold):
        batten.refine_mesh(doubled)
    with pytest.warns(batten.BattenWarning, match="duplicate faces: 1"):
        assert len(doubled.repair().faces) == 4


def test_what_no_manifold_is_told_works(tetrahedron, tmp_path):
    doubled = batten.Mesh(tetrahedron.vertices, np.vstack([tetrahedron.faces, tetrahedron.faces[:1]]))
    for call in (batten.refine_mesh, lambda mesh: batten.decimate(mesh, vertices=4), batten.Mesh.normals):
        with pytest.raises(batten.NotManifold, match=r"; Mesh.of\(mesh\).repair\(\) cuts the mesh there") as caught:
            call(doubled)
        assert caught.value.remedy == "Mesh.repair"
    with pytest.warns(batten.BattenWarning):
        assert len(batten.refine_mesh(batten.Mesh.of(doubled).repair(), levels=1).faces) == 16
    (tmp_path / "repeated.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n")
    with pytest.raises(batten.BattenError, match="; repair= ") as caught:
        batten.Mesh.read(tmp_path / "repeated.obj", strict=True)
    assert caught.value.remedy == "repair"


def test_pickles_and_pictures(tetrahedron):
    again = pickle.loads(pickle.dumps(tetrahedron))
    assert np.array_equal(again.vertices, tetrahedron.vertices)
    assert tetrahedron._repr_png_()[:4] == b"\x89PNG" and draws(tetrahedron)
    assert tetrahedron.picture([0, 1, 2, 3], suffix="svg", width=200).startswith(b"<?xml")


def test_progress(tetrahedron):
    shares = []
    batten.refine_mesh(tetrahedron, levels=7, progress=shares.append)
    assert shares == sorted(shares) and all(0 <= share <= 1 for share in shares)
    with pytest.raises(batten.BattenError):
        batten.measure(batten.refine_mesh(tetrahedron, levels=6), tetrahedron, progress=lambda share: False)

    def broken(share):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        batten.measure(batten.refine_mesh(tetrahedron, levels=6), tetrahedron, progress=broken)
    batten.refine_mesh(tetrahedron, progress=True)


@pytest.mark.skipif(threading.current_thread() is not threading.main_thread(), reason="signals")
def test_interruption(tetrahedron):
    fine = batten.refine_mesh(tetrahedron, scheme="loop", levels=8)
    signal.signal(signal.SIGALRM, lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    signal.setitimer(signal.ITIMER_REAL, 0.05)
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        batten.decimate(fine, vertices=4)
    assert time.monotonic() - begin < 60


def test_the_lock_is_released(tetrahedron):
    """Another thread runs while a call works."""
    fine, counts, done = batten.refine_mesh(tetrahedron, scheme="loop", levels=7), [0], threading.Event()

    def count():
        while not done.is_set():
            counts[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counts[0]
    batten.decimate(fine, vertices=1000)
    after = counts[0]
    done.set()
    thread.join()
    assert after - before > 3


def test_the_limit_has_normals(sphere_mesh):
    fine = batten.refine_mesh(sphere_mesh, scheme="loop", levels=1, limit=True, limit_normals=True)
    assert np.linalg.norm(fine.vertex_normals, axis=1) == pytest.approx(1)
    with pytest.raises(TypeError, match="unknown option 'distance'"):
        batten.refine_mesh(sphere_mesh, distance=1)


def test_targets_of_decimation(sphere_mesh):
    assert len(batten.decimate(sphere_mesh, faces=300).mesh.faces) in (299, 300)
    assert len(batten.decimate(sphere_mesh, ratio=0.5, method="quadric").mesh.faces) == len(sphere_mesh.faces) // 2
    result = batten.decimate(sphere_mesh, tolerance=0.01)
    found = batten.measure(sphere_mesh, result.mesh)
    assert found.hausdorff <= result.bound <= 0.01 and len(result.mesh.faces) < len(sphere_mesh.faces)
    with pytest.raises(batten.InvalidArgument):
        batten.decimate(sphere_mesh, tolerance=0.01, ratio=0.5)


def test_a_target_that_is_not_reached(tetrahedron, sphere_mesh):
    for target, name in ({"vertices": 3}, "vertices"), ({"faces": 2}, "faces"), ({"ratio": 1e-3}, "faces"):
        with pytest.warns(batten.BattenWarning, match=rf"decimation ends at \d+ {name}, not {target.get(name, 2)}: no further edge"):
            made = batten.decimate(sphere_mesh, **target).mesh
        assert 4 <= len(made.vertices) < 20
    with pytest.warns(batten.BattenWarning, match="ends at 4 vertices, not 3"):
        batten.decimate(tetrahedron, vertices=3)
    assert len(batten.decimate(tetrahedron, vertices=4).mesh.vertices) == 4  # a warning would be an error


def test_texture_and_channels_go_through_the_map(sphere_mesh):
    fine = batten.Mesh(*sphere_mesh, texture=sphere_mesh.vertices[:, :2], texture_faces=sphere_mesh.faces,
                       channels=sphere_mesh.vertices[:, 2:], channel_names=["height"])  # fmt: skip
    coarse, map = batten.decimate(fine, vertices=200, attributes=0)
    assert coarse.channels is None and coarse.texture is None
    dressed = map.transfer()
    assert np.abs(dressed.channels[:, 0] - dressed.vertices[:, 2]).max() < 0.1 and dressed.channel_names == ["height"]
    assert dressed.texture_faces.shape == dressed.faces.shape


@pytest.mark.parametrize("ending", ["obj", "ply", "off", "stl", "gltf", "glb"])
def test_files(sphere_mesh, tmp_path, ending):
    sphere_mesh.write(tmp_path / f"mesh.{ending}")
    again = batten.Mesh.read(tmp_path / f"mesh.{ending}")
    assert len(again.faces) == len(sphere_mesh.faces)
    np.testing.assert_allclose(again.vertices[again.faces], sphere_mesh.vertices[sphere_mesh.faces], atol=1e-6)
    with pytest.raises(batten.FileAccess):
        batten.Mesh.read(tmp_path / f"none.{ending}")


def test_labels_are_kept(tetrahedron, tmp_path):
    (tmp_path / "in.obj").write_text(
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no thing\nusemtl red\nf 1 3 2\nf 1 2 4\nusemtl blue\nf 2 3 4\nf 1 4 3\n")
    mesh = batten.Mesh.read(tmp_path / "in.obj")
    assert [mesh.labels[i].material for i in mesh.face_labels] == ["red", "red", "blue", "blue"]
    fine = batten.refine_mesh(mesh, scheme="loop", levels=1)
    assert [fine.labels[i].material for i in fine.face_labels].count("blue") == 8 and fine.labels[0].object == "thing"
    with pytest.warns(batten.BattenWarning, match="m.mtl"):
        fine.write(tmp_path / "out.obj")
    (tmp_path / "m.mtl").write_text("newmtl red\nnewmtl blue\n")
    fine.write(tmp_path / "out.obj")  # a warning would be an error
    again = pickle.loads(pickle.dumps(batten.Mesh.read(tmp_path / "out.obj")))
    assert again.material_files == "m.mtl" and len(again.face_labels) == 16
    with pytest.raises(ValueError, match="face_labels: 4 numbers"):
        batten.Mesh(*tetrahedron, face_labels=[1])
    with pytest.raises(batten.BattenError):
        batten.refine_mesh(batten.Mesh(*tetrahedron, face_labels=[9, 9, 9, 9]))


CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def test_quads_are_refined_by_catmull_clark():
    vertices, quads = batten.refine_mesh(CUBE, QUADS, levels=1)
    assert quads.shape == (24, 4) and len(vertices) == 26
    # Corners of valence 3: (n - 3) / n of the vertex, 2 / n of the edges' mean of middles, 1 / n of the faces'.
    np.testing.assert_allclose(vertices[0], np.full(3, (2 * 1 / 6 + 1 / 3) / 3), atol=1e-12)
    assert np.array_equal(quads, batten.refine_mesh(CUBE, np.array(QUADS), scheme="catmull-clark", levels=1).faces.reshape(-1, 4))
    sharp = [(a, b, 10.0) for quad in QUADS for a, b in zip(quad, quad[1:] + quad[:1]) if a < b]
    same = batten.refine_mesh(CUBE, QUADS, levels=2, creases=sharp, corners=[(i, 10.0) for i in range(8)])
    assert batten.measure(same, (CUBE, np.array(QUADS)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))).hausdorff < 1e-12


def test_polygons_of_all_kinds(tetrahedron):
    faces = [QUADS[0][:3], [1, 3, 2], *QUADS[1:]]
    faces[1] = [QUADS[0][2], QUADS[0][3], QUADS[0][0]]
    mesh = batten.PolygonMesh(CUBE, faces, channels=CUBE[:, :1], channel_names=["x"], face_labels=np.arange(7) % 2,
                              labels=[{"material": "red"}, {"material": "blue"}], rules={"boundary": "corners"})  # fmt: skip
    fine = batten.refine_mesh(mesh, levels=1)
    assert len(fine.offsets) == 2 * 3 + 5 * 4 + 1 and fine.channel_names == ["x"] and fine.rules["boundary"] == "corners"
    assert [fine.labels[i].material for i in fine.face_labels].count("red") == 15
    assert [len(face) for face in list(mesh)[1]] == [3, 3, 4, 4, 4, 4, 4]
    triangles = mesh.triangulate()
    assert len(triangles.faces) == 12 and batten.measure(mesh).volume == pytest.approx(1)
    again = pickle.loads(pickle.dumps(fine))
    assert np.array_equal(again.faces, fine.faces) and fine._repr_png_()[:4] == b"\x89PNG" and draws(fine)
    assert len(batten.refine_mesh(tetrahedron, scheme="catmull-clark", levels=1).offsets) == 13
    assert np.linalg.norm(fine.normals(), axis=1) == pytest.approx(1)


def test_rules_and_adaptive_refinement():
    quad = CUBE[:4], QUADS[:1]
    round, sharp = (batten.refine_mesh(*quad, levels=2, boundary=rule, scheme="catmull-clark") for rule in ("edges", "corners"))
    assert np.array_equal(sharp.vertices[:4], CUBE[:4]) and not np.array_equal(round.vertices[:4], CUBE[:4])
    assert np.array_equal(batten.refine_mesh(batten.PolygonMesh(*quad, rules={"boundary": "corners"}), levels=2).vertices, sharp.vertices)
    coarse, fine = (batten.refine_mesh(CUBE, QUADS, tolerance=tolerance) for tolerance in (0.1, 0.001))
    assert len(coarse.vertices) < len(fine.vertices)
    with pytest.raises(batten.InvalidArgument, match="edges"):
        batten.refine_mesh(CUBE, QUADS, boundary="nothing")
    with pytest.raises(TypeError, match="unknown name"):
        batten.refine_mesh(batten.PolygonMesh(CUBE, QUADS, rules={"border": "corners"}))


@pytest.mark.parametrize("ending", ["obj", "ply", "off"])
def test_files_of_polygons(tmp_path, ending):
    batten.PolygonMesh(CUBE, QUADS).write(tmp_path / f"cube.{ending}")
    again = batten.PolygonMesh.read(tmp_path / f"cube.{ending}")
    assert np.array_equal(again.vertices, CUBE) and again.faces.reshape(-1, 4).tolist() == QUADS
    assert len(batten.Mesh.read(tmp_path / f"cube.{ending}", triangulate=True).faces) == 12
    with pytest.warns(batten.BattenWarning, match="polygons were cut into 12 triangles"):
        assert len(batten.Mesh.read(tmp_path / f"cube.{ending}").faces) == 12
    with pytest.raises(batten.BattenError, match="corners; triangulate= cuts it") as caught:
        batten.Mesh.read(tmp_path / f"cube.{ending}", strict=True)
    assert caught.value.remedy == "triangulate"


def test_trimesh_gets_triangles():
    trimesh = pytest.importorskip("trimesh")
    fine = batten.refine_mesh(trimesh.creation.box(), scheme="catmull-clark", levels=1)
    assert isinstance(fine, trimesh.Trimesh) and fine.is_watertight and len(fine.faces) == 72


@pytest.mark.parametrize("package", ["pyvista", "k3d"])
def test_interactive_views(tetrahedron, package, monkeypatch):
    installed = pytest.importorskip(package)
    if package == "k3d":
        monkeypatch.setitem(sys.modules, "pyvista", None)
    else:
        installed.OFF_SCREEN = True
    made = tetrahedron.plot(interactive=True, color=0xFF0000 if package == "k3d" else "red")
    shown = made.objects[0].vertices if package == "k3d" else made.renderer.actors.popitem()[1].mapper.dataset.points
    np.testing.assert_allclose(shown, tetrahedron.vertices)
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 12)))
    surface = batten.fit_surface(np.stack([x, y, x * y], axis=1))
    for other in (surface, batten.refine_mesh(tetrahedron, scheme="catmull-clark"), batten.decimate(tetrahedron, vertices=4)):
        assert type(other.plot(interactive=True)).__qualname__ == type(made).__qualname__


def test_decimations_draw_themselves(tetrahedron):
    pytest.importorskip("matplotlib")
    made = batten.decimate(batten.refine_mesh(tetrahedron, levels=2), vertices=10)
    assert made._repr_png_() == made.mesh._repr_png_() and made.plot().collections


def test_interactive_views_need_a_package(tetrahedron, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    monkeypatch.setitem(sys.modules, "k3d", None)
    with pytest.raises(ImportError, match="pyvista and k3d"):
        tetrahedron.plot(interactive=True)
