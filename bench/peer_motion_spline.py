#!/usr/bin/env python3
"""scipy's RotationSpline and CubicSpline on poses from a file.

usage: peer_motion_spline.py KEYS QUERIES TIMES POSES

KEYS: rows of time, x, y, z, qw, qx, qy, qz as raw doubles; QUERIES of them in TIMES. Prints the processor's seconds of making both
splines and evaluating poses, and of poses, velocities and accelerations; each the least of three. POSES receives the poses.
"""
import sys
import time

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

keys = np.fromfile(sys.argv[1]).reshape(-1, 8)
queries = np.fromfile(sys.argv[3])
assert len(queries) == int(sys.argv[2])
poses = rates = float("inf")
for _ in range(3):
    start = time.process_time()
    rotations = RotationSpline(keys[:, 0], Rotation.from_quat(keys[:, [5, 6, 7, 4]]))
    translations = CubicSpline(keys[:, 0], keys[:, 1:4])
    position, attitude = translations(queries), rotations(queries).as_quat()
    middle = time.process_time()
    for order in (1, 2):
        translations(queries, order)
        rotations(queries, order)
    end = time.process_time()
    poses, rates = min(poses, middle - start), min(rates, end - start)
np.hstack([position, attitude[:, [3, 0, 1, 2]]]).tofile(sys.argv[4])
print(poses, rates)
