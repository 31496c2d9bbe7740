"""Check the polygons of GeoJSON files by Shapely: each is valid, and no two overlap. Usage: check-coverage.py FILE..."""

import json
import sys

from shapely.geometry import shape
from shapely.strtree import STRtree
from shapely.validation import explain_validity


def overlaps(shapes):
    """The pairs of shapes that overlap, with the area. Shapely before version 2 finds shapes, later ones their indices."""
    tree = STRtree(shapes)
    index = {id(one): i for i, one in enumerate(shapes)}
    for i, one in enumerate(shapes):
        for found in tree.query(one):
            k = index.get(id(found), found)
            if k > i and one.intersection(shapes[k]).area > 0:
                yield i, k, one.intersection(shapes[k]).area


def check(path):
    with open(path, encoding="utf-8") as file:
        features = json.load(file)["features"]
    shapes = [shape(feature["geometry"]) for feature in features]
    faults = [f"feature {i}: {explain_validity(one)}" for i, one in enumerate(shapes) if not one.is_valid]
    if not faults:
        faults = [f"features {i} and {k} overlap by {area} square degrees" for i, k, area in overlaps(shapes)]
    for fault in faults[:10]:
        print(f"{path}: {fault}")
    print(f"{path}: {len(features)} features, {len(faults)} faults")
    return not faults


if __name__ == "__main__":
    sys.exit(0 if all([check(path) for path in sys.argv[1:]]) else 1)
