"""Write a scan of hills with its parameters: points.py COUNT XYZ UV PLY. The first 80 points are the boundary."""

import math
import random
import struct
import sys


def hills(u, v):
    """A point of a bent sheet."""
    bump = math.exp(-60 * ((u - 0.3) ** 2 + (v - 0.6) ** 2))
    return u + 0.05 * math.sin(4 * v), v, 0.1 * math.sin(5 * u * u + 3 * v) + 0.1 * bump


def main():
    count, side, draw = int(sys.argv[1]), 20, random.Random(7)
    rows = []
    for i in range(count):
        u, v, t = draw.random(), draw.random(), i % side / side
        if i < 4 * side:
            u, v = ((t, 0.0), (1.0, t), (1 - t, 1.0), (0.0, 1 - t))[i // side]
        x, y, z = hills(u, v)
        rows.append((x, y, z + draw.gauss(0, 2e-4), u, v))
    rows.insert(1000, rows[500])  # repeats another
    with open(sys.argv[2], "w") as xyz, open(sys.argv[3], "w") as uv:
        print("# 80 boundary points first", file=xyz)
        for row in rows:
            print(*map(repr, row[:3]), file=xyz)
            print(*map(repr, row[3:]), file=uv)
    with open(sys.argv[4], "wb") as ply:
        properties = "".join(f"property double {name}\n" for name in "xyzuv")
        ply.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n{properties}end_header\n".encode())
        for row in rows:
            ply.write(struct.pack("<5d", *row))


main()
