"""Kill workers of Dask at random moments of a map's refinement, and compare bytes with one call.

    PYTHONPATH=build/release/python-package:python/tests python python/tests/dask_kills.py [KILLS [SEED]]

Four new workers refine a map, again and again, each time with a kill (SIGKILL) of a random worker at a random moment, until KILLS
(default 20) have hit running work. Prints the number of kills.
"""

import os
import random
import signal
import sys
import time

import dask
import dask_geopandas
import distributed
from test_dask import mosaic, same

import batten
import batten.dask


def main():
    kills, seed = (int(word) for word in [*sys.argv[1:3], *("20", "1")[len(sys.argv) - 1 :]])
    draw, killed, runs = random.Random(seed), 0, 0
    world = mosaic(12, 8)
    whole = batten.smooth(world, levels=5)
    dask.config.set({"distributed.comm.timeouts.connect": "120s", "distributed.scheduler.allowed-failures": 20})
    seconds = None
    while killed < kills:
        with distributed.LocalCluster(n_workers=4, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
            pids = list(client.run(os.getpid).values())
            client.run(lambda: __import__("batten.dask") and __import__("dask_geopandas") and None)
            begin = time.monotonic()
            future = client.compute(batten.dask.smooth(dask_geopandas.from_geopandas(world, npartitions=12), levels=5))
            if seconds is not None:
                time.sleep(draw.uniform(0, 0.8 * seconds))
                if not future.done():
                    os.kill(draw.choice(pids), signal.SIGKILL)
                    killed += 1
            if not same(future.result(timeout=600), whole):
                sys.exit(f"other bytes after {killed} kills")
            runs += 1
            seconds = seconds or time.monotonic() - begin
    print(f"{killed} kills of 4 workers in {runs} refinements, the same bytes")


if __name__ == "__main__":
    main()
