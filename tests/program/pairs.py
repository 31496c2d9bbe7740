"""Runs every verb with every pair of its options, on small input. The options come from `batten VERB --help all`.

    pairs.py BATTEN EXAMPLES [--seconds S] [--seed N] [--jobs N] [VERB...]

A run must end with 0, or with 1 or 2 and a line of batten; a sanitizer's report, a signal and 20 seconds are failures. Under
Clang's sanitizers this finds what no single option reaches. After S seconds it stops; pairs come in an order of the seed.
"""

import argparse
import concurrent.futures
import itertools
import os
import random
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

VERBS = ["curve", "motion", "mesh", "decimate", "surface", "measure", "analyze", "shape"]

#: Options that are not of one run, or that sanitizers, which map terabytes, do not allow.
EXCLUDED = {"output", "jobs", "in-place", "help", "max-memory"}

#: Values of options, by the name of the option and then by what stands for its value.
VALUES = {
    "scheme": {"curve": ["angle-6", "four-point", "chaikin", "cubic", "log-exp-4"], "motion": ["spline", "hermite"],
               "mesh": ["loop", "catmull-clark", "learned", "sqrt3"]},
    "space": ["plane", "sphere"], "columns": ["x,y"], "group": ["x"], "from": ["csv", "obj", "xyz"], "euler": ["zyx,degrees"],
    "time-unit": ["seconds"], "key-times": ["times.txt"], "times": ["times.txt"], "ends": ["extrapolate", "natural"],
    "simple": ["always", "never"], "topology": ["shared", "separate"], "edges": ["geodesic"], "join": ["no"],
    "crs": ["EPSG:3857"], "projection": ["both"], "layer": ["a"], "on": ["sphere"], "to": ["csv", "ply", "json", "vtk"],
    "tangents": ["4", "smooth"], "outliers": ["tukey"], "boundary": {"mesh": ["corners", "none"], "surface": ["8", "in.csv"]},
    "creasing": ["chaikin"], "texture": ["corners"], "then": ["butterfly"], "beside": ["loop"], "method": ["quadric", "fast"],
    "smoothing": ["1e-3"], "parameterization": ["learned", "uniform", "stretch-minimizing"], "corners": ["0,1,2,3"],
    "sides": ["uniform"], "unit": ["mm"], "degree": ["2,3"], "truth": ["in.csv"], "title": ["a"], "units": ["m,s"],
    "panel": ["0,1"], "sigma": ["0.1", "auto"], "levels": ["0", "2"], "threads": ["2"], "samples": ["50"],
    "functions": ["30"], "iterations": ["2"],
    "tolerance": {"curve": ["0.05", "1e-3"], "mesh": ["0.05"], "decimate": ["0.05", "1e-3"], "surface": ["0.05", "1e-3"]},
    "max-edge": ["0.3"], "smooth": ["0.3", "auto"],
    "max-seconds": ["15"], "max-points": ["3", "1000"], "rate": ["7"], "period": ["9"], "ratio": ["0.5"],
    "fill-holes": ["1"], "picture": ["out.svg", "out.png"], "map": ["out.map"], "parameters": ["out.uv"], "model": ["in.csv"],
    "sweep": ["w=0:0.1"], "vertices": ["20"], "faces": ["9"], "sample": ["5"], "depth": ["3"], "precision": ["3"],
}  # fmt: skip

#: Values of what stands for them, for all other options.
KINDS = {"FILE": ["out.x"], "NAME": ["auto"], "RULE": ["auto"], "TEXT": ["a"], None: [None]}
NUMBERS = ["2", "0.3"]

INPUTS = {
    "curve": (["in.csv", "map.geojson"], "out.csv"), "motion": (["keys.csv"], "out.csv"), "mesh": (["in.obj", "quads.obj"], "out.ply"),
    "decimate": (["in.obj"], "out.obj"), "surface": (["cloud.xyz"], "out.json"), "measure": (["in.csv", "in.obj"], None),
    "analyze": (["four-point"], None), "shape": (["cage"], "out.obj"),
}  # fmt: skip


def options_of(batten, verb):
    """Names and placeholders of the options of a verb."""
    shown = subprocess.run([batten, verb, "--help", "all"], capture_output=True, text=True, check=True).stdout
    found = dict(re.findall(r"^ +(?:-o, )?--([a-z-]+) ?(\S+)?(?:  |$)", shown, re.M))
    return {name: kind or None for name, kind in found.items() if name not in EXCLUDED}


def values_of(verb, name, kind):
    values = VALUES.get(name, KINDS.get(kind, NUMBERS))
    return values.get(verb, NUMBERS) if isinstance(values, dict) else values


def pairs_of(batten, verb, draw):
    """Command lines of one verb: every pair of options, each time with one of their values."""
    options = options_of(batten, verb)
    inputs, output = INPUTS[verb]
    for first, second in itertools.combinations(options, 2):
        words = [verb, draw.choice(inputs)]
        for name in (first, second):
            value = draw.choice(values_of(verb, name, options[name]))
            words += [f"--{name}"] if value is None else [f"--{name}", value]
        if output is not None:
            words += ["-o", output]
        # Refinement and decimation are quick, and have a target.
        if verb == "decimate" and not {first, second} & {"vertices", "faces", "ratio", "tolerance"}:
            words += ["--vertices", "20"]
        yield words


def prepare(batten, examples, folder):
    (folder / "in.csv").write_text("x,y\n0,0\n1,0\n1.5,1\n0.2,1.4\n-0.5,0.5\n")
    (folder / "times.txt").write_text("0.5\n1\n")
    (folder / "keys.csv").write_bytes((examples / "camera-keyframes.csv").read_bytes())
    (folder / "map.geojson").write_text(
        '{"type":"FeatureCollection","features":['
        '{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[0,0],[9,0],[9,9],[4,12],[0,9],[0,0]]]}},'
        '{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[9,0],[18,1],[16,9],[9,9],[9,0]]]}}]}'
    )
    (folder / "quads.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 1\nv 0 1 0\nv 1 1 1\nv 2 1 0\nf 1 2 5 4\nf 2 3 6 5\n")
    draw = random.Random(1)
    (folder / "cloud.xyz").write_text("".join(f"{x / 7} {y / 7} {0.1 * x * y / 49 + 0.001 * draw.random()}\n" for x in range(8) for y in range(8)))
    subprocess.run([batten, "shape", "cage", "-o", folder / "in.obj"], check=True, capture_output=True)


def run(batten, folder, words):
    """None, or what is wrong."""
    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=1:exitcode=99", "UBSAN_OPTIONS": "print_stacktrace=1:exitcode=99",
                   "LSAN_OPTIONS": f"suppressions={Path(__file__).resolve().parents[1] / 'lsan.supp'}"}  # fmt: skip
    with tempfile.TemporaryDirectory(dir=folder) as own:
        for file in folder.iterdir():
            if file.is_file():
                os.link(file, Path(own) / file.name)
        try:
            done = subprocess.run([batten, *words], cwd=own, env=environment, capture_output=True, timeout=20)
        except subprocess.TimeoutExpired:
            return "it does not end in 20 seconds"
        left = [name for name in os.listdir(own) if name.startswith(".batten-")]
    errors = done.stderr.decode(errors="replace")
    if done.returncode not in (0, 1, 2) or "Sanitizer" in errors or "runtime error" in errors:
        return f"exit code {done.returncode}: {errors[:1500]}"
    if done.returncode != 0 and "batten: " not in errors:
        return f"exit code {done.returncode} without a message"
    return f"hidden files are left: {left}" if left else None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("batten", type=lambda path: str(Path(path).resolve()))
    parser.add_argument("examples", type=Path)
    parser.add_argument("verbs", nargs="*", default=VERBS)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    given = parser.parse_args()
    draw = random.Random(given.seed)
    end = time.monotonic() + given.seconds
    with tempfile.TemporaryDirectory() as name, concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        folder = Path(name)
        prepare(given.batten, given.examples, folder)
        lines = [words for verb in given.verbs for words in pairs_of(given.batten, verb, draw)]
        draw.shuffle(lines)
        finish = lambda words: (words, run(given.batten, folder, words)) if time.monotonic() < end else (words, "late")
        results = list(pool.map(finish, lines))
    late = sum(fault == "late" for _, fault in results)
    faults = [(words, fault) for words, fault in results if fault not in (None, "late")]
    for words, fault in faults:
        print(f"FAILED: batten {' '.join(words)}\n    {fault}")
    print(f"{len(results) - late} of {len(results)} pairs run, {len(faults)} failures")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
