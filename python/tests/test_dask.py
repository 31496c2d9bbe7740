"""Collections of Dask give what one machine gives, byte for byte; also with workers that die."""

import os
import signal
import time

import numpy as np
import pytest

import batten
import batten.dask

pytest.importorskip("dask")
pytestmark = pytest.mark.cluster

import dask
import dask.bag
import dask.dataframe


def mosaic(columns, rows):
    """Polygons that share wavy borders, with an island and a line: a map of columns x rows features and two more."""
    import geopandas
    import shapely

    def corner(i, j):
        return np.array([i + 0.2 * np.sin(5 * j + i), j + 0.2 * np.cos(3 * i - j)])

    def side(a, b):
        """Points from a to b without b, the same for both directions."""
        swap = tuple(a) > tuple(b)
        p, q = (b, a) if swap else (a, b)
        t = np.array([0, 0.25, 0.5, 0.75])[:, None] if not swap else np.array([1, 0.75, 0.5, 0.25])[:, None]
        normal = np.array([p[1] - q[1], q[0] - p[0]])
        return p + t * (q - p) + 0.12 * np.sin(2 * np.pi * t) * normal

    shapes = []
    for j in range(rows):
        for i in range(columns):
            ring = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]
            shapes.append(shapely.Polygon(np.concatenate([side(a, b) for a, b in zip(ring, ring[1:] + ring[:1])])))
    shapes += [shapely.Point(0.5, 0.5), shapely.LineString([[-1, -1], [-0.8, 1], [-1, 2], [-0.7, 3]])]
    return geopandas.GeoDataFrame({"name": [f"n{i}" for i in range(len(shapes))]}, geometry=shapes, crs="EPSG:4326")


def same(a, b):
    import shapely

    return a.index.equals(b.index) and (shapely.to_wkb(a.geometry.to_numpy()) == shapely.to_wkb(b.geometry.to_numpy())).all()


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed")
    with dask.config.set({"distributed.comm.timeouts.connect": "120s", "distributed.worker.daemon": True}):
        with distributed.LocalCluster(n_workers=4, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as made:
                yield made


@pytest.mark.parametrize("system", ["EPSG:4326", "EPSG:3857"])
@pytest.mark.parametrize("partitions", [2, 5])
def test_maps_by_tiles(system, partitions):
    dask_geopandas = pytest.importorskip("dask_geopandas")
    world = mosaic(6, 5).set_crs(system, allow_override=True)
    whole = batten.smooth(world, levels=3)
    given = dask_geopandas.from_geopandas(world, npartitions=partitions)
    lazy = batten.dask.smooth(given, levels=3)
    assert type(lazy) is dask_geopandas.GeoDataFrame and lazy.npartitions == partitions and list(lazy.columns) == list(world.columns)
    assert lazy.crs == world.crs and list(lazy.dtypes) == list(given.dtypes)
    made = lazy.compute(scheduler="sync")
    assert same(made, whole) and made.crs == world.crs and (made.name == world.name).all()
    series = batten.dask.smooth(dask_geopandas.from_geopandas(world, npartitions=partitions).geometry, levels=3)
    assert same(series.compute(scheduler="sync"), whole.geometry)


def test_maps_without_topology():
    dask_geopandas = pytest.importorskip("dask_geopandas")
    world = mosaic(4, 4)
    lazy = batten.dask.smooth(dask_geopandas.from_geopandas(world, npartitions=3), levels=2, topology="separate")
    assert same(lazy.compute(scheduler="sync"), batten.smooth(world, levels=2, topology="separate"))
    with pytest.raises(batten.Unsupported, match="keep_area"):
        batten.dask.smooth(dask_geopandas.from_geopandas(world, npartitions=3), keep_area=True)


def test_lines_that_would_cross_agree_or_are_refused():
    """Spikes over a line, which are drawn back: the result is that of one machine, or an error that names the way out."""
    import geopandas
    import shapely

    dask_geopandas = pytest.importorskip("dask_geopandas")
    spike = shapely.LineString([(0, 0), (1, 0), (2, 1), (3, 0), (4, 0)])
    floor = shapely.LineString([(0, -0.01), (4, -0.01)])
    lines = [shapely.affinity.translate(line, 5.0 * k, 0) for k in range(16) for line in (spike, floor)]
    world = geopandas.GeoDataFrame(geometry=lines, crs="EPSG:3857")
    done = batten.Report()
    whole = batten.smooth(world, levels=3, details=done)
    assert done.drawn_back > 0
    parts = dask_geopandas.from_geopandas(world, npartitions=8)
    assert same(batten.dask.smooth(parts, levels=3, rings=20).compute(scheduler="sync"), whole)
    with pytest.raises(batten.Unsupported, match="larger 'rings'"):
        batten.dask.smooth(parts, levels=3, rings=2).compute(scheduler="sync")


def test_bags(circle, sphere_mesh):
    curves = [circle * (1 + i) for i in range(7)]
    made = batten.dask.refine(dask.bag.from_sequence(curves, npartitions=3), closed=True, levels=3).compute(scheduler="sync")
    assert [curve.tobytes() for curve in made] == [batten.refine(curve, closed=True, levels=3).tobytes() for curve in curves]
    meshes = dask.bag.from_sequence([sphere_mesh] * 3, npartitions=2)
    expected, _ = batten.decimate(sphere_mesh, vertices=100)
    for coarse, _ in batten.dask.decimate(meshes, vertices=100).compute(scheduler="sync"):
        assert coarse.vertices.tobytes() == expected.vertices.tobytes()
    for fine in batten.dask.refine_mesh(meshes, scheme="loop", levels=1).compute(scheduler="sync"):
        assert fine.vertices.tobytes() == batten.refine_mesh(sphere_mesh, scheme="loop", levels=1).vertices.tobytes()
    times = np.arange(12.0)
    motion, = batten.dask.motions(dask.bag.from_sequence([(times, circle)])).compute(scheduler="sync")
    assert motion(2.5).tobytes() == batten.Motion(times, circle)(2.5).tobytes()


def test_dataframes_of_keyframes(circle):
    import pandas as pd

    frame = pd.DataFrame({"car": np.repeat(["a", "b", "c"], 12), "t": np.tile(np.arange(12.0), 3), "x": np.tile(circle[:, 0], 3),
                          "y": np.repeat([1, 2, 3], 12) * np.tile(circle[:, 1], 3)})  # fmt: skip
    parts = dask.dataframe.from_pandas(frame, npartitions=2).shuffle("car", npartitions=2)
    lazy = batten.dask.motions(parts, by="car", time="t", poses=["x", "y"], rate=4)
    assert list(lazy.columns) == ["car", "t", "x", "y"]
    made = lazy.compute(scheduler="sync")
    assert (made.dtypes == lazy.dtypes).all() and len(made) == 3 * 45
    b = made[made.car == "b"]
    assert b[["x", "y"]].to_numpy().tobytes() == batten.Motion(np.arange(12.0), circle * [1, 2])(b.t.to_numpy()).tobytes()


def test_four_processes_one_of_which_dies(client):
    """A worker that is killed in the middle of the work loses nothing."""
    dask_geopandas = pytest.importorskip("dask_geopandas")
    world = mosaic(12, 8)
    whole = batten.smooth(world, levels=5)
    pids = list(client.run(os.getpid).values())
    assert len(set(pids)) == 4 and os.getpid() not in pids
    future = client.compute(batten.dask.smooth(dask_geopandas.from_geopandas(world, npartitions=12), levels=5))
    begin = time.monotonic()
    while time.monotonic() - begin < 60 and not any(client.processing().values()):
        time.sleep(0.01)
    os.kill(pids[1], signal.SIGKILL)
    assert same(future.result(timeout=240), whole)
