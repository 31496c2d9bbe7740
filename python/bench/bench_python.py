"""Ratios of the Python package: over the C library, over the program, and over peers, measured in one run.

    PYTHONPATH=build/release/python-package python python/bench/bench_python.py [ROW…]

Peers that are not installed are left out. Each figure is the median of ratios of runs in turns.
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import batten
from batten._native import ffi, lib

ROOT = Path(__file__).parents[2]


def seconds(function, calls=1):
    begin = time.perf_counter()
    for _ in range(calls):
        function()
    return (time.perf_counter() - begin) / calls


def compare(first, second, rounds=5, calls=1):
    """Median seconds of both, and the median of second over first, by turns."""
    pairs = [(seconds(first, calls), seconds(second, calls)) for _ in range(rounds)]
    return (*(statistics.median(part) for part in zip(*pairs)), statistics.median(b / a for a, b in pairs))


def peer(name):
    try:
        return __import__(name, fromlist=["x"])
    except ImportError:
        print(f"  {name} is not installed")
        return None


def c_refine(points, levels, closed, scheme):
    """bat_curve_refine() alone, on structs that exist, and the release of its result."""
    space = ffi.new("bat_space *", lib.bat_euclidean(points.shape[1]))
    how = ffi.new("bat_curve_refine_options *", lib.bat_curve_refine_defaults())
    how.levels = levels
    error, fine = ffi.new("bat_error *"), ffi.new("bat_curve *")
    assert lib.bat_curve_scheme_by_name(scheme.encode(), ffi.addressof(how, "scheme"), error) == 0
    coarse = ffi.new("bat_curve *", [space, ffi.from_buffer("double[]", points), len(points), closed])

    def run(keep=(space, points)):
        assert keep and lib.bat_curve_refine(coarse, how, fine, error) == 0
        lib.bat_curve_free(fine)

    return run


def small():
    angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    points = np.stack([2 * np.cos(angles), np.sin(angles)], axis=1)
    for scheme in ("learned", "four-point"):
        run = c_refine(points, 4, True, scheme)
        pairs = [(seconds(run, 40), seconds(lambda: batten.refine(points, closed=True, levels=4, scheme=scheme), 40)) for _ in range(40)]
        c, python = (min(part) for part in zip(*pairs))  # the least disturbed runs: the difference is small
        print(f"  12 points by 4 levels, {scheme}: {1e6 * (python - c):.1f} microseconds above {1e6 * c:.1f} of the C call (floor 10)")


def large():
    random = np.random.default_rng(1)
    points = np.cumsum(random.normal(size=(10**6, 2)), axis=0)
    for scheme in ("four-point", "learned"):
        run = c_refine(points, 2, False, scheme)
        _, _, ratio = compare(run, lambda: batten.refine(points, levels=2, scheme=scheme), 5)
        print(f"  a million points by 2 levels, {scheme}: {ratio:.3f} of the C call (floor 1.05)")


def lines():
    count, size = 10**6, 10
    points = np.cumsum(np.random.default_rng(1).normal(size=(count, size, 2)), axis=1).reshape(-1, 2)
    offsets = np.arange(0, count * size + 1, size)
    space = ffi.new("bat_space *", lib.bat_euclidean(2))
    how = ffi.new("bat_curve_refine_options *", lib.bat_curve_refine_defaults())
    how.levels = 2
    error, buffer = ffi.new("bat_error *"), ffi.from_buffer("double[]", points)
    coarse, fine = ffi.new("bat_curve[]", count), ffi.new("bat_curve[]", count)
    for i in range(count):
        curve = coarse[i]
        curve.space, curve.points, curve.count = space, buffer + 2 * size * i, size
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        assert lib.bat_curves_refine(coarse, count, how, fine, error) == 0
        times.append(time.perf_counter() - begin)
        for i in range(count):
            lib.bat_curve_free(fine + i)
        begin = time.perf_counter()
        batten.refine(points, offsets, levels=2)
        times.append(time.perf_counter() - begin)
    ratio = statistics.median(b / a for a, b in zip(times[::2], times[1::2]))
    print(f"  a million lines of 10 points by 2 levels: {ratio:.3f} of the C call, offsets and points included (floor 1.05)")


def maps():
    import warnings

    import geopandas

    warnings.simplefilter("ignore", batten.BattenWarning)
    source = ROOT / "shared/data/maps/countries-110m.geojson"
    if not source.exists():
        source = ROOT.parent / "shared/data/maps/countries-110m.geojson"
    table, program = geopandas.read_file(source), ROOT / "build/release/batten"
    with tempfile.TemporaryDirectory() as folder:
        run = [program, "curve", source, "-o", Path(folder) / "out.geojson", "--quiet"]
        _, _, ratio = compare(lambda: subprocess.run(run, check=True), lambda: batten.smooth(table), 9)
    print(f"  polygons of countries, smoothed as a map: {ratio:.2f} of the program on the file (floor 1.5)")


def grid(side):
    """A wavy sheet of 2 side^2 triangles."""
    x, y = np.meshgrid(np.linspace(0, 1, side + 1), np.linspace(0, 1, side + 1))
    vertices = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)], axis=-1).reshape(-1, 3)
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    faces = np.concatenate([np.stack([first, first + 1, first + side + 2], axis=1),
                            np.stack([first, first + side + 2, first + side + 1], axis=1)])  # fmt: skip
    return vertices, faces.astype(np.int64)


def loop():
    vertices, faces = grid(224)
    ours = lambda: batten.refine_mesh(vertices, faces, scheme="loop", levels=2)  # noqa: E731
    runs = {}
    if trimesh := peer("trimesh"):
        runs["trimesh", 50] = lambda: trimesh.remesh.subdivide_loop(vertices, faces, iterations=2)
    if igl := peer("igl"):
        runs["igl", 10] = lambda: igl.loop(vertices, faces, 2)
    if pymeshlab := peer("pymeshlab"):
        def run_meshlab():
            meshes = pymeshlab.MeshSet()
            meshes.add_mesh(pymeshlab.Mesh(vertices, faces))
            meshes.meshing_surface_subdivision_loop(iterations=2, threshold=pymeshlab.PercentageValue(0))
            meshes.current_mesh().vertex_matrix()
        runs["pymeshlab", 10] = run_meshlab
    for (name, floor), run in runs.items():
        _, _, ratio = compare(ours, run, 3)
        print(f"  Loop, {len(faces)} faces by 2 levels: {ratio:.1f} times as fast as {name} (floor {floor})")


def decimation():
    vertices, faces = grid(316)
    target = len(faces) // 100
    peers = {}
    if simplification := peer("fast_simplification"):
        peers["fast-simplification"] = lambda: simplification.simplify(vertices, faces, target_count=target)
    if pymeshlab := peer("pymeshlab"):
        def run_meshlab():
            meshes = pymeshlab.MeshSet()
            meshes.add_mesh(pymeshlab.Mesh(vertices, faces))
            meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=target)
            return meshes.current_mesh().vertex_matrix(), meshes.current_mesh().face_matrix()
        peers["pymeshlab"] = run_meshlab
    for name, run in peers.items():
        theirs = run()
        for method in ("fast", "balanced"):
            ours = lambda: batten.decimate(vertices, faces, faces=target, method=method, map=False)  # noqa: B023, E731
            _, _, ratio = compare(ours, run, 5)
            distances = [batten.measure((vertices, faces), mesh).mean for mesh in (ours().mesh, (theirs[0], theirs[1]))]
            print(f"  decimation of {len(faces)} faces to {len(ours().mesh.faces)} ({len(theirs[1])}), {method}: {ratio:.2f} times as fast as "
                  f"{name} (floor 1), {distances[0] / distances[1]:.2f} of its mean distance (floor 0.5)")  # fmt: skip


def rotations():
    from scipy.spatial.transform import Rotation, RotationSpline

    keys, at = np.linspace(0, 1, 10), np.linspace(0, 1, 100)
    turns = [Rotation.from_rotvec(np.cumsum(np.random.default_rng(i).normal(size=(10, 3)) / 3, axis=0)) for i in range(1000)]
    arrays = [turn.as_quat()[:, [3, 0, 1, 2]] for turn in turns]

    def ours():
        for array in arrays:
            batten.Motion(keys, array, space="rotation")(at)

    def theirs():
        for turn in turns:
            RotationSpline(keys, turn)(at)

    a, _, ratio = compare(ours, theirs, 3)
    print(f"  a thousand splines of 10 rotations at 100 times: {ratio:.1f} times as fast as scipy's (floor 20)")
    if peer("geomstats"):
        from geomstats.geometry.special_orthogonal import SpecialOrthogonal
        from geomstats.geometry.invariant_metric import BiInvariantMetric

        group = SpecialOrthogonal(n=3, point_type="vector")
        group.equip_with_metric(BiInvariantMetric)
        vectors = [turn.as_rotvec() for turn in turns[:10]]

        def geodesics():
            for rows in vectors:
                for p, q in zip(rows[:-1], rows[1:]):
                    group.metric.geodesic(initial_point=p, end_point=q)(np.linspace(0, 1, 11))

        print(f"    {100 * seconds(geodesics) / a:.0f} times as fast as the geodesics between keys by geomstats (floor 1000)")


def single():
    """Small calls beside scipy's: the least disturbed of many runs."""
    from scipy.interpolate import CubicSpline
    from scipy.spatial.transform import Rotation, RotationSpline

    angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    points = np.stack([2 * np.cos(angles), np.sin(angles)], axis=1)
    ring, keys, at = np.vstack([points, points[:1]]), np.arange(13.0), np.linspace(0, 12, 12 * 32 + 1)
    turns = Rotation.from_rotvec(np.cumsum(np.random.default_rng(1).normal(size=(10, 3)) / 3, axis=0))
    times = np.linspace(0, 1, 10)
    spline, motion = RotationSpline(times, turns), batten.Motion(times, turns)
    quaternions = batten.Motion(times, turns.as_quat()[:, [3, 0, 1, 2]], space="rotation")
    periodic = lambda: CubicSpline(keys, ring, bc_type="periodic")(at)  # noqa: E731
    for what, ours, theirs, floor in [
        ("12 points by 5 levels, default, over a periodic spline of scipy", lambda: batten.refine(points, closed=True), periodic, 5),
        ("the same, four-point", lambda: batten.refine(points, closed=True, scheme="four-point"), periodic, 5),
        ("one pose of a motion, as a quaternion, over scipy's", lambda: quaternions(0.5), lambda: spline(0.5), 10),
        ("the same, as a Rotation", lambda: motion(0.5), lambda: spline(0.5), 10),
    ]:
        pairs = [(seconds(ours, 40), seconds(theirs, 40)) for _ in range(40)]
        least = [min(part) for part in zip(*pairs)]
        print(f"  {what}: {least[1] / least[0]:.1f} times as fast, {1e6 * least[0]:.1f} microseconds (floor {floor})")


def start():
    """Processor time of imports, the least of ten processes, from bytecode, as pip installs it."""
    import compileall
    import os

    compileall.compile_dir(Path(batten.__file__).parent, quiet=1)

    def milliseconds(code):
        used = [os.wait4(subprocess.Popen([sys.executable, "-c", code]).pid, 0)[2] for _ in range(10)]
        return 1e3 * min(part.ru_utime + part.ru_stime for part in used)

    alone, both = milliseconds("import numpy"), milliseconds("import batten")
    print(f"  import batten: {both - alone:.0f} ms of processor time more than numpy's {alone:.0f} (floor 80)")


ROWS = [single, start, small, large, lines, maps, loop, decimation, rotations]

if __name__ == "__main__":
    for row in ROWS:
        if len(sys.argv) < 2 or row.__name__ in sys.argv[1:]:
            print(row.__name__, flush=True)
            row()
