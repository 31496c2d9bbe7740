#!/usr/bin/env python3
"""Compare `batten curve --smooth auto` with other smoothers on noisy tracks whose truth is known.

    scripts/curve-smoothing-peers.py BATTEN [TRACKS] [--mapshaper PROGRAM] [--curves FOLDER] [--first-seed S]

Needs numpy and scipy. Without --mapshaper its column is left out. With --curves the truths are also those of the files
*-truth.csv of a folder, one family each. Tracks are drawn at random; their mean spacing is 1 and the standard deviation of
the noise 0.05 to 1. A figure is the mean distance between result and truth, both ways, in units of the noise, averaged over
the tracks. Peers with a width are given the best of several, by the mean of the family.
"""
import argparse
import csv
import glob
import json
import os
import subprocess
import sys
import tempfile

import numpy
from scipy.interpolate import make_smoothing_spline
from scipy.spatial import cKDTree

PER_EDGE = 20  # points of a truth for each point of its track
WIDTHS = (1, 2, 4, 8, 16)  # of peers, in spacings


def lengths_along(points):
    return numpy.r_[0, numpy.cumsum(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1))]


def along(points, at):
    lengths = lengths_along(points)
    keep = numpy.r_[True, numpy.diff(lengths) > 0]
    return numpy.stack([numpy.interp(at, lengths[keep], column[keep]) for column in points.T], axis=1)


def dense(points, count=6000):
    return along(points, numpy.linspace(0, lengths_along(points)[-1], count))


def distance(a, b):
    a, b = dense(a), dense(b)
    return (cKDTree(a).query(b)[0].mean() + cKDTree(b).query(a)[0].mean()) / 2


# Truths: points, and the indices of those that are measured


def road(random, count):
    """Turns of random sharpness with straight runs between them, evenly sampled."""
    x = numpy.arange(count * PER_EDGE)
    bends = numpy.zeros(len(x))
    for _ in range(max(3, count // 15)):
        width = random.uniform(2.5, 10) * PER_EDGE
        bump = numpy.exp(-0.5 * ((x - random.uniform(0, len(x))) / width) ** 2)
        bends += random.normal() * 0.9 * bump / width * random.uniform(0.5, 1.6)
    heading = numpy.cumsum(bends) + random.uniform(0, 6.3)
    points = numpy.cumsum(numpy.c_[numpy.cos(heading), numpy.sin(heading)], axis=0) / PER_EDGE
    return points, numpy.arange(0, len(x), PER_EDGE)


def loops(random, count):
    """Lissajous curves that cross themselves, evenly sampled."""
    t = numpy.linspace(0, 1, count * PER_EDGE)
    waves = random.integers(1, 4, 2) * numpy.pi * random.uniform(0.7, 1.3, 2) * random.integers(2, 5) / 2
    phases = random.uniform(0, 6.3, 2)
    points = numpy.sin(waves * t[:, None] + phases) + numpy.c_[t, -t] * random.uniform(0, 2)
    lengths = lengths_along(points)
    index = numpy.searchsorted(lengths, numpy.linspace(0, lengths[-1] * 0.9999, count))
    return points * count / lengths[-1], index


def walk(random, count):
    """A road sampled evenly in time, at a speed that varies by factors up to ten."""
    points, _ = road(random, count)
    t = numpy.linspace(0, 1, count)
    waves = [0.7 * random.normal() * numpy.sin(2 * numpy.pi * (k + 1) * t + random.uniform(0, 6.3)) for k in range(4)]
    passed = numpy.r_[0, numpy.cumsum(numpy.exp(sum(waves)))][:-1]
    return points, (passed / passed[-1] * (len(points) - 1)).astype(int)


def file_truths(folder):
    """A family for each file of truths: a random part of a random curve, evenly sampled."""
    families = {}
    for path in sorted(glob.glob(os.path.join(folder, "*-truth.csv"))):
        curves, rows = [], []
        with open(path, encoding="utf-8") as file:
            for line in file.read().split("\n") + [""]:
                cells = line.split(",")
                try:
                    rows.append([float(cells[0]), float(cells[1])])
                except (ValueError, IndexError):
                    if len(rows) >= 100 and not line.startswith("#"):
                        curves.append(numpy.array(rows))
                    if not line.startswith("#"):
                        rows = []
        if not curves:
            continue

        def part(random, count, curves=curves):
            points = dense(curves[random.integers(len(curves))], 20000)
            length = lengths_along(points)[-1]
            edge = length / min(2000, max(4 * count, 300))
            begin = random.uniform(0, length - edge * count)
            fine = along(points, begin + numpy.linspace(0, edge * count, count * PER_EDGE))
            return fine / edge, numpy.arange(0, count * PER_EDGE, PER_EDGE)

        families[os.path.basename(path)[: -len("-truth.csv")]] = part
    return families


def noise(random, count, deviation, kind):
    values = random.normal(size=(count, 2)) * deviation
    if kind == "AR(1)":
        for i in range(1, count):
            values[i] = 0.6 * values[i - 1] + 0.8 * values[i]
    if kind == "outliers":
        values[random.random(count) < 0.03] *= 10
    return values


# Peers


def scipy_spline(points, chord):
    """make_smoothing_spline of each coordinate, with its generalized cross-validation."""
    t = numpy.r_[0, numpy.cumsum(numpy.maximum(numpy.diff(lengths_along(points)), 1e-9))] if chord else numpy.arange(
        float(len(points)))
    at = numpy.linspace(t[0], t[-1], 16 * len(points))
    return numpy.stack([make_smoothing_spline(t, column)(at) for column in points.T], axis=1)


def kernel_smoothed(points, width):
    """smoothr's smooth_ksmooth: R's normal kernel over the length, with a bandwidth of mean lengths; ends kept."""
    t = numpy.linspace(0, lengths_along(points)[-1], 10 * len(points))
    fine = along(points, t)
    deviation = 0.25 * width * t[-1] / (len(points) - 1) / 0.6744898
    weights = numpy.exp(-0.5 * ((t[:, None] - t) / deviation) ** 2)
    result = weights @ fine / weights.sum(axis=1)[:, None]
    result[[0, -1]] = points[[0, -1]]
    return result


def paek(points, width):
    """Bodansky, Gribov and Pilouk (2002): local parabolas with an exponential kernel over the length; ends kept."""
    t = numpy.linspace(0, lengths_along(points)[-1], 8 * len(points))
    fine, result = along(points, t), []
    for at in t:
        u = (t - at) / (width * t[-1] / (len(points) - 1))
        near = numpy.abs(u) < 3
        root = numpy.exp(-numpy.abs(u[near]) / 2)[:, None]
        system = numpy.c_[numpy.ones(near.sum()), u[near], u[near] ** 2]
        result.append(numpy.linalg.lstsq(system * root, fine[near] * root, rcond=None)[0][0])
    result = numpy.array(result)
    result[[0, -1]] = points[[0, -1]]
    return result


def mapshaper_smoothed(program, tracks, width, folder):
    scale, shift = 100, 1e5  # so that coordinates are not taken for degrees
    given, made = os.path.join(folder, "given.json"), os.path.join(folder, "made.json")
    features = [{"type": "Feature", "properties": {"track": i},
                 "geometry": {"type": "LineString", "coordinates": (track * scale + shift).tolist()}}
                for i, track in enumerate(tracks)]
    with open(given, "w", encoding="utf-8") as file:
        json.dump({"type": "FeatureCollection", "features": features}, file)
    subprocess.run([program, given, "-smooth", str(width * scale), "-o", made, "force"], check=True, capture_output=True)
    results = list(tracks)
    with open(made, encoding="utf-8") as file:
        for feature in json.load(file)["features"]:
            if feature["geometry"]["type"] == "LineString":
                results[feature["properties"]["track"]] = (numpy.array(feature["geometry"]["coordinates"]) - shift) / scale
    return results


def batten_smoothed(program, tracks, folder, options=("--smooth", "auto")):
    given, made = os.path.join(folder, "given.csv"), os.path.join(folder, "made.csv")
    with open(given, "w", encoding="utf-8") as file:
        for track in tracks:
            file.write("x,y\n" if file.tell() == 0 else "\n")
            csv.writer(file).writerows(track.tolist())
    subprocess.run([program, "curve", given, "-o", made, "--quiet", "--levels", "4", *options], check=True)
    results, rows = [], []
    with open(made, encoding="utf-8") as file:
        for line in file.read().split("\n") + [""]:
            try:
                rows.append([float(cell) for cell in line.split(",")])
            except ValueError:
                if rows:
                    results.append(numpy.array(rows))
                rows = []
    return results


def compare(given, make_truth, kind, family, folder):
    tracks, truths, deviations, scores = [], [], [], {}
    for seed in range(given.tracks):
        random = numpy.random.default_rng([given.first_seed + seed, *kind.encode(), *family.encode()])
        count = int(random.integers(40, 200))
        points, index = make_truth(random, count)
        points = points / numpy.linalg.norm(numpy.diff(points[index], axis=0), axis=1).mean()
        deviations.append(numpy.exp(random.uniform(numpy.log(0.05), 0)))
        tracks.append(points[index] + noise(random, count, deviations[-1], kind))
        truths.append(points[index[0] : index[-1] + 1])

    def score(name, results):
        scores[name] = numpy.mean([distance(a, b) / s for a, b, s in zip(results, truths, deviations)])

    def best(name, results_of):
        values = []
        for width in WIDTHS:
            score(name, results_of(width))
            values.append(scores[name])
        scores[name] = min(values)

    score("polygon", tracks)
    score("batten", batten_smoothed(given.batten, tracks, folder))
    score("scipy, length", [scipy_spline(track, True) for track in tracks])
    score("scipy, index", [scipy_spline(track, False) for track in tracks])
    score("ksmooth 1", [kernel_smoothed(track, 1) for track in tracks])
    best("ksmooth, best", lambda width: [kernel_smoothed(track, width) for track in tracks])
    best("PAEK, best", lambda width: [paek(track, width) for track in tracks])
    if given.mapshaper:
        best("mapshaper, best", lambda width: mapshaper_smoothed(given.mapshaper, tracks, width, folder))
    return scores


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("batten")
    parser.add_argument("tracks", type=int, nargs="?", default=40)
    parser.add_argument("--mapshaper")
    parser.add_argument("--curves")
    parser.add_argument("--first-seed", type=int, default=0)
    given = parser.parse_args()
    families = {"roads": road, "loops": loops, "walks": walk}
    if given.curves:
        families = file_truths(given.curves)
    sums, rows = {}, 0
    with tempfile.TemporaryDirectory() as folder:
        for family, make_truth in families.items():
            for kind in ("independent", "outliers", "AR(1)"):
                scores = compare(given, make_truth, kind, family, folder)
                if rows == 0:
                    print("| tracks, noise |", " | ".join(scores), "| ratio |")
                    print("| --- |", " | ".join("---:" for _ in scores), "| ---: |")
                rivals = [value for name, value in scores.items() if name not in ("batten", "polygon")]
                print(f"| {family}, {kind} |", " | ".join(f"{value:.3f}" for value in scores.values()),
                      f"| {scores['batten'] / min(rivals):.2f} |", flush=True)
                rows += 1
                for name, value in scores.items():
                    sums[name] = sums.get(name, 0) + value
    rivals = [value for name, value in sums.items() if name not in ("batten", "polygon")]
    print("| mean |", " | ".join(f"{value / rows:.3f}" for value in sums.values()),
          f"| {sums['batten'] / min(rivals):.2f} |")


if __name__ == "__main__":
    sys.exit(main())
