"""Kill workers of Dask at random moments of a map's refinement, and compare bytes with one call.

    PYTHONPATH=build/release/python-package:python/tests python python/tests/dask_kills.py [KILLS [SEED]]

Four workers refine a map again and again, each time with a kill (SIGKILL) of a random worker at a random moment, until KILLS
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
    with distributed.LocalCluster(n_workers=4, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:

        def start():
            client.wait_for_workers(4)
            parts = dask_geopandas.from_geopandas(world, npartitions=12)
            return client.compute(batten.dask.smooth(parts, levels=5))

        begin = time.monotonic()
        assert same(start().result(timeout=600), whole)
        seconds = time.monotonic() - begin
        while killed < kills:
            client.restart(timeout=120)
            client.wait_for_workers(4)
            pids = list(client.run(os.getpid).values())
            future = start()
            time.sleep(draw.uniform(0, 0.8 * seconds))
            if future.done():
                continue
            os.kill(draw.choice(pids), signal.SIGKILL)
            killed, runs = killed + 1, runs + 1
            if not same(future.result(timeout=600), whole):
                sys.exit(f"other bytes after {killed} kills")
    print(f"{killed} kills of 4 workers in {runs} refinements, the same bytes")


if __name__ == "__main__":
    main()
