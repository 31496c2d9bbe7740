#!/usr/bin/env python3
"""Compare the learned scheme with Catmull and Clark's on quads that decimation made.

    scripts/mesh-quads-peers.py BATTEN MESH... [--faces 1000]

Each mesh is decimated to triangles by quadric errors, which are paired to quads, both by PyMeshLab. `catmull-clark` refines
the quads by two levels; `learned` and `loop` the triangles of the quads cut in two; `quads` is the decimated mesh itself.
Distances from the fine mesh, both ways, over those of `catmull-clark`. Prints one JSON object. A mesh of which a scheme is
refused is told and left out.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

import pymeshlab


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def decimated(mesh, faces, path):
    """Write the mesh as quads."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(mesh)
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=faces, preservenormal=True)
    meshes.meshing_tri_to_quad_by_smart_triangle_pairing()
    meshes.save_current_mesh(path, save_polygonal=True)


def distances(batten, mesh, folder):
    """{row: (mean distance, Hausdorff distance)}"""
    quads, cut, fine = (os.path.join(folder, name) for name in ("quads.obj", "cut.obj", "fine.ply"))
    run(batten, "mesh", quads, "-o", cut, "--scheme", "midpoint", "--levels", "0", "--quiet")
    calls = {"catmull-clark": (quads, "--scheme", "catmull-clark"),
             "quads": (quads, "--scheme", "catmull-clark", "--levels", "0"),
             "loop": (cut, "--scheme", "loop"), "learned": (cut, "--scheme", "learned")}
    found = {}
    for row, call in calls.items():
        run(batten, "mesh", *call, "-o", fine, "--quiet")
        measured = json.loads(run(batten, "measure", fine, mesh, "--json"))
        found[row] = measured["mean"], measured["hausdorff"]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("batten")
    parser.add_argument("meshes", nargs="+", metavar="MESH")
    parser.add_argument("--faces", type=int, default=1000)
    options = parser.parse_args()
    made = []
    with tempfile.TemporaryDirectory() as folder:
        for mesh in options.meshes:
            try:
                decimated(mesh, options.faces, os.path.join(folder, "quads.obj"))
                made.append(distances(options.batten, mesh, folder))
            except subprocess.CalledProcessError as error:
                print(f"{mesh}: {error.stderr.strip()}", file=sys.stderr)
    rows = []
    for row in made[0] if made else []:
        ratios = [math.exp(sum(math.log(m[row][k] / m["catmull-clark"][k]) for m in made) / len(made)) for k in (0, 1)]
        rows.append({"scheme": row, "mean": ratios[0], "hausdorff": ratios[1]})
    print(json.dumps({"meshes": len(made), "rows": rows}))


if __name__ == "__main__":
    main()
