#!/usr/bin/env python3
"""Makes tests/reference/manifold_reference.h: distances, logarithms and transports in 60 digits for points as rounded to double,
by formulas other than the library's. Needs mpmath."""
import random
from mpmath import mp, mpf, sqrt, acos, cos, sin, exp, log, pi, matrix, eye, expm, eigsy, diag

mp.dps = 60
random.seed(31)


def hexes(values):
    return "{" + ", ".join(float(v).hex() for v in values) + "}"


def rounded(values):
    return [mpf(float(v)) for v in values]


def gauss():
    return mpf(random.gauss(0, 1))


def unit(v):
    length = sqrt(sum(a * a for a in v))
    return [a / length for a in v]


# Rotations: the angle from the trace, the axis from the skew part, transport by the matrix exponential of half the bracket.

def rotation_matrix(q):
    w, x, y, z = unit(q)
    return matrix([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                   [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                   [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def product(p, q):
    return [p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
            p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
            p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
            p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1]]


def rotation_case(angle):
    p = rounded(unit([gauss() for _ in range(4)]))
    axis = unit([gauss() for _ in range(3)])
    q = rounded(product(p, [cos(angle / 2)] + [sin(angle / 2) * a for a in axis]))
    if random.random() < 0.5:
        q = [-a for a in q]
    step = rotation_matrix(p).T * rotation_matrix(q)
    theta = acos((step[0, 0] + step[1, 1] + step[2, 2] - 1) / 2)
    skew = [step[2, 1] - step[1, 2], step[0, 2] - step[2, 0], step[1, 0] - step[0, 1]]
    v = [theta * a / (2 * sin(theta)) for a in skew]
    u = matrix([mpf(0.3), mpf(-0.7), mpf(0.2)])
    moved = expm(matrix([[0, v[2], -v[1]], [-v[2], 0, v[0]], [v[1], -v[0], 0]]) / 2) * u
    return f"    {{{hexes(p)}, {hexes(q)}, {float(theta).hex()}, {hexes(v)}, {hexes(moved)}}},"


def section(kind, fields, name, rows):
    print(f"\ntypedef struct {kind}\n{{\n    double {fields};\n}} {kind};\n")
    print(f"static const {kind} {name}[] = {{")
    for row in rows:
        print(row)
    print("};")


print("// Made by make-manifold-reference.py; do not edit.")
print("// clang-format off")
section("rotation_reference", "p[4], q[4], distance, log[3], transported[3]", "ROTATION_REFERENCE",
        [rotation_case(mpf(a)) for a in ("1e-12", "1e-8", "1e-4", "0.24", "0.26", "1", "2.5", "3.14", "3.1415926")])


# Tensors: functions of the symmetric square root of the point, then Cholesky's frame.

def function(m, f):
    values, vectors = eigsy(m)
    return vectors * diag([f(v) for v in values]) * vectors.T


def packed(m, scale=1):
    n = m.rows
    return [m[i, j] * (1 if i == j else scale) for i in range(n) for j in range(i, n)]


def unpacked(n, values, scale=1):
    values, m = list(values), matrix(n, n)
    for i in range(n):
        for j in range(i, n):
            m[i, j] = m[j, i] = values.pop(0) * (1 if i == j else scale)
    return m


def orthogonal(n):
    m = matrix([[gauss() for _ in range(n)] for _ in range(n)])
    return mp.qr(m)[0]


def to_frame(p, v):
    inverse = mp.cholesky(p) ** -1
    return packed(inverse * v * inverse.T, sqrt(2))


def tensor_case(eigenvalues, logarithms, condition):
    """From the point with these eigenvalues, a step with these logarithms of eigenvalues; `condition` scales the tolerance."""
    n = len(eigenvalues)
    q = orthogonal(n)
    p = unpacked(n, rounded(packed(q * diag([mpf(e) for e in eigenvalues]) * q.T)))
    root = function(p, sqrt)
    turn = orthogonal(n)
    step = turn * diag([exp(mpf(e)) for e in logarithms]) * turn.T
    target = unpacked(n, rounded(packed(root * step * root)))
    inverse = root ** -1
    middle = function(inverse * target * inverse, log)
    velocity = root * middle * root
    distance = sqrt(sum(a * a for a in middle))
    u = [mpf(a) for a in (0.3, -0.7, 0.2, 0.5, 0.1, -0.4)][:n * (n + 1) // 2]
    l = mp.cholesky(p)
    at_p = l * unpacked(n, u, 1 / sqrt(mpf(2))) * l.T
    e = root * function(inverse * target * inverse, sqrt) * inverse
    moved = to_frame(target, e * at_p * e.T)
    pad = [0] * (6 - n * (n + 1) // 2)
    return (f"    {{{n}, {hexes(packed(p) + pad)}, {hexes(packed(target) + pad)}, {float(distance).hex()}, "
            f"{hexes(to_frame(p, velocity) + pad)}, {hexes(moved + pad)}, {condition}}},")


section("tensor_reference", "side, p[6], q[6], distance, log[6], transported[6], condition", "TENSOR_REFERENCE", [
    tensor_case([1, 2], ["0.3", "-0.2"], 1),
    tensor_case([1, 2], ["1e-8", "-2e-8"], 1),
    tensor_case([1, "1.000000000001"], ["1", "1.00000000001"], 1),
    tensor_case(["1e5", "1e-5"], ["0.1", "0.2"], "1e10"),
    tensor_case([1, 2, 3], ["0.3", "-0.2", "0.1"], 2),
    tensor_case([1, 2, 3], ["1e-8", "-2e-8", "3e-8"], 2),
    tensor_case([1, 2, 3], ["1e-12", "-2e-12", "3e-12"], 2),
    tensor_case([1, 2, 3], ["0.05", "0.0500000000001", "0.05000000001"], 2),
    tensor_case([1, 2, 3], ["0.45", "0.45", "-0.45"], 2),
    tensor_case([1, 1, 1], ["1", "1.00000000001", "1.0000000000003"], 2),
    tensor_case([1, "1.0000000001", "1.00000000001"], ["2", "-1", "-1.0000001"], 10),
    tensor_case([1, 2, 3], ["10", "-5", "-10"], "1e9"),
    tensor_case([1, "1e-3", "1e-10"], ["1e-8", "-2e-8", "3e-8"], "1e10"),
    tensor_case([1, "1e-3", "1e-10"], ["1", "2", "-1"], "1e10"),
])


# Hyperbolic space: boosts as matrices.

def boost(x):
    n = len(x)
    x0 = sqrt(1 + sum(a * a for a in x))
    b = eye(n + 1)
    b[0, 0] = x0
    for i in range(n):
        b[0, i + 1] = b[i + 1, 0] = x[i]
        for j in range(n):
            b[i + 1, j + 1] += x[i] * x[j] / (1 + x0)
    return b


def apply(b, v):
    return list(b * matrix(v))


def hyperbolic_case(radius, separation, cosine):
    """A point at a radius, and one at a separation from it, whose direction has this cosine with the way out from the apex."""
    mp.dps = 400
    radius, separation, cosine = mpf(radius), mpf(separation), mpf(cosine)
    axis = unit([gauss() for _ in range(3)])
    side = [gauss() for _ in range(3)]
    along = sum(a * b for a, b in zip(side, axis))
    side = unit([a - along * b for a, b in zip(side, axis)])
    p = rounded([mp.sinh(radius) * a for a in axis])
    direction = [cosine * a + sqrt(1 - cosine * cosine) * b for a, b in zip(axis, side)]
    q = apply(boost(p), [mp.cosh(separation)] + [mp.sinh(separation) * a for a in direction])
    q = rounded(q[1:])
    to_p, to_q = boost([-a for a in p]), boost([-a for a in q])
    seen = apply(to_p, [sqrt(1 + sum(a * a for a in q))] + q)
    sine = sqrt(sum(a * a for a in seen[1:]))
    d = mp.asinh(sine)
    v = [d / sine * a for a in seen[1:]]
    u = [mpf(a) for a in (0.3, -0.7, 0.2)]
    # In p's frame p is (1, 0) and transport to `seen` is u - <seen, u> / (1 + cosh d) (e0 + seen), up to the sign of <,>.
    factor = sum(a * b for a, b in zip(seen[1:], u)) / (1 + seen[0])
    moved = [factor * (1 + seen[0])] + [b + factor * a for a, b in zip(seen[1:], u)]
    moved = apply(to_q, apply(boost(p), moved))
    lift = lambda x: [sqrt(1 + sum(a * a for a in x))] + x
    row = (f"    {{{hexes(lift(p))}, {hexes(lift(q))}, {float(d).hex()}, {hexes(v)}, {hexes(moved[1:])}, "
           f"{float(max(radius, mp.asinh(sqrt(sum(a * a for a in q))))).hex()}}},")
    mp.dps = 60
    return row


section("hyperbolic_reference", "p[4], q[4], distance, log[3], transported[3], radius", "HYPERBOLIC_REFERENCE", [
    hyperbolic_case(*case) for case in (
        ("1e-9", "1e-9", "0.5"), ("1", "1e-12", "0.3"), ("1", "1e-8", "-0.9"), ("1", "1", "0"), ("0.1", "5", "-0.99"), ("3", "1e-8", "0.1"),
        ("3", "6", "-1"), ("3", "6", "-0.999"), ("5", "0.1", "1"), ("8", "1e-4", "0.7"), ("15", "0.5", "0.2"), ("15", "30", "-0.9999999"),
        ("15", "1e-3", "0.5"), ("1", "300", "0.5"), ("30", "60", "-1"))
])
