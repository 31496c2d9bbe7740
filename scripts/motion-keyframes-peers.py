#!/usr/bin/env python3
"""The peers of `batten reproduce motion-keyframes`, computed by scipy.

usage: scripts/motion-keyframes-peers.py FOLDER > research/studies/motion_keyframes_data.c

FOLDER holds fr1-xyz.txt, the ground truth of the TUM RGB-D sequence freiburg1_xyz. The other motions are those of
research/studies/motion_keyframes.c, by the same formulas. Every k-th pose is kept; the figures are root mean squares over the
poses between, of translations and of angles in degrees.

spline: CubicSpline and RotationSpline; squad: Akima1DInterpolator and squad (Shoemake 1987), inner quaternions
q_i exp(-(log(q_i^-1 q_{i+1}) + log(q_i^-1 q_{i-1})) / 4) and the ends themselves; slerp: lines and Slerp.
"""
import sys

import numpy as np
import scipy
from scipy.interpolate import Akima1DInterpolator, CubicSpline, make_interp_spline
from scipy.spatial.transform import Rotation, RotationSpline, Slerp

STEPS = (5, 10, 20, 50)


def by_axes(x, y, z):
    return Rotation.from_matrix(np.stack([x, y, z], 2))


def unit(v):
    return v / np.linalg.norm(v, axis=1)[:, None]


def quadrotor():
    t = np.arange(1500) * 0.02
    waves = [(1.5, 0.9, 0.0), (0.8, 1.7, 1.0), (0.3, 3.1, 2.0)]
    p, a = np.zeros((len(t), 3)), np.zeros((len(t), 3))
    for axis in range(3):
        for size, rate, phase in waves:
            size, rate, phase = size * (0.3 if axis == 2 else 1), rate * (1 + 0.1 * axis), phase + 2 * axis
            p[:, axis] += size * np.sin(rate * t + phase)
            a[:, axis] -= size * rate * rate * np.sin(rate * t + phase)
    a[:, 2] += 9.81
    z = unit(a)
    yaw = 0.5 * np.sin(0.3 * t) + 0.1 * t
    y = unit(np.cross(z, np.stack([np.cos(yaw), np.sin(yaw), 0 * yaw], 1)))
    return t, p, by_axes(np.cross(y, z), y, z)


def car():
    t = np.arange(1200) * 0.1
    p = np.stack([60 * np.sin(0.15 * t) + 8 * np.sin(0.31 * t), 60 * np.cos(0.15 * t) + 6 * np.sin(0.23 * t + 1),
                  0.3 * np.sin(0.4 * t)], 1)
    v = np.stack([9 * np.cos(0.15 * t) + 2.48 * np.cos(0.31 * t),
                  -9 * np.sin(0.15 * t) + 1.38 * np.cos(0.23 * t + 1), 0.12 * np.cos(0.4 * t)], 1)
    x = unit(v)
    y = unit(np.cross(np.tile([0.0, 0.0, 1.0], (len(t), 1)), x))
    return t, p, by_axes(x, y, np.cross(x, y))


def arm():
    t = np.arange(2000) * 0.02
    i = np.floor(t / 2.7).astype(int)
    s = np.clip((t - 2.7 * i - 1.1) / 1.6, 0, 1)
    s = s * s * s * (10 - s * (15 - 6 * s))
    place = lambda j: np.stack([0.4 * np.sin(1.7 * j), 0.3 * np.cos(2.3 * j), 0.2 * np.sin(0.9 * j + 1)], 1)
    attitude = lambda j: Rotation.from_rotvec(
        np.stack([0.6 * np.sin(1.1 * j), 0.5 * np.cos(1.9 * j), 0.7 * np.sin(2.7 * j)], 1))
    begin, end = place(i), place(i + 1)
    turn = (attitude(i).inv() * attitude(i + 1)).as_rotvec()
    return t, begin + s[:, None] * (end - begin), attitude(i) * Rotation.from_rotvec(s[:, None] * turn)


def satellite():
    t = np.arange(1200) * 0.5
    orbit = 0.0022 * t
    p = 7000 * np.stack([np.cos(orbit), 0.6 * np.sin(orbit), 0.8 * np.sin(orbit)], 1)
    slew = np.zeros_like(t)
    for begin, end, angle in [(60, 120, 0.8), (200, 290, -1.2), (350, 420, 0.9), (480, 560, -0.5)]:
        s = np.clip((t - begin) / (end - begin), 0, 1)
        slew += angle * np.where(s < 0.5, 2 * s * s, 1 - 2 * (1 - s) * (1 - s))
    turn = lambda angle, axis: Rotation.from_rotvec(np.outer(angle, axis))
    wobble = np.stack([0.02 * np.sin(0.05 * t), 0 * t, 0.03 * np.cos(0.03 * t)], 1)
    return t, p, turn(orbit, [0, -0.8, 0.6]) * turn(slew, [0.6, 0.8, 0]) * Rotation.from_rotvec(wobble)


def noise(count, channel):
    """Uniform in -1 to 1."""
    x = 1e4 * np.sin(12.9898 * (np.arange(count) + 1) + 78.233 * (channel + 1))
    return 2 * (x - np.floor(x)) - 1


def disturb(p, q):
    n = len(p)
    length = 0.5 * np.linalg.norm(np.diff(p, axis=0), axis=1).mean()
    angle = 0.5 * (q[:-1].inv() * q[1:]).magnitude().mean()
    p = p + length * np.stack([noise(n, c) for c in range(3)], 1)
    return p, q * Rotation.from_rotvec(angle * np.stack([noise(n, c) for c in range(3, 6)], 1))


def squad(times, q, x):
    f = (q[:-1].inv() * q[1:]).as_rotvec()
    inner = np.zeros((len(times), 3))
    inner[1:-1] = -(f[1:] - f[:-1]) / 4
    s = q * Rotation.from_rotvec(inner)
    i = np.clip(np.searchsorted(times, x, side="right") - 1, 0, len(times) - 2)
    u = ((x - times[i]) / (times[i + 1] - times[i]))[:, None]
    slerp = lambda a, b, share: a * Rotation.from_rotvec((a.inv() * b).as_rotvec() * share)
    return slerp(slerp(q[i], q[i + 1], u), slerp(s[i], s[i + 1], u), 2 * u * (1 - u))


def figures(t, p, q, step):
    kept = np.arange(0, len(t), step)
    between = t <= t[kept[-1]]
    between[kept] = False
    times, x = t[kept], t[between]
    made = [(CubicSpline(times, p[kept])(x), RotationSpline(times, q[kept])(x)),
            (Akima1DInterpolator(times, p[kept])(x), squad(times, q[kept], x)),
            (make_interp_spline(times, p[kept], k=1)(x), Slerp(times, q[kept])(x))]
    rms = lambda values: np.sqrt((values**2).mean())
    return [(rms(np.linalg.norm(a - p[between], axis=1)), np.degrees(rms((q[between].inv() * b).magnitude())))
            for a, b in made]


def main():
    rows = []
    data = np.loadtxt(sys.argv[1] + "/fr1-xyz.txt")
    motions = [("quadrotor", quadrotor()), ("car", car()), ("arm", arm()), ("satellite", satellite())]
    motions = [(name, m, noisy) for name, m in motions for noisy in (False, True)]
    motions.append(("fr1-xyz", (data[:, 0], data[:, 1:4], Rotation.from_quat(data[:, 4:8])), False))
    for name, (t, p, q), noisy in motions:
        if noisy:
            p, q = disturb(p, q)
        for step in STEPS:
            numbers = ", ".join("{%.10g, %.10g}" % pair for pair in figures(t, p, q, step))
            rows.append('    {"%s", %s, %d, %d, {%s}},' % (name, "true" if noisy else "false", step, len(t), numbers))
    print("// Made by scripts/motion-keyframes-peers.py with scipy %s.\n" % scipy.__version__)
    print('#include "research/studies/motion_keyframes_data.h"\n')
    print("// clang-format off")
    print("const keyframe_facts KEYFRAME_FACTS[KEYFRAME_FACT_COUNT] = {")
    print("\n".join(rows))
    print("};\n// clang-format on")


main()
