#!/usr/bin/env python3
"""Compare `batten surface --shell` with screened Poisson reconstruction on points that are sampled from meshes.

    scripts/scan-solids-peers.py BATTEN MESH... [--noise 0,0.001,0.005] [--points 20000] [--seed 1] [--json FILE]

Needs numpy and pymeshlab, whose reconstruction has depth 8 and 9 and normals on the right side; the nearer result counts.
Noise is a standard deviation, in units of the diagonal. A figure is the root mean square distance between result and mesh,
the greater of both ways, in standard deviations of the noise, or in % of the diagonal where there is none.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy
import pymeshlab


def sample(points, faces, count, random):
    """Points on triangles, and the normals there."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    normals = numpy.cross(b - a, c - a)
    areas = numpy.linalg.norm(normals, axis=1)
    on = random.choice(len(faces), count, p=areas / areas.sum())
    r, s = numpy.sqrt(random.random((count, 1))), random.random((count, 1))
    return (1 - r) * a[on] + r * (1 - s) * b[on] + r * s * c[on], normals[on] / areas[on, None]


def distances(batten, result, truth):
    """The root mean square distance of two surfaces, the greater of both ways, and the largest."""
    text = subprocess.run([batten, "measure", result, truth, "--mesh", "--accuracy", "0.01", "--json"], check=True,
                          capture_output=True, text=True).stdout
    found = json.loads(text)
    return max(found["rms_from_first"], found["rms_from_second"]), found["hausdorff"]


def poisson(points, normals, depth, path):
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(points))
    meshes.compute_normal_for_point_clouds(k=20, smoothiter=2)
    found = meshes.current_mesh().vertex_normal_matrix()
    found *= numpy.sign((found * normals).sum(axis=1, keepdims=True))
    meshes.clear()
    meshes.add_mesh(pymeshlab.Mesh(points, v_normals_matrix=found))
    meshes.generate_surface_reconstruction_screened_poisson(depth=depth, preclean=True)
    meshes.save_current_mesh(path)


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("batten")
    options.add_argument("mesh", nargs="+")
    options.add_argument("--noise", default="0,0.001,0.005")
    options.add_argument("--points", type=int, default=20000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--json")
    asked = options.parse_args()
    batten, rows = os.path.abspath(asked.batten), []
    print(f"{'mesh':18} {'noise':>6} {'batten':>8} {'Poisson':>8} {'ratio':>6} {'largest, %':>11} {'Poisson':>8} {'s':>6}")
    for mesh in asked.mesh:
        for noise in map(float, asked.noise.split(",")):
            with tempfile.TemporaryDirectory() as folder:
                shape = pymeshlab.MeshSet(verbose=False)
                shape.load_new_mesh(mesh)
                shape.meshing_merge_close_vertices(threshold=pymeshlab.PercentageValue(1e-7))
                vertices, faces = shape.current_mesh().vertex_matrix(), shape.current_mesh().face_matrix()
                diagonal = numpy.linalg.norm(numpy.ptp(vertices, axis=0))
                random = numpy.random.default_rng(asked.seed)
                points, normals = sample(vertices, faces, asked.points, random)
                points = points + noise * diagonal * random.normal(size=points.shape)
                truth, cloud = os.path.join(folder, "truth.obj"), os.path.join(folder, "cloud.xyz")
                shape.save_current_mesh(truth, save_vertex_color=False, save_wedge_texcoord=False)
                numpy.savetxt(cloud, points, fmt="%.12g")
                begin = time.time()
                ours = os.path.join(folder, "ours.obj")
                run = subprocess.run([batten, "surface", cloud, "--shell", "-o", ours, "--samples", "6", "--quiet"],
                                     capture_output=True, text=True)
                seconds = time.time() - begin
                unit = noise * diagonal if noise > 0 else diagonal / 100
                row = {"mesh": os.path.basename(mesh), "noise": noise, "seconds": seconds}
                if run.returncode == 0:
                    mean, largest = distances(batten, ours, truth)
                    row |= {"rms": mean / unit, "largest": 100 * largest / diagonal}
                else:
                    row["refused"] = run.stderr.strip().split("\n")[-1]
                peers = []
                for depth in (8, 9):
                    path = os.path.join(folder, f"poisson-{depth}.ply")
                    poisson(points, normals, depth, path)
                    peers.append(distances(batten, path, truth))
                mean, largest = min(peers)
                row |= {"poisson_rms": mean / unit, "poisson_largest": 100 * largest / diagonal}
                rows.append(row)
            if "rms" in row:
                print(f"{row['mesh']:18} {noise:6} {row['rms']:8.4f} {row['poisson_rms']:8.4f} {row['rms'] / row['poisson_rms']:6.2f}"
                      f" {row['largest']:11.3f} {row['poisson_largest']:8.3f} {seconds:6.1f}", flush=True)
            else:
                print(f"{row['mesh']:18} {noise:6} {'refused':>8} {row['poisson_rms']:8.4f} {'':6} {'':11}"
                      f" {row['poisson_largest']:8.3f} {seconds:6.1f}  {row['refused']}", flush=True)
    if asked.json:
        with open(asked.json, "w", encoding="utf-8") as file:
            json.dump({"rows": rows}, file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
