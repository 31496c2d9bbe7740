"""Maps: shapely and geopandas in and out."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

import batten

shapely = pytest.importorskip("shapely")

COUNTRIES = Path(__file__).parents[3] / "shared/data/maps/countries-110m.geojson"


@pytest.fixture
def counties():
    """Nine polygons that share borders, one with a hole that another fills."""
    cells = [shapely.box(x, y, x + 1, y + 1) for x in range(3) for y in range(3)]
    inner = shapely.Polygon([(1.3, 1.3), (1.7, 1.4), (1.6, 1.7), (1.3, 1.6)])
    cells[4] = cells[4].difference(inner)
    return [*cells, inner]


def test_a_coverage_stays_a_coverage(counties):
    details = batten.Report()
    fine = batten.smooth(counties, levels=4, details=details)
    assert shapely.is_valid(fine).all() and bool(shapely.coverage_is_valid(fine))
    assert details.shared > 0 and fine[0].area != counties[0].area
    assert isinstance(fine, list) and sum(part.area for part in fine) == pytest.approx(shapely.union_all(fine).area)


def test_every_kind_of_geometry_comes_back(counties):
    line = shapely.LineString([(10, 0), (11, 1), (12, 0)])
    ring = shapely.LinearRing([(20, 0), (21, 0), (21, 1)])
    several = shapely.MultiLineString([line, shapely.LineString([(10, 5), (11, 6), (12, 5)])])
    high = shapely.LineString([(30, 0, 5), (31, 1, 6), (32, 0, 7)])
    mixed = shapely.GeometryCollection([shapely.LineString([(40, 0), (41, 1), (42, 0)])])
    parts = shapely.MultiPolygon([counties[0], shapely.box(50, 0, 51, 1)])
    given = [line, None, ring, shapely.Point(1, 2), several, high, mixed, parts, shapely.Polygon()]
    fine = batten.smooth(given, levels=2)
    assert [None if g is None else g.geom_type for g in fine] == [None if g is None else g.geom_type for g in given]
    assert fine[1] is None and fine[3] == given[3] and fine[8].is_empty
    assert fine[5].has_z and len(fine[5].coords) == 9
    for i in (0, 4, 5, 6):
        assert all(shapely.Point(c).distance(fine[i]) < 1e-9 for c in shapely.get_coordinates(given[i]))
    alone = batten.smooth(line, levels=2)
    assert alone.geom_type == "LineString" and len(alone.coords) == 9


def test_a_table_keeps_index_columns_and_crs(counties, tmp_path):
    geopandas = pytest.importorskip("geopandas")
    table = geopandas.GeoDataFrame({"name": list("abcdefghij")}, geometry=counties, crs="EPSG:25833", index=range(5, 15))
    table.to_file(tmp_path / "in.gpkg")
    fine = batten.smooth(geopandas.read_file(tmp_path / "in.gpkg"))
    fine.to_file(tmp_path / "out.gpkg")
    again = geopandas.read_file(tmp_path / "out.gpkg")
    assert again.crs == table.crs and list(again.name) == list(table.name)
    series = batten.smooth(table.geometry)
    assert list(series.index) == list(table.index) and series.crs == table.crs
    assert again.geometry.geom_equals_exact(series.reset_index(drop=True), 0).all()


def test_the_sphere_for_degrees():
    geopandas = pytest.importorskip("geopandas")
    tracks = geopandas.GeoSeries([shapely.LineString([(0, 60), (60, 60)])], crs="EPSG:4326")
    assert shapely.get_coordinates(batten.smooth(tracks, levels=1, edges="geodesic"))[1, 1] > 60  # along the great circle
    assert shapely.get_coordinates(batten.smooth(tracks, levels=1, space="plane"))[1, 1] == 60


@pytest.mark.skipif(not COUNTRIES.exists(), reason="no shared data")
@pytest.mark.filterwarnings("ignore::batten.BattenWarning")
def test_countries_are_those_of_the_program(tmp_path):
    geopandas = pytest.importorskip("geopandas")
    program = Path(__file__).parents[2] / "build/release/batten"
    if not program.exists():
        pytest.skip("the program is not built")
    subprocess.run([program, "curve", COUNTRIES, "-o", tmp_path / "out.geojson", "--levels", "2", "--quiet"], check=True)
    fine = batten.smooth(geopandas.read_file(COUNTRIES), levels=2)
    expected = geopandas.read_file(tmp_path / "out.geojson")
    assert shapely.equals_exact(np.array(fine.geometry), np.array(expected.geometry), 0).all()
    assert fine.is_valid.all()


def test_antimeridian():
    geopandas = pytest.importorskip("geopandas")
    fiji = geopandas.GeoSeries([shapely.MultiPolygon([shapely.box(178, -18, 180, -16), shapely.box(-180, -18, -178, -16)])], crs=4326)
    with pytest.warns(batten.BattenWarning, match="joined"):
        fine = batten.smooth(fiji, levels=2)
    assert fine[0].geom_type == "MultiPolygon" and fine.is_valid.all() and len(fine[0].geoms) == 2


def test_bad_parts_do_not_spoil_a_map():
    touching = shapely.Polygon([(1.888888888888889, 3.777777777777778), (1.6666666666666667, 3.8333333333333335), (3.25, 4.625),
                                (4.2, 3.2), (1.9230769230769231, 3.7692307692307696), (2, 4)])  # fmt: skip
    neighbour, details = shapely.Polygon([(4.2, 3.2), (3.25, 4.625), (5, 6), (6, 5), (6, 4)]), batten.Report()
    with pytest.warns(batten.BattenWarning, match="1 pairs of given edges cross or touch"):
        fine = batten.smooth([touching, neighbour], levels=2, details=details)
    assert details.given_crossing == 1 and shapely.is_valid(fine).all() and bool(shapely.coverage_is_valid(fine))
    assert len(fine[0].exterior.coords) == 10 and len(fine[1].exterior.coords) == 21
    parts = shapely.from_wkt("MULTIPOLYGON (EMPTY, ((0 0, 4 0, 4 4, 0 4, 0 0)))")
    with pytest.warns(batten.BattenWarning, match="dropped 1 line or ring with too few different points"):
        assert batten.smooth(parts, levels=1).geoms[0].equals(batten.smooth(parts.geoms[1], levels=1))


def test_messages_number_the_given_geometries():
    first = [shapely.Point(0, 0), None, shapely.Polygon(), shapely.box(0, 0, 1, 1)]
    for bad, space, error, text in [
            (shapely.box(0, 80, 1, 100), "sphere", batten.BadFile, "geometry 4, ring 0, position 1: a latitude"),
            (shapely.LineString([(0, 0), (np.inf, 1)]), "plane", ValueError, "geometry 4: coordinates that are finite"),
            (shapely.LineString([(5, 0), (1e300, 0), (1e308, 1e308)]), "plane", batten.InvalidPoint, "geometry 4: the open curve")]:  # fmt: skip
        with pytest.raises(error, match=text) as caught:
            batten.smooth([*first, bad], space=space)
        assert getattr(caught.value, "curve", None) in (None, 4)
    rings = shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 2, 2))
    with pytest.raises(batten.CutLocus, match="geometry 2: point 1 is antipodal") as caught:
        batten.smooth([first[0], rings, shapely.LineString([(10, 0), (190, 0), (10, 1)])], space="sphere", edges="geodesic")
    assert caught.value.curve == 2
    with pytest.warns(batten.BattenWarning, match="the first in geometry 4") as told:
        batten.smooth([*first, shapely.LineString([(7, 7), (7, 7)])], levels=1)
    assert not any("feature" in str(note.message) for note in told)
