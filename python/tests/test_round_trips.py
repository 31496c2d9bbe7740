"""What came in comes out: every field of objects of other packages."""

import datetime

import numpy as np
import pytest

import batten


@pytest.fixture
def trimesh():
    return pytest.importorskip("trimesh")


def ball(trimesh):
    mesh = trimesh.creation.icosphere(2)
    mesh.vertex_attributes.update(height=mesh.vertices[:, 2].copy(), vector=2 * mesh.vertices, number=np.arange(len(mesh.vertices)))
    mesh.face_attributes.update(part=np.arange(len(mesh.faces)), weight=np.linspace(0, 1, len(mesh.faces)))
    mesh.metadata.update(name="ball", source={"file": "ball.obj"})
    mesh.units = "mm"
    return mesh


def refined(mesh):
    return batten.refine_mesh(mesh, scheme="midpoint", levels=1)


def decimated(mesh):
    return batten.decimate(mesh, vertices=60).mesh


def decimated_without_map(mesh):
    return batten.decimate(mesh, vertices=60, map=False, method="fast").mesh


WAYS = [refined, decimated, decimated_without_map]


@pytest.mark.parametrize("way", WAYS)
def test_attributes_and_metadata_of_trimesh(trimesh, way):
    given = ball(trimesh)
    made = way(given)
    assert made.metadata == given.metadata and made.units == "mm" and made.metadata is not given.metadata
    for store in ("vertex_attributes", "face_attributes"):
        ours, theirs = getattr(made, store), getattr(given, store)
        assert {name: values.dtype for name, values in ours.items()} == {name: values.dtype for name, values in theirs.items()}
    # Linear functions of the position stay that, up to the distance between both surfaces.
    near = 1e-12 if way is refined else 0.2
    np.testing.assert_allclose(made.vertex_attributes["height"], made.vertices[:, 2], atol=near)
    np.testing.assert_allclose(made.vertex_attributes["vector"], 2 * made.vertices, atol=2 * near)
    # Numbers of vertices and of faces are those of near ones.
    edge = given.edges_unique_length.max()
    assert np.linalg.norm(given.vertices[made.vertex_attributes["number"]] - made.vertices, axis=1).max() < edge
    assert np.linalg.norm(given.triangles_center[made.face_attributes["part"]] - made.triangles_center, axis=1).max() < edge
    np.testing.assert_array_equal(made.face_attributes["weight"], given.face_attributes["weight"][made.face_attributes["part"]])


@pytest.mark.parametrize("way", WAYS)
def test_attributes_of_trimesh_that_nothing_interpolates(trimesh, way):
    given = ball(trimesh)
    given.vertex_attributes.update(hot=np.where(given.vertices[:, 0] > 0, np.nan, 1.0), none=np.empty((len(given.vertices), 0)))
    with pytest.warns(batten.BattenWarning, match="attribute 'hot' has values that are not finite") as told:
        made = way(given)
    assert len(told) == 1 and made.vertex_attributes["none"].shape == (len(made.vertices), 0)
    near = made.vertex_attributes["number"]
    np.testing.assert_array_equal(made.vertex_attributes["hot"], given.vertex_attributes["hot"][near])
    assert np.isnan(made.vertex_attributes["hot"]).any() and not np.isnan(made.vertex_attributes["hot"]).all()


@pytest.mark.parametrize("way", WAYS)
def test_colours_of_trimesh(trimesh, way):
    given = trimesh.creation.icosphere(2)
    colours = np.clip(128 + 100 * given.vertices[:, [0, 1, 2, 0]], 0, 255).astype(np.uint8)
    given.visual.vertex_colors = colours
    made = way(given)
    assert made.visual.kind == "vertex" and made.visual.vertex_colors.dtype == np.uint8
    expected = 128 + 100 * made.vertices[:, [0, 1, 2, 0]]
    np.testing.assert_allclose(made.visual.vertex_colors, expected, atol=2 if way is refined else 15)
    given = trimesh.creation.icosphere(2)
    given.visual.face_colors = np.where(given.triangles_center[:, :1] > 0, [[255, 0, 0, 255]], [[0, 0, 255, 128]])
    made = way(given)
    assert made.visual.kind == "face"
    assert {tuple(row) for row in made.visual.face_colors} == {(255, 0, 0, 255), (0, 0, 255, 128)}
    assert (made.visual.face_colors[:, 0] == 255)[made.triangles_center[:, 0] > 0.2].all()


def sheet(trimesh):
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, 13), np.linspace(0, 1, 13)))
    mesh = trimesh.Trimesh(np.stack([x, y, 0.1 * np.sin(6 * x)], axis=1), grid(12), process=False)
    material = trimesh.visual.material.PBRMaterial(name="paint", baseColorFactor=[10, 20, 30, 255], metallicFactor=0.25)
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.stack([x, y], axis=1), material=material)
    mesh.visual.vertex_attributes["shade"] = x + y
    return mesh


def grid(n):
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    return np.concatenate([np.stack([first, first + 1, first + n + 2], axis=1), np.stack([first, first + n + 2, first + n + 1], axis=1)])


@pytest.mark.parametrize("way", WAYS)
def test_texture_of_trimesh(trimesh, way):
    given = sheet(trimesh)
    made = way(given)
    assert made.visual.kind == "texture" and len(made.visual.uv) == len(made.vertices)
    assert made.visual.material.name == "paint" and made.visual.material.metallicFactor == 0.25
    np.testing.assert_allclose(made.visual.uv, made.vertices[:, :2], atol=1e-12 if way is refined else 0.1)
    np.testing.assert_allclose(made.visual.vertex_attributes["shade"], made.vertices[:, :2].sum(axis=1), atol=1e-12 if way is refined else 0.1)


def seamed(trimesh, tmp_path):
    """An octahedron of two charts, which meet in all edges; both poles join opposite faces of a chart."""
    vertices = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"vt {x + 5 * chart} {y}" for chart in (0, 1) for x, y, _ in vertices]
    for i in range(4):
        for face in ((i, (i + 1) % 4, 4), ((i + 1) % 4, i, 5)):
            lines.append("f " + " ".join(f"{k + 1}/{k + 1 + 6 * (i % 2)}" for k in face))
    (tmp_path / "seamed.obj").write_text("\n".join(lines))
    mesh = trimesh.load(tmp_path / "seamed.obj", process=False)
    mesh = mesh if hasattr(mesh, "faces") else mesh.to_mesh()
    assert len(mesh.vertices) == 12 and len(batten.Mesh.read(tmp_path / "seamed.obj").vertices) == 6
    mesh.vertex_attributes.update(chart=(mesh.visual.uv[:, 0] > 3).astype(float), height=mesh.vertices[:, 2].copy(), number=np.arange(12))
    return mesh


def closed(trimesh, mesh):
    bare = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    bare.merge_vertices()
    return bare.is_watertight


def test_seams_of_trimesh_stay_closed(trimesh, tmp_path):
    given = seamed(trimesh, tmp_path)
    for scheme in ("loop", "learned", "midpoint"):
        fine, own = (batten.refine_mesh(mesh, scheme=scheme, levels=2) for mesh in (given, batten.Mesh.read(tmp_path / "seamed.obj")))
        assert closed(trimesh, fine) and np.array_equal(fine.triangles, own.vertices[own.faces])
        assert np.array_equal(fine.visual.uv[fine.faces], own.texture[own.texture_faces])
    assert len(fine.vertices) > 66 and np.abs(fine.visual.uv[:, 1] - fine.vertices[:, 1]).max() < 1e-12
    chart = fine.visual.uv[:, 0] > 3
    for name, values in fine.vertex_attributes.items():
        expected = {"chart": chart, "height": fine.vertices[:, 2], "number": values}[name]
        np.testing.assert_allclose(values, expected, atol=1e-12)
    assert np.array_equal(given.visual.uv[fine.vertex_attributes["number"], 0] > 3, chart)
    assert closed(trimesh, batten.refine_mesh(given, scheme="catmull-clark", levels=1))
    assert batten.measure(given).closed and len(given.vertices) == 12  # not changed
    coarse = batten.decimate(fine, faces=40)
    assert closed(trimesh, coarse.mesh) and len(coarse.mesh.faces) in (39, 40) and len(coarse.mesh.visual.uv) == len(coarse.mesh.vertices)
    assert closed(trimesh, batten.decimate(fine, faces=40, map=False, method="fast").mesh)


def test_creases_of_a_trimesh_with_seams(trimesh, tmp_path):
    given = seamed(trimesh, tmp_path)
    at = [int(np.flatnonzero((given.vertices == place).all(axis=1))[-1]) for place in ([1, 0, 0], [0, 1, 0])]
    sharp = batten.refine_mesh(given, scheme="loop", levels=2, creases=[(*at, 9.0)], corners=[(at[0], 9.0)])
    own = batten.refine_mesh(batten.Mesh.read(tmp_path / "seamed.obj"), scheme="loop", levels=2, creases=[(0, 1, 9.0)], corners=[(0, 9.0)])
    assert np.array_equal(sharp.triangles, own.vertices[own.faces])
    with pytest.raises(ValueError, match="vertex 12"):
        batten.refine_mesh(given, scheme="loop", corners=[(12, 9.0)])


def test_vertices_that_only_touch_stay_apart(trimesh):
    box = trimesh.creation.box()
    both = trimesh.util.concatenate([box, box.copy().apply_translation([1, 1, 0])])
    both.visual = trimesh.visual.TextureVisuals(uv=both.vertices[:, :2])
    assert len(both.vertices) == 16 and len(batten.refine_mesh(both, levels=1).vertices) == 52


def test_scenes_of_trimesh(trimesh):
    scene = trimesh.Scene()
    turn = trimesh.transformations.rotation_matrix(0.3, [0, 0, 1], [1, 2, 3])
    scene.add_geometry(ball(trimesh), node_name="first", geom_name="ball", transform=turn)
    scene.add_geometry(sheet(trimesh), node_name="second", geom_name="sheet", parent_node_name="first")
    scene.add_geometry(trimesh.PointCloud([[0, 0, 0], [1, 1, 1]]), node_name="third", geom_name="cloud")
    scene.metadata["project"] = "test"
    for made in (refined(scene), batten.decimate(scene, ratio=0.5).mesh):
        assert isinstance(made, trimesh.Scene) and made.metadata == scene.metadata
        assert list(made.geometry) == list(scene.geometry) and set(made.graph.nodes) == set(scene.graph.nodes)
        assert np.array_equal(made.graph.get("second")[0], scene.graph.get("second")[0])
        assert made.geometry["ball"].metadata["name"] == "ball" and made.geometry["sheet"].visual.kind == "texture"
        assert len(made.geometry["ball"].faces) != len(scene.geometry["ball"].faces)
        assert np.array_equal(made.geometry["cloud"].vertices, scene.geometry["cloud"].vertices)
    assert set(batten.decimate(scene, ratio=0.5).map) == {"ball", "sheet"}
    assert len(scene.geometry["ball"].faces) == 320  # not changed


def test_creases_of_scenes_of_trimesh(trimesh):
    mesh = trimesh.creation.icosphere(1)
    sharp = dict(creases=[(*mesh.edges[0], 9.0)], corners=[(mesh.edges[0, 0], 9.0)], scheme="loop", levels=2)
    alone, round = batten.refine_mesh(mesh, **sharp), batten.refine_mesh(mesh, scheme="loop", levels=2)
    inside = batten.refine_mesh(trimesh.Scene({"mesh": mesh, "cloud": trimesh.PointCloud([[0, 0, 0], [1, 1, 1]])}), **sharp).geometry["mesh"]
    assert np.array_equal(inside.vertices, alone.vertices) and not np.array_equal(inside.vertices, round.vertices)
    for name in ("creases", "corners"):
        with pytest.raises(TypeError, match=f"{name}: a scene of one mesh"):
            batten.refine_mesh(trimesh.Scene([mesh, mesh.copy()]), **{name: sharp[name]})
    for given in (mesh, trimesh.Scene([mesh])):
        with pytest.raises(TypeError, match="channels: .* vertex_attributes"):
            batten.refine_mesh(given, channels=mesh.vertices)


def test_a_schemes_polygons_and_primitives_of_trimesh(trimesh):
    made = batten.refine_mesh(ball(trimesh), scheme="catmull-clark", levels=1)
    assert isinstance(made, trimesh.Trimesh) and made.face_attributes["part"].max() == 319
    assert type(batten.refine_mesh(trimesh.primitives.Box(), levels=1)) is trimesh.Trimesh
    fine = batten.Mesh.of(sheet(trimesh))
    assert fine.texture.shape == (169, 2)


def test_heights_and_measures_of_shapely():
    shapely = pytest.importorskip("shapely")
    if not hasattr(shapely, "has_m"):
        pytest.skip("measures need shapely 2.1")
    texts = ["LINESTRING M (0 0 5, 1 1 6, 2 0 7)", "LINESTRING ZM (0 10 5 1, 1 11 6 2, 2 10 7 3)", "LINESTRING Z (0 20 5, 1 21 6, 2 20 7)",
             "MULTIPOLYGON M (((10 0 1, 11 0 2, 11 1 3, 10 0 1)),((20 0 1, 21 0 2, 21 1 3, 20 0 1)))",
             "POLYGON ZM ((40 0 1 2, 44 0 1 2, 44 4 1 2, 40 0 1 2), (42 1 3 4, 43 1 3 4, 43 2 3 4, 42 1 3 4))",
             "GEOMETRYCOLLECTION ZM (LINESTRING ZM (30 0 5 1, 31 1 6 2, 32 0 7 3), POINT ZM (1 2 3 4))",
             "LINEARRING M (50 0 1, 51 0 2, 51 1 3, 50 0 1)", "POINT M (1 2 3)"]  # fmt: skip
    given = [shapely.from_wkt(text) for text in texts]
    for space in ("plane", "sphere"):
        made = batten.smooth(given, space=space, levels=2)
        flat = batten.smooth([shapely.force_2d(part) for part in given], space=space, levels=2)
        for before, after, plain in zip(given, made, flat):
            assert (after.geom_type, after.has_z, after.has_m) == (before.geom_type, before.has_z, before.has_m)
            rows = shapely.get_coordinates(after, include_z=True, include_m=True)
            np.testing.assert_array_equal(rows[:, :2], shapely.get_coordinates(plain))
            old = shapely.get_coordinates(before, include_z=True, include_m=True)
            kept = [row for row in rows if any(np.allclose(row, other, equal_nan=True) for other in old)]
            assert len(kept) >= len(old) - 2  # given points keep their heights and measures
    line = shapely.get_coordinates(batten.smooth(given[0], levels=2), include_m=True)
    assert len(line) == 9 and (np.diff(line[:, 2]) > 0).all()
    with pytest.raises(ValueError, match="geometry 0: coordinates that are finite"):
        batten.smooth([shapely.from_wkt("LINESTRING M (0 0 5, 1 1 NaN, 2 0 7)")])


def test_tables_of_geopandas_in_degrees_and_grads():
    geopandas = pytest.importorskip("geopandas")
    shapely = pytest.importorskip("shapely")
    degrees = np.array([[0.0, 55], [10, 55], [20, 50]])
    table = geopandas.GeoDataFrame(
        {"name": ["a"], "label": geopandas.GeoSeries([shapely.Point(1, 2)], index=[7])}, geometry=[shapely.LineString(degrees)],
        index=[7], crs="EPSG:4326").rename_geometry("shape")  # fmt: skip
    table.attrs["source"] = "survey"
    made = batten.smooth(table, levels=2)
    assert list(made.columns) == list(table.columns) and made.index.equals(table.index) and made.crs == table.crs
    assert made.geometry.name == "shape" and made.attrs == table.attrs and made.label.iloc[0] == table.label.iloc[0]
    series = table.geometry
    series.attrs["source"] = "survey"
    again = batten.smooth(series, levels=2)
    assert again.attrs == series.attrs and again.name == "shape" and again.index.equals(series.index)
    grads = geopandas.GeoSeries([shapely.LineString(degrees / 0.9)], crs="EPSG:4807")
    other = batten.smooth(grads, levels=2)
    assert other.crs == grads.crs
    np.testing.assert_allclose(shapely.get_coordinates(other) * 0.9, shapely.get_coordinates(made.geometry), atol=1e-9)


def test_geometries_of_pandas_and_arrays_of_geopandas():
    geopandas, pandas = pytest.importorskip("geopandas"), pytest.importorskip("pandas")
    shapely = pytest.importorskip("shapely")
    box, point = shapely.box(0, 0, 1, 1), shapely.Point(5, 5)
    fine = batten.smooth(box, levels=2)
    table = pandas.DataFrame({"a": [5, 6], "shape": [box, point], "b": ["x", "y"]}, index=[7, 8])
    made = batten.smooth(table, levels=2)
    assert type(made) is pandas.DataFrame and made.index.equals(table.index) and made["shape"][7].equals(fine)
    assert made.drop(columns="shape").equals(table.drop(columns="shape")) and table["shape"][7].equals(box)
    series = batten.smooth(table["shape"], levels=2)
    assert type(series) is pandas.Series and series.index.equals(table.index) and series.name == "shape" and series[7].equals(fine)
    array = geopandas.GeoSeries([box, point], crs=4326).values
    made = batten.smooth(array, levels=2)
    assert type(made) is type(array) and made.crs == array.crs and made[1] == point
    again = batten.smooth(pandas.Series(array, index=[3, 4]), levels=2)
    assert again.array.crs == array.crs and list(again.index) == [3, 4] and again.array[0].equals(made[0])
    with pytest.raises(TypeError, match="one column of geometries is needed, not 2"):
        batten.smooth(table.assign(other=table["shape"]))
    with pytest.raises(TypeError, match="one column of geometries is needed, not 0"):
        batten.smooth(table[["a", "b"]])


def test_rings_that_repeat_their_first_point():
    ring = np.array([[0.0, 0], [2, 0], [2, 1], [0, 1], [0, 0]])
    made = batten.refine(ring, closed=True, channels=np.arange(5.0)[:, None])
    assert np.array_equal(made, batten.refine(ring[:-1], closed=True)) and len(made.channels) == len(made)
    several = batten.refine([ring, ring[:-1], ring], closed=True)
    assert list(several.offsets) == [0, 128, 256, 384] and np.array_equal(several[0], several[1])
    shapely = pytest.importorskip("shapely")
    assert np.array_equal(batten.refine(np.array(shapely.Polygon(ring).exterior.coords), closed=True), made)
    with pytest.raises(TypeError, match="batten.smooth"):
        batten.refine(shapely.LineString(ring))


START = datetime.datetime(2026, 1, 1, 12)
STEPS = [datetime.timedelta(seconds=0.5 * i) for i in range(4)]
POSES = [[0.0], [1.0], [8.0], [27.0]]


@pytest.mark.parametrize("times", [
    [START + step for step in STEPS], STEPS, np.array(STEPS, "m8[ms]"), np.array([START + step for step in STEPS], "M8[us]"),
    [(START + step).replace(tzinfo=datetime.timezone(datetime.timedelta(hours=2))) for step in STEPS]])  # fmt: skip
def test_times_of_python_and_numpy(times):
    motion = batten.Motion(times, POSES)
    assert motion([times[1], times[1]]) == pytest.approx(np.ones((2, 1))) and motion(times[2]) == pytest.approx([8])
    assert motion.velocity(times[1]) == pytest.approx([6.0])  # a second


@pytest.mark.parametrize("zone", [None, "Europe/Berlin"])
def test_times_of_pandas(zone):
    pandas = pytest.importorskip("pandas")
    times = pandas.date_range("2026-03-29 00:30", periods=4, freq="500ms", tz=zone)
    for given in (times, pandas.Series(times, index=[5, 6, 7, 8]), list(times)):
        assert batten.Motion(given, POSES)(times[2]) == pytest.approx([8])
    assert batten.Motion(times - times[0], POSES)(pandas.Timedelta("1s")) == pytest.approx([8])


def test_rigid_transforms_of_scipy():
    transform = pytest.importorskip("scipy.spatial.transform")
    if not hasattr(transform, "RigidTransform"):
        pytest.skip("RigidTransform needs scipy 1.16")
    turns = transform.Rotation.from_rotvec([[0, 0, 0], [0, 0, 1], [0, 0, 2]])
    given = transform.RigidTransform.from_components([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]], turns)
    made = batten.Motion([0, 1, 2], given)([0.5, 1])
    assert isinstance(made, transform.RigidTransform)
    np.testing.assert_allclose(made.as_matrix()[1], given.as_matrix()[1], atol=1e-12)
    np.testing.assert_allclose(batten.Motion([0, 1, 2], given)(0.5).as_matrix(), made.as_matrix()[0], atol=1e-12)


def test_arrays_of_xarray():
    xarray = pytest.importorskip("xarray")
    given = xarray.DataArray([[0.0, 0], [1, 1], [2, 0]], dims=("point", "axis"), coords={"axis": ["x", "y"], "point": [3, 4, 5]}, name="track",
                             attrs={"unit": "m"})  # fmt: skip
    made = batten.refine(given, levels=2)
    assert isinstance(made, xarray.DataArray) and made.dims == given.dims and made.name == "track" and made.attrs == given.attrs
    assert list(made.axis.values) == ["x", "y"] and np.array_equal(made.values, batten.refine(given.values, levels=2))


def test_coordinates_of_xarray():
    xarray = pytest.importorskip("xarray")
    given = xarray.DataArray([[0.0, 0], [1, 1], [2, 0]], dims=("point", "axis"), coords={
        "axis": ["x", "y"], "unit": ("axis", ["m", "km"]), "run": 7, "point": [3, 4, 5], "both": (("point", "axis"), np.ones((3, 2)))})  # fmt: skip
    made = batten.refine(given, levels=2)
    assert set(made.coords) == {"axis", "unit", "run"} and made.run == 7 and list(made.unit.values) == ["m", "km"]
    bare = batten.refine(xarray.DataArray(given.values), levels=2)
    assert not bare.coords and np.array_equal(bare.values, made.values)
    several = batten.refine(given, [0, 3], levels=2)
    assert isinstance(several, batten.Curves) and np.array_equal(several[0], made.values)


def test_nullable_columns_of_pandas():
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame({"x": [0, 1, 2, 4], "y": [0, 1, 0.5, 0.25]})
    nullable = table.convert_dtypes()
    assert [str(kind) for kind in nullable.dtypes] == ["Int64", "Float64"]
    made = batten.refine(nullable)
    assert np.array_equal(made, batten.refine(table.to_numpy()))
    motion = batten.Motion(nullable["x"], nullable[["y"]])
    assert np.array_equal(motion(nullable["x"]), batten.Motion(table["x"], table[["y"]])(table["x"]))
    missing = nullable.copy()
    missing.iloc[1, 1] = pandas.NA
    with pytest.raises(ValueError, match="points: values are missing in column 'y'; drop or fill"):
        batten.refine(missing)
    with pytest.raises(ValueError, match="times: values are missing; drop or fill|time of point 1 is not finite"):
        batten.Motion(missing["y"], table[["y"]])
    with pytest.raises(TypeError, match="points: numbers are needed"):
        batten.refine(nullable.assign(name="a"))
