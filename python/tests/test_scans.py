"""Scans: points from files."""

import sys

import numpy as np
import pytest

import batten


@pytest.fixture
def survey(random):
    """Points of a survey far from the origin, in whole millimetres."""
    return np.round(np.array([494797, 5420662, 277]) + random.uniform(0, 50, (3000, 3)), 3)


def write_las(path, points, classes=None, withheld=None, point_format=6):
    laspy = pytest.importorskip("laspy")
    pytest.importorskip("lazrs")
    header = laspy.LasHeader(point_format=point_format, version="1.4")
    header.scales, header.offsets = [0.001] * 3, np.floor(points.min(axis=0))
    file = laspy.LasData(header)
    file.x, file.y, file.z = points.T
    file.classification = np.zeros(len(points), int) if classes is None else classes
    file.withheld = np.zeros(len(points), int) if withheld is None else withheld
    file.write(str(path))
    return path


def write_e57(path, scans):
    """A file of E57 with doubles: scans are names of fields, rows of them, a quaternion or None, and a translation or None."""
    pye57 = pytest.importorskip("pye57")
    e57 = pye57.libe57
    with pye57.E57(str(path), mode="w") as file:
        made = file.image_file
        for names, rows, quaternion, translation in scans:
            scan, pose, prototype = e57.StructureNode(made), e57.StructureNode(made), e57.StructureNode(made)
            scan.set("guid", e57.StringNode(made, "{scan}"))
            for part, keys, numbers in (("rotation", "wxyz", quaternion), ("translation", "xyz", translation)):
                if numbers is not None:
                    node = e57.StructureNode(made)
                    for key, number in reversed(list(zip(keys, numbers))):  # names count, not their order
                        node.set(key, e57.FloatNode(made, float(number)))
                    pose.set(part, node)
            if quaternion is not None or translation is not None:
                scan.set("pose", pose)
            for name in names:
                state = name.endswith("State")
                prototype.set(name, e57.IntegerNode(made, 0, 0, 2) if state else e57.FloatNode(made, 0.0, e57.E57_DOUBLE))
            vector = e57.CompressedVectorNode(made, prototype, e57.VectorNode(made, True))
            scan.set("points", vector)
            file.data3d.append(scan)
            arrays, buffers = file.make_buffers(names, max(len(rows), 1))
            for i, name in enumerate(names):
                arrays[name][: len(rows)] = rows[:, i]
            writer = vector.writer(buffers)
            writer.write(len(rows))
            writer.close()
    return path


CARTESIAN = ["cartesianX", "cartesianY", "cartesianZ"]


def test_files_of_the_library(survey, tmp_path):
    (tmp_path / "a.xyz").write_text("".join(f"{x} {y} {z}\n" for x, y, z in survey))
    assert np.array_equal(batten.read_points(tmp_path / "a.xyz"), survey)
    (tmp_path / "b.csv").write_text("z,y,x\n3,2,1\n6,5,4\n3,2,1\n9,8,8\n")
    with pytest.warns(batten.BattenWarning, match="^1 points that repeat an earlier one are left out"):
        assert batten.read_points(str(tmp_path / "b.csv")).tolist() == [[1, 2, 3], [4, 5, 6], [8, 8, 9]]
    with pytest.raises(batten.InvalidPoint, match=r"b.csv:4: the point repeats that of line 2"):
        batten.read_points(tmp_path / "b.csv", strict=True)
    with pytest.raises(batten.InvalidArgument, match="only points of LAS files have classes"):
        batten.read_points(tmp_path / "b.csv", classes=2)
    with pytest.raises(batten.FileAccess, match="none.laz"):
        batten.read_points(tmp_path / "none.laz")


def test_meshes_give_their_vertices_in_order(tetrahedron, patch, tmp_path):
    tetrahedron.write(tmp_path / "closed.ply")
    assert np.array_equal(batten.read_points(tmp_path / "closed.ply"), tetrahedron.vertices)
    grid = batten.fit_surface(patch, functions=16).mesh(9)
    grid.write(tmp_path / "patch.obj")
    assert np.array_equal(batten.read_points(tmp_path / "patch.obj"), grid.vertices)
    settings = {"parameters": "mean-value", "functions": 16}
    of_file, of_mesh = batten.fit_surface(tmp_path / "patch.obj", **settings), batten.fit_surface(grid, **settings)
    assert np.array_equal(of_file.parameters, of_mesh.parameters) and np.array_equal(of_file.points, of_mesh.points)


def test_a_file_becomes_a_surface(patch, sphere_mesh, tmp_path):
    """The boundary and the corners that a file tells are those of the surface."""
    grid = np.arange(144).reshape(12, 12)
    loop = [*grid[0, :-1], *grid[:-1, -1], *grid[-1, :0:-1], *grid[:0:-1, 0]]
    rows = patch[[*loop, *np.setdiff1d(np.arange(144), loop)]]
    text = "# 44 boundary points first\n# corners 0 11 22 33\n" + "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in rows.tolist())
    (tmp_path / "patch.xyz").write_text(text)
    surface = batten.fit_surface(tmp_path / "patch.xyz", functions=16)
    np.testing.assert_allclose(surface.parameters[[0, 11, 22, 33]], [[0, 0], [1, 0], [1, 1], [0, 1]])
    given = batten.fit_surface(rows, boundary=44, corners=[0, 11, 22, 33], functions=16)
    assert np.array_equal(surface.control, given.control)
    sphere_mesh.write(tmp_path / "ball.stl")
    assert batten.fit_surface(str(tmp_path / "ball.stl"), shell=True, faces=24).closed
    kept = tmp_path / "kept.safetensors"
    with pytest.raises(batten.BattenError, match="stopped"):
        batten.fit_surface(tmp_path / "ball.stl", shell=True, faces=24, resume=kept, progress=lambda share: share < 0.72)
    assert kept.exists()
    assert batten.fit_surface(tmp_path / "ball.stl", shell=True, faces=24, resume=kept).closed and not kept.exists()
    with pytest.raises(TypeError, match="a file has its own"):
        batten.fit_surface(tmp_path / "patch.xyz", [[0, 1, 2]])


@pytest.mark.parametrize("point_format", [1, 6])
def test_compressed_las_is_that_of_las(survey, tmp_path, random, point_format):
    """LAZ is read as the library reads LAS: digits, classes, deleted and repeated points."""
    classes, withheld = random.choice([1, 2, 7, 18], len(survey)), random.uniform(size=len(survey)) < 0.1
    survey[-3:] = survey[:3]
    classes[:3] = classes[-3:] = 2
    withheld[:3] = withheld[-3:] = False
    las, laz = (write_las(tmp_path / f"scan.{kind}", survey, classes, withheld, point_format) for kind in ("las", "laz"))
    for chosen in (None, 2, (2, 7), {2}, "1,18"):
        with pytest.warns(batten.BattenWarning) as of_las:
            expected = batten.read_points(las, classes=chosen)
        with pytest.warns(batten.BattenWarning) as of_laz:
            points = batten.read_points(laz, classes=chosen)
        assert np.array_equal(points, expected) and len(points) > 100
        assert {str(warning.message) for warning in of_laz} == {str(warning.message) for warning in of_las}
        assert all(warning.filename == __file__ for warning in of_laz)
    with pytest.warns(batten.BattenWarning):
        everything = batten.read_points(laz, classes=range(256))
    kept = survey[~withheld][: len(everything)]
    assert np.array_equal(np.round(everything, 3), kept) and abs(everything - kept).max() < 2e-9
    with pytest.raises(batten.InvalidPoint, match="3 points repeat an earlier one"):
        batten.read_points(laz, classes=2, strict=True)
    for wrong in (256, -1, "2;8", 2.5):
        with pytest.raises(batten.InvalidArgument, match="classes"):
            batten.read_points(laz, classes=wrong)
    with pytest.raises(batten.BadFile, match="there are no points"):
        batten.read_points(laz, classes=9)


def test_a_surface_of_compressed_las(patch, tmp_path):
    points = np.round(1000 * patch, 3) + [500000, 5400000, 300]
    surface = batten.fit_surface(write_las(tmp_path / "a.laz", points), functions=16)
    assert np.array_equal(surface.control, batten.fit_surface(batten.read_points(tmp_path / "a.laz"), functions=16).control)
    assert abs(surface(*surface.parameters.T) - points).max() < 1


def test_damaged_compressed_las_is_refused(survey, tmp_path, random):
    content = write_las(tmp_path / "a.laz", survey).read_bytes()
    cut = [content[:size] for size in random.integers(110, len(content), 20)]
    for damaged in cut:
        (tmp_path / "b.laz").write_bytes(damaged)
        with pytest.raises(batten.BadFile, match="b.laz: "):
            batten.read_points(tmp_path / "b.laz")


def test_scans_of_e57_are_joined(survey, tmp_path):
    """Poses are applied, whatever their parts and the kind of coordinates; invalid points are left out."""
    half = np.sqrt(0.5)
    turned = survey[:1000] - [494797, 5420662, 277]
    turned = np.stack([turned[:, 1], -turned[:, 0], turned[:, 2]], axis=1)  # a quarter turn about z back
    state = np.zeros((1000, 1))
    state[10:13, 0] = [1, 2, 2]
    near = survey[2000:] - [494700, 5420600, 200]
    radius = np.linalg.norm(near, axis=1)
    polar = np.stack([radius, np.arctan2(near[:, 1], near[:, 0]), np.arcsin(near[:, 2] / radius)], axis=1)
    spherical = ["sphericalRange", "sphericalAzimuth", "sphericalElevation"]
    scans = [
        ([*CARTESIAN, "cartesianInvalidState"], np.hstack([turned, state]), [2 * half, 0, 0, 2 * half], [494797, 5420662, 277]),
        (CARTESIAN, survey[1000:2000], None, None),
        (spherical, polar, None, [494700, 5420600, 200]),
        (CARTESIAN, np.empty((0, 3)), None, None),
    ]
    with pytest.warns(batten.BattenWarning, match="^3 points that are invalid are left out"):
        points = batten.read_points(write_e57(tmp_path / "a.e57", scans))
    expected = np.delete(survey, range(10, 13), axis=0)
    assert abs(points - expected).max() < 2e-9 and np.array_equal(points[997:1997], survey[1000:2000])
    with pytest.raises(batten.InvalidArgument, match="only points of LAS files have classes"):
        batten.read_points(tmp_path / "a.e57", classes=2)


def test_files_of_pye57(patch, tmp_path):
    pye57 = pytest.importorskip("pye57")
    with pye57.E57(str(tmp_path / "a.e57"), mode="w") as file:
        file.write_scan_raw(dict(zip(CARTESIAN, patch.T)), translation=np.array([5e6, 0, 0]))
    (tmp_path / "a.e57").rename(tmp_path / "scan")  # the content tells
    points = batten.read_points(tmp_path / "scan")
    np.testing.assert_allclose(points, patch + [5e6, 0, 0], atol=1e-7)
    assert batten.fit_surface(tmp_path / "scan", functions=16).report.rms < 1e-3


def test_damaged_e57_is_refused(survey, tmp_path, random):
    content = write_e57(tmp_path / "a.e57", [(CARTESIAN, survey, None, None)]).read_bytes()
    names = ["cartesianX", "cartesianY", "intensity"]
    with pytest.raises(batten.BadFile, match="scan 0 has no coordinates"):
        batten.read_points(write_e57(tmp_path / "b.e57", [(names, survey, None, None)]))
    with pytest.raises(batten.BadFile, match="quaternion"):
        batten.read_points(write_e57(tmp_path / "b.e57", [(CARTESIAN, survey, [0, 0, 0, 0], None)]))
    with pytest.raises(batten.BadFile, match="no points"):
        batten.read_points(write_e57(tmp_path / "b.e57", []))
    for size in (8, 48, len(content) // 2, len(content) - 1024):
        (tmp_path / "b.e57").write_bytes(content[:size])
        with pytest.raises(batten.BadFile, match="b.e57: the file is damaged"):
            batten.read_points(tmp_path / "b.e57")
        assert (tmp_path / "b.e57").stat().st_size == size  # it stays
    flipped = bytearray(content)
    flipped[len(content) // 3] ^= 16
    (tmp_path / "b.e57").write_bytes(flipped)
    with pytest.raises(batten.BadFile):  # by its checksum
        batten.read_points(tmp_path / "b.e57")


def test_missing_packages_are_named(monkeypatch, tmp_path):
    header = bytearray(b"LASF".ljust(400, b"\0"))
    header[104] = 0x80
    (tmp_path / "a.laz").write_bytes(header)
    (tmp_path / "a.e57").write_bytes(b"ASTM-E57" + bytes(40))
    for name in ("laspy", "lazrs", "pye57"):
        monkeypatch.setitem(sys.modules, name, None)
        file = "a.e57" if name == "pye57" else "a.laz"
        with pytest.raises(batten.Unsupported, match=rf"{file}: .*{name}.*pip install 'batten\[scans\]'"):
            batten.read_points(tmp_path / file)
