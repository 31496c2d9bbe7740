"""Everything that can be wrong in an argument, over every function: a clear exception, never a crash."""

import re

import numpy as np
import pytest

import batten

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])
GRID = np.stack(np.meshgrid(np.arange(5.0), np.arange(5.0), [0.0]), axis=-1).reshape(-1, 3)


class Hostile:
    def __array__(self, *_, **__):
        raise RuntimeError("hostile")


#: What stands in the place of an array of shape (n, 3).
BAD = {
    "none": None,
    "number": 3.0,
    "text": "text",
    "texts": ["a", "b"],
    "bytes": b"bytes",
    "object": object(),
    "objects": np.array([object(), object()]),
    "hostile": Hostile(),
    "dictionary": {"a": 1},
    "empty": [],
    "no rows": np.empty((0, 3)),
    "no columns": np.empty((4, 0)),
    "one dimension": np.arange(6.0),
    "three dimensions": np.zeros((2, 2, 3)),
    "ragged": [[1.0, 2.0, 3.0], [1.0]],
    "complex": POINTS.astype(complex),
    "dates": np.array([["2026-01-01"] * 3] * 3, "M8[s]"),
    "nan": np.full((4, 3), np.nan),
    "infinite": np.full((4, 3), np.inf),
    "huge": np.full((4, 3), 1e308) * [[1], [-1], [1], [-1]],
    "equal points": np.zeros((4, 3)),
    "one point": np.zeros((1, 3)),
    "structured": np.zeros(4, [("x", float)]),
    "too many columns": np.zeros((3, 5000)),
}

#: Functions of one such array. Those of faces and others get good ones beside.
CALLS = {
    "refine": lambda x: batten.refine(x, closed=True),
    "refine sphere": lambda x: batten.refine(x, space="sphere"),
    "refine offsets": lambda x: batten.refine(x, [0, 4]),
    "offsets": lambda x: batten.refine(POINTS, x),
    "channels": lambda x: batten.refine(POINTS, channels=x),
    "corners": lambda x: batten.refine(POINTS, corners=x),
    "measure": lambda x: batten.measure(x),
    "measure second": lambda x: batten.measure(POINTS, x),
    "analyze": lambda x: batten.analyze(x),
    "smooth": lambda x: pytest.importorskip("shapely") and batten.smooth(x),
    "motion poses": lambda x: batten.Motion([0, 1, 2, 3], x),
    "motion rotation": lambda x: batten.Motion([0, 1, 2, 3], x, space="rotation"),
    "motion times": lambda x: batten.Motion(x, POINTS),
    "motion velocities": lambda x: batten.Motion([0, 1, 2, 3], POINTS, velocities=x),
    "motion call": lambda x: batten.Motion([0, 1, 2, 3], POINTS)(x),
    "mesh vertices": lambda x: batten.refine_mesh(x, FACES),
    "mesh faces": lambda x: batten.refine_mesh(POINTS, x),
    "mesh": lambda x: batten.refine_mesh(x),
    "mesh channels": lambda x: batten.refine_mesh(POINTS, FACES, channels=x),
    "mesh creases": lambda x: batten.refine_mesh(POINTS, FACES, creases=x, scheme="loop"),
    "mesh corners": lambda x: batten.refine_mesh(POINTS, FACES, corners=x, scheme="loop"),
    "mesh texture": lambda x: batten.Mesh(POINTS, FACES, texture=x, texture_faces=FACES),
    "polygons": lambda x: batten.refine_mesh(batten.PolygonMesh(POINTS, x)),
    "polygon vertices": lambda x: batten.refine_mesh(x, [[0, 1, 2, 3]]),
    "polygon texture": lambda x: batten.PolygonMesh(POINTS, FACES, texture=POINTS[:, :2], texture_faces=x),
    "polygon list": lambda x: batten.PolygonMesh(POINTS, [[0, 1, 2], x]).triangulate(),
    "mesh repair": lambda x: batten.Mesh(x, FACES).repair(),
    "mesh weld": lambda x: batten.Mesh(x, FACES).weld(),
    "mesh normals": lambda x: batten.Mesh(x, FACES).normals(),
    "mesh picture": lambda x: batten.Mesh(x, FACES).picture(),
    "mesh values": lambda x: batten.Mesh(POINTS, FACES).picture(x),
    "closest": lambda x: batten.Mesh(POINTS, FACES).closest(x),
    "decimate vertices": lambda x: batten.decimate(x, FACES, vertices=4),
    "decimate faces": lambda x: batten.decimate(POINTS, x, vertices=4),
    "map": lambda x: batten.decimate(POINTS, FACES, vertices=4).map(x),
    "map faces": lambda x: batten.decimate(POINTS, FACES, vertices=4).map.to_fine(x, POINTS),
    "map weights": lambda x: batten.decimate(POINTS, FACES, vertices=4).map.to_coarse([0, 0, 0, 0], x),
    "measure mesh": lambda x: batten.measure((x, FACES)),
    "fit": lambda x: batten.fit_surface(x),
    "fit faces": lambda x: batten.fit_surface(POINTS, x),
    "fit corners": lambda x: batten.fit_surface(GRID, corners=x),
    "fit parameters": lambda x: batten.fit_surface(GRID, parameters=x),
    "cloud noise": batten.cloud_noise,
    "mesh labels": lambda x: batten.Mesh(POINTS, FACES, face_labels=x),
    "surface call": lambda x: surface()(x, 0.5),
    "from_lonlat": batten.from_lonlat,
    "to_lonlat": batten.to_lonlat,
    "space exp": lambda x: batten.Space("sphere").exp(x, POINTS),
    "space log": lambda x: batten.Space("sphere").log(POINTS[1:3], x),
    "space project": lambda x: batten.Space("sphere").project(x),
    "space geodesic": lambda x: batten.Space("sphere").geodesic(POINTS[1], POINTS[2], x),
    "choices": batten.choices,
}

#: What is good in the place of some arrays.
GOOD = {
    **{call: ["none"] for call in ("offsets", "channels", "corners", "measure second", "mesh channels", "motion velocities",
                                   "mesh values", "mesh labels", "fit corners")},
    "smooth": ["none", "empty"], "mesh creases": ["empty"], "mesh corners": ["empty"], "fit faces": ["none"],
    "motion times": ["dates"], "motion call": ["empty", "no rows"], "space exp": ["empty"],
}  # fmt: skip

_surfaces = []


def surface():
    if not _surfaces:
        _surfaces.append(batten.fit_surface(GRID))
    return _surfaces[0]


EXPECTED = (ValueError, TypeError, OverflowError, batten.BattenError, RuntimeError)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("kind", BAD)
def test_bad_arrays(call, kind):
    try:
        result = CALLS[call](BAD[kind])
    except EXPECTED as error:
        assert str(error) and (not isinstance(error, RuntimeError) or kind == "hostile" or isinstance(error, batten.BattenError))
        assert isinstance(error, batten.BattenError) or "cdata" not in str(error)
    else:
        assert kind not in ("text", "texts", "bytes", "object", "objects", "hostile", "dictionary", "ragged", "complex",
                            "structured") or kind in GOOD.get(call, ()), result  # fmt: skip


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.filterwarnings("ignore")
def test_not_a_number_is_refused(call):
    if call in ("mesh corners", "mesh creases", "choices", "corners", "motion velocities"):
        pytest.skip("no coordinates, or unknown ones")
    with pytest.raises(EXPECTED):
        result = CALLS[call](BAD["nan"])
        if isinstance(result, (np.ndarray, batten.Report)):  # element by element
            raise ValueError(f"not refused: {np.isnan(np.asarray(result)).all()}")


OPTIONS = {
    "refine": lambda **o: batten.refine(POINTS, **o), "smooth": lambda **o: batten.smooth([box()], **o),
    "refine_mesh": lambda **o: batten.refine_mesh(POINTS, FACES, **o), "decimate": lambda **o: batten.decimate(POINTS, FACES, **{"vertices": 4, **o}),
    "fit_surface": lambda **o: batten.fit_surface(GRID, **o), "Motion": lambda **o: batten.Motion([0, 1, 2, 3], POINTS, **o),
    "analyze": lambda **o: batten.analyze("chaikin", **o), "measure": lambda **o: batten.measure(POINTS, POINTS + 1, **o),
    "picture": lambda **o: batten.Mesh(POINTS, FACES).picture(**o),
}  # fmt: skip


def box():
    return pytest.importorskip("shapely").box(0, 0, 1, 1)


@pytest.mark.parametrize("call", OPTIONS)
@pytest.mark.parametrize("option", [
    {"no_such": 1}, {"threads": -5}, {"threads": 10**30}, {"threads": 1.5}, {"threads": "x"}, {"threads": None},
    {"threads": object()}, {"levels": float("nan")}, {"report": 1}, {"progress": 3}, {"context": 5}, {"scheme": "no\0pe"},
    {"scheme": 17}, {"tolerance": "x"}, {"tolerance": -1.0}, {"sigma": [1]}, {"degree": [1, 2, 3]}, {"spans": 5}, {"seed": -1}])  # fmt: skip
def test_bad_options(call, option):
    with pytest.raises((*EXPECTED, AttributeError)) as caught:
        OPTIONS[call](**option)
    assert str(caught.value)


def test_messages_name_place_and_way_out():
    with pytest.raises(batten.InvalidPoint, match="point 2") as caught:
        batten.refine([[0, 0], [1, 1], [np.nan, 0]])
    assert caught.value.index == 2
    with pytest.raises(TypeError, match="unknown option 'level'; did you mean levels"):
        batten.refine(POINTS, level=3)
    with pytest.raises(ValueError, match="levels: -1 is out of range; 0 or more is needed"):
        batten.refine(POINTS, levels=-1)
    for call in (lambda: batten.refine(POINTS, scheme="fuor-point"), lambda: batten.analyze("fuor-point")):
        with pytest.raises(batten.InvalidArgument, match="there is no scheme 'fuor-point'; did you mean four-point"):
            call()
    with pytest.raises(batten.InvalidArgument, match="there is no space 'spheer'; did you mean sphere"):
        batten.refine(POINTS, space="spheer")
    with pytest.raises(ValueError, match="faces: numbers from 0"):
        batten.Mesh(POINTS, -FACES)
    with pytest.raises(batten.BattenError, match="vertex 5"):
        batten.refine_mesh(POINTS, FACES + 5)


def test_options_are_checked_where_there_is_nothing_to_do():
    shapely = pytest.importorskip("shapely")
    for given in ([], [None], shapely.Point(0, 0), [shapely.Polygon()]):
        with pytest.raises(TypeError, match="unknown option 'tolerence'; did you mean tolerance"):
            batten.smooth(given, tolerence=1)
        with pytest.raises(batten.InvalidArgument, match="tolerance"):
            batten.smooth(given, tolerance=-1.0)
        for name, text in (("spere", "did you mean sphere"), ("x", "there are disk")):
            with pytest.raises(batten.InvalidArgument, match=f"space: there is no space '{name}'; {text}"):
                batten.smooth(given, space=name)
        assert isinstance(batten.smooth(given, fairness=0.5, levels=2), type(given))


def test_options_are_checked_with_scenes_without_meshes():
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene([trimesh.PointCloud([[0, 0, 0], [1, 1, 1]])])
    with pytest.raises(TypeError, match="unknown option 'level'"):
        batten.refine_mesh(scene, level=1)
    for call in (batten.refine_mesh, batten.decimate):
        with pytest.raises(batten.InvalidArgument, match="tolerance"):
            call(scene, tolerance=-1.0)


def test_messages_name_the_file(tmp_path):
    mesh = batten.Mesh(POINTS, FACES)
    missing = tmp_path / "none.obj"
    for call in (lambda: batten.Mesh.read(missing), lambda: batten.Mesh.read(str(missing)), lambda: batten.PolygonMesh.read(missing)):
        with pytest.raises(batten.FileAccess, match=f"^{re.escape(str(missing))}: cannot open"):
            call()
    with pytest.raises(batten.FileAccess, match="none.csv: cannot open"):
        batten.Motion.read(tmp_path / "none.csv")
    for call in (lambda path: mesh.write(f"{path}.obj"), lambda path: surface().write(f"{path}.step")):
        with pytest.raises(batten.FileAccess, match="no-folder/a.*: cannot write"):
            call(tmp_path / "no-folder" / "a")
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nv 0 0 x\n")
    with pytest.raises(batten.BadFile, match=f"^{re.escape(str(bad))}:2: 'x' is not a number") as caught:
        batten.Mesh.read(bad)
    assert caught.value.line == 2
    with pytest.raises(TypeError, match="unknown part of a mesh: 'chanels'; did you mean channels"):
        batten.Mesh(POINTS, FACES, chanels=POINTS)


MASKED = np.ma.MaskedArray(POINTS, mask=[[False] * 3] * 3 + [[True] * 3])


@pytest.mark.parametrize(("call", "error", "text"), [
    (lambda: batten.refine(MASKED), ValueError, "points: values are masked"),
    (lambda: batten.refine([POINTS, MASKED]), ValueError, "values are masked"),
    (lambda: batten.refine(POINTS, channels=MASKED), ValueError, "channels: values are masked"),
    (lambda: batten.refine_mesh(MASKED, FACES), ValueError, "values are masked"),
    (lambda: batten.measure(MASKED), ValueError, "values are masked"),
    (lambda: batten.Motion(np.ma.MaskedArray([0.0, 1, 2, 3], mask=[0, 1, 0, 0]), POINTS), ValueError, "values are masked"),
    (lambda: batten.refine(POINTS, closed="no"), TypeError, "closed: True or False is needed, not 'no'"),
    (lambda: batten.refine([POINTS, POINTS], closed="no"), TypeError, "closed: True or False"),
    (lambda: batten.refine(POINTS, closed=2), TypeError, "closed: True or False"),
    (lambda: batten.measure(POINTS, closed="no"), TypeError, "closed: True or False"),
    (lambda: batten.Motion([0, 1, 2, 3], POINTS, closed="no"), TypeError, "closed: True or False"),
    (lambda: batten.refine(POINTS, space=5), TypeError, "space: a Space or the name of one is needed, not 5"),
    (lambda: batten.refine(POINTS, scheme=None), TypeError, "scheme: None is no value"),
    (lambda: batten.refine_mesh(POINTS, FACES, scheme=None), TypeError, "scheme: None is no value"),
    (lambda: batten.decimate(POINTS, FACES), TypeError, "decimate needs one of vertices, faces, ratio and tolerance"),
])  # fmt: skip
def test_clear_errors(call, error, text):
    with pytest.raises(error, match=text):
        call()


def test_a_mask_that_hides_nothing_is_fine():
    assert np.array_equal(batten.refine(np.ma.MaskedArray(POINTS)), batten.refine(POINTS))
    assert np.array_equal(batten.refine(POINTS, closed=np.True_), batten.refine(POINTS, closed=1))
