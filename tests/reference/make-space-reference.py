#!/usr/bin/env python3
"""Makes tests/reference/space_reference.h: distances, logarithms and transports in 80 digits for the points as rounded to
double, from formulas other than the library's (cross products on the sphere, the hyperboloid for the disk). Needs mpmath."""
import random
from mpmath import mp, mpf, sqrt, atan2, acosh, asinh, cos, sin, exp, tanh, pi, matrix

mp.dps = 80
random.seed(20)


def hexes(values):
    return ", ".join(float(v).hex() for v in values)


def dot(u, v):
    return sum(a * b for a, b in zip(u, v))


def unit(v):
    n = sqrt(dot(v, v))
    return [a / n for a in v]


def rounded(v):
    return [mpf(float(a)) for a in v]


def sphere_case(angle):
    p = unit([mpf(random.gauss(0, 1)) for _ in range(3)])
    u = [mpf(random.gauss(0, 1)) for _ in range(3)]
    u = unit([a - dot(u, p) * b for a, b in zip(u, p)])
    q = [cos(angle) * a + sin(angle) * b for a, b in zip(p, u)]
    p, q = rounded(p), rounded(q)
    # The angle of the rounded vectors, whatever their lengths, and the direction from p to q.
    cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
    theta = atan2(sqrt(dot(cross, cross)), dot(p, q))
    w = unit([b - dot(p, q) / dot(p, p) * a for a, b in zip(p, q)])
    return f"    {{{{{hexes(p)}}}, {{{hexes(q)}}}, {hexes([theta])}, {{{hexes([theta * a for a in w])}}}}},"


def disk_case(radius, separation):
    # Around a point at a hyperbolic radius from the origin, a point at a separation in a random direction.
    phi, psi = mpf(random.random()) * 2 * pi, mpf(random.random()) * 2 * pi
    p = [tanh(radius / 2) * cos(phi), tanh(radius / 2) * sin(phi)]
    z = [tanh(separation / 2) * cos(psi), tanh(separation / 2) * sin(psi)]

    def mobius(a, b):
        a, b = mp.mpc(*a), mp.mpc(*b)
        c = (a + b) / (1 + mp.conj(a) * b)
        return [c.real, c.imag]

    q = rounded(mobius(p, z))
    p = rounded(p)

    def lift(z):
        s = 1 - dot(z, z)
        return [(1 + dot(z, z)) / s, 2 * z[0] / s, 2 * z[1] / s]

    x, y = lift(p), lift(q)
    d = acosh(x[0] * y[0] - x[1] * y[1] - x[2] * y[2])
    w = mobius([-p[0], -p[1]], q)
    n = sqrt(dot(w, w))
    return f"    {{{{{hexes(p)}}}, {{{hexes(q)}}}, {hexes([d])}, {{{hexes([d * a / n for a in w])}}}}},"


print("// Made by make-space-reference.py; do not edit.")
print("#ifndef REFERENCE_SPACE_REFERENCE_H\n#define REFERENCE_SPACE_REFERENCE_H\n")
print("/// Two unit vectors, the angle between them and the logarithm, rounded from 80 digits.")
print("static const struct\n{\n    double p[3], q[3], distance, log[3];\n} SPHERE_REFERENCE[] = {")
for e in [1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0, 1.5, 1.6, 2.0, 2.5, 3.0, 3.1, 3.14]:
    print(sphere_case(mpf(e)))
    print(sphere_case(mpf(e) * mpf("1.7") if e < 1 else mpf(e)))
for e in [1e-3, 1e-5, 1e-7, 1e-8]:
    print(sphere_case(pi - mpf(e)))
print("};\n")
print("/// Two points of the Poincaré disk, their distance and the logarithm in the frame of Möbius translation.")
print("static const struct\n{\n    double p[2], q[2], distance, log[2];\n} DISK_REFERENCE[] = {")
for radius in [0, 0.5, 2, 5, 8, 11, 14]:
    for separation in [1e-8, 1e-5, 1e-2, 1, 3]:
        if radius + separation <= 15:
            print(disk_case(mpf(radius), mpf(separation)))
print("};\n\n#endif")
