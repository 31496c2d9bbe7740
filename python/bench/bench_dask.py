"""A map of 100,000 features through Dask with two workers, and through the program with two threads.

    PYTHONPATH=build/release/python-package python python/bench/bench_dask.py build/release/batten [COLUMNS [LEVELS [ROUNDS]]]

Both read files and write files in the format that is their own: GeoParquet and GeoJSON. The map is a mosaic of polygons that
share borders, of which less than one in a hundred is drawn back. The worker processes exist before time is taken. Prints the speed of Dask over that of the program.
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import geopandas
import numpy as np
import shapely

import batten.dask

RINGS = 5  # some lines are drawn back, and then others beside them


def mosaic(columns):
    """columns x columns polygons of 16 points, of which each side is its neighbour's."""
    random = np.random.default_rng(1)
    n = columns + 1
    corner = np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=2) + random.uniform(-0.2, 0.2, (n, n, 2))
    inner = np.array([0.25, 0.5, 0.75])[:, None]

    def sides(a, b):
        normal = np.stack([a[..., 1] - b[..., 1], b[..., 0] - a[..., 0]], axis=-1)
        bulge = random.uniform(-0.1, 0.1, (*a.shape[:2], 3, 1))
        return a[:, :, None] + inner * (b - a)[:, :, None] + bulge * normal[:, :, None]

    across, up = sides(corner[:, :-1], corner[:, 1:]), sides(corner[:-1], corner[1:])
    rings = np.concatenate([
        corner[:-1, :-1, None], across[:-1], corner[:-1, 1:, None], up[:, 1:],
        corner[1:, 1:, None], across[1:, :, ::-1], corner[1:, :-1, None], up[:, :-1, ::-1]], axis=2)  # fmt: skip
    degrees = rings.reshape(-1, 16, 2) * (60 / columns)
    return geopandas.GeoDataFrame(geometry=shapely.polygons(degrees), crs="EPSG:4326")


def tiles(frame, columns, across):
    """The features in the order of tiles, of which there are across x across."""
    row, column = np.divmod(np.arange(len(frame)), columns)
    tile = row * across // columns * across + column * across // columns
    return frame.iloc[np.argsort(tile, kind="stable")].reset_index(drop=True)


def main():
    import dask_geopandas
    import distributed

    program, columns, levels, rounds = sys.argv[1], *map(int, [*sys.argv[2:5], *("317", "3", "3")[len(sys.argv) - 2 :]])
    across = 4
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        given = tiles(mosaic(columns), columns, across)
        given.to_file(folder / "map.geojson", engine="pyogrio", driver="GeoJSON")
        dask_geopandas.from_geopandas(given, npartitions=across * across).to_parquet(folder / "map")
        print(f"{len(given)} features, {across * across} partitions")
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
            client.run(lambda: __import__("batten.dask") and __import__("dask_geopandas") and None)
            for topology in ("separate", "features"):
                ratios = []
                for _ in range(rounds):
                    begin = time.perf_counter()
                    command = [program, "curve", folder / "map.geojson", "-o", folder / "out.geojson", "--levels", str(levels), "--threads", "2", "--quiet"]
                    subprocess.run([*command, *(["--topology", "separate"] if topology == "separate" else [])], check=True)
                    middle = time.perf_counter()
                    lazy = batten.dask.smooth(dask_geopandas.read_parquet(folder / "map"), levels=levels, topology=topology, rings=RINGS)
                    lazy.to_parquet(folder / "out")
                    end = time.perf_counter()
                    ratios.append((middle - begin) / (end - middle))
                    print(f"  {topology}: program {middle - begin:.1f} s, Dask {end - middle:.1f} s", flush=True)
                print(f"{topology}: Dask over the program, median of {len(ratios)}: {statistics.median(ratios):.2f}", flush=True)


if __name__ == "__main__":
    main()
