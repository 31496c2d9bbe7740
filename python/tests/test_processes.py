"""Processes made by fork after a call with several threads, as multiprocessing and concurrent.futures make them on Linux."""

import concurrent.futures
import multiprocessing

import numpy as np
import pytest

import batten

SECONDS = 60

pytestmark = [
    pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="no fork"),
    pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning"),
]


def results(threads):
    """The bytes of a curve and of a mesh."""
    points = np.stack([np.arange(2000.0), np.sin(0.7 * np.arange(2000))], axis=1)
    cage = batten.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    coarse = batten.refine_mesh(cage, scheme="loop", levels=4, threads=threads)
    fine = batten.refine_mesh(coarse, levels=2, threads=threads)
    curve = batten.refine(points, levels=4, threads=threads)
    return np.asarray(curve).tobytes() + np.asarray(fine.vertices).tobytes()


def test_a_pool_of_processes():
    expected = results(4)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        calls = [pool.apply_async(results, (threads,)) for threads in (0, 1, 4)]
        assert all(call.get(timeout=SECONDS) == expected for call in calls)
    assert results(4) == expected


def test_an_executor_of_processes():
    expected = results(4)
    executor = concurrent.futures.ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("fork"))
    try:
        assert executor.submit(results, 4).result(timeout=SECONDS) == expected
    finally:
        for process in list(executor._processes.values()):
            process.kill()
        executor.shutdown(wait=False)
