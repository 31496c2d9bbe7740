#!/usr/bin/env python3
"""Maps that batten reads and writes without refinement stay valid and keep their areas.

Usage: valid-maps.py BATTEN SHARED. Exits 77, which ctest takes as skipped, without Shapely.
"""
import json
import math
import os
import random
import subprocess
import sys
import tempfile

try:
    from shapely.geometry import shape
except ImportError:
    print("skipped: no Shapely")
    sys.exit(77)


def place(longitude, latitude, bearing, distance):
    """The point at a distance from another, in degrees, rounded as batten writes it."""
    a, b = math.radians(longitude), math.radians(latitude)
    z = math.sin(b) * math.cos(distance) + math.cos(b) * math.sin(distance) * math.cos(bearing)
    x = math.cos(distance) - math.sin(b) * z
    l = a + math.atan2(math.sin(bearing) * math.sin(distance) * math.cos(b), x)
    return [(math.degrees(l) + 180) % 360 - 180, math.degrees(math.asin(z))]


def ring(rng, longitude, latitude, radius, clockwise):
    count = rng.randint(5, 40)
    points = [place(longitude, latitude, (1 if clockwise else -1) * 2 * math.pi * i / count, radius * rng.uniform(0.6, 1))
              for i in range(count)]
    return points + points[:1]


def random_map(seed):
    """Polygons with holes around the antimeridian and the poles, as geometries on the sphere."""
    rng = random.Random(seed)
    features = []
    for _ in range(60):
        polar = rng.random() < 0.4
        longitude = rng.uniform(-180, 180) if polar else rng.uniform(174, 186)
        latitude = rng.choice([-1, 1]) * (rng.uniform(84, 89) if polar else rng.uniform(0, 60))
        radius = rng.uniform(0.08, 0.4)
        rings = [ring(rng, longitude, latitude, radius, False)]
        for i in range(rng.randint(0, 3)):
            rings.append(ring(rng, *place(longitude, latitude, 2 * i, 0.3 * radius), 0.1 * radius, True))
        features.append({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": rings}})
    return {"type": "FeatureCollection", "features": features}


def rewrite(batten, source, target):
    command = [batten, "curve", source, "-o", target, "--levels", "0", "--scheme", "log-exp-4", "--simple", "never", "--quiet",
               "--precision", "12"]
    subprocess.run(command, check=True)
    with open(target) as file:
        return json.load(file)


def compare(before, after, name):
    assert len(before["features"]) == len(after["features"]), name
    for i, (a, b) in enumerate(zip(before["features"], after["features"])):
        p, q = shape(a["geometry"]), shape(b["geometry"])
        if not p.is_valid:
            continue
        assert q.is_valid, f"{name}: feature {i} became invalid"
        assert abs(p.area - q.area) < 1e-9, f"{name}: feature {i} has the area {q.area}, not {p.area}"


def main():
    batten, shared = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as folder:
        files = [os.path.join(folder, name) for name in ("given.geojson", "first.geojson", "second.geojson")]
        for seed in range(4):
            with open(files[0], "w") as file:
                json.dump(random_map(seed), file)
            first = rewrite(batten, files[0], files[1])
            # Cut at the antimeridian, so that Shapely can judge it.
            assert all(shape(f["geometry"]).is_valid for f in first["features"]), f"map {seed} is invalid"
            compare(first, rewrite(batten, files[1], files[2]), f"map {seed}")
        countries = os.path.join(shared, "data/maps/countries-110m.geojson")
        if not os.path.exists(countries):
            print(f"without {countries}")
            return
        with open(countries) as file:
            given = json.load(file)
        compare(given, rewrite(batten, countries, files[1]), "countries")


main()
