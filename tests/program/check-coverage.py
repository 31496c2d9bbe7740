"""Check the polygons of GeoJSON files by Shapely: each is valid, and no two overlap. Usage: check-coverage.py FILE...

check-coverage.py --against GIVEN FILE prints as JSON how many features became invalid, and the area of overlaps.
"""

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


def read(path):
    with open(path, encoding="utf-8") as file:
        return [shape(feature["geometry"]) for feature in json.load(file)["features"]]


def compare(given, made):
    given, made = read(given), read(made)
    became = sum(a.is_valid and not b.is_valid for a, b in zip(given, made, strict=True))
    area = sum(area for _, _, area in overlaps([one if one.is_valid else one.buffer(0) for one in made]))
    print(json.dumps({"features": len(given), "made_invalid": became, "overlap": area}))


def check(path):
    shapes = read(path)
    faults = [f"feature {i}: {explain_validity(one)}" for i, one in enumerate(shapes) if not one.is_valid]
    if not faults:
        faults = [f"features {i} and {k} overlap by {area} square degrees" for i, k, area in overlaps(shapes)]
    for fault in faults[:10]:
        print(f"{path}: {fault}")
    print(f"{path}: {len(shapes)} features, {len(faults)} faults")
    return not faults


if __name__ == "__main__":
    if sys.argv[1] == "--against":
        sys.exit(compare(*sys.argv[2:]))
    sys.exit(0 if all([check(path) for path in sys.argv[1:]]) else 1)
