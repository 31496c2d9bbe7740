#!/usr/bin/env python3
"""Prints the polynomial coefficients of src/base/lanes.h and src/learn/real.h.

Most functions are even or odd, so that they are polynomials in z = x^2 after their known leading factor is divided out. The
polynomial interpolates at Chebyshev nodes (within a small factor of the best one), in 60 digits, and is then rounded to
double. The error printed is the largest relative one on a dense grid, before rounding. Needs mpmath.
"""
from mpmath import mp, mpf, atan, tan, tanh, cos, sin, exp, erf, log, sqrt, pi

mp.dps = 60


def fit(name, function, high, degree, reference=None, low=mpf(0)):
    nodes = [low + (high - low) * (1 + cos(pi * (2 * k + 1) / (2 * degree + 2))) / 2 for k in range(degree + 1)]
    matrix = mp.matrix(degree + 1, degree + 1)
    values = mp.matrix(degree + 1, 1)
    for row, z in enumerate(nodes):
        for column in range(degree + 1):
            matrix[row, column] = z ** column
        values[row] = function(z)
    coefficients = mp.lu_solve(matrix, values)
    worst = 0
    for k in range(2001):
        z = low + (high - low) * (mpf(k) + mpf(1) / 2) / 2001
        approximation = sum(c * z ** i for i, c in enumerate(coefficients))
        scale = reference(z) if reference else function(z)
        worst = max(worst, abs((approximation - function(z)) / scale))
    print(f"// {name}: degree {degree}, error {mp.nstr(worst, 2)}")
    print(",\n".join(f"    {float(c).hex()}" for c in coefficients))


def atan_tail(z):
    x = sqrt(z)
    return (atan(x) / x - 1) / z


def tan_times_pole(z):
    x = sqrt(z)
    return tan(x) / x * (pi ** 2 / 4 - z)


# atan(x) = x + x z P(z) for |x| <= tan(pi/8)
fit("atan", atan_tail, tan(pi / 8) ** 2, 10, reference=lambda z: 1 / z)
# tan(x) = x Q(z) / (pi^2/4 - z) for |x| <= pi/4
fit("tan", tan_times_pole, (pi / 4) ** 2, 7)
# cos(sqrt(s)) and sin(sqrt(s)) / sqrt(s) for 0 <= s <= pi^2
fit("cos of a root", lambda s: cos(sqrt(s)), pi ** 2, 12, reference=lambda s: mpf(1))
fit("sinc of a root", lambda s: sin(sqrt(s)) / sqrt(s), pi ** 2, 12, reference=lambda s: mpf(1))


def exp_tail(r):
    return (exp(r) - 1 - r) / r ** 2 if r else mpf(1) / 2


def fit_quotient(name, function, high, degree, divisor_degree):
    """The same for P(z) / Q(z) with Q(0) = 1."""
    count = degree + divisor_degree + 1
    nodes = [high * (1 + cos(pi * (2 * k + 1) / (2 * count))) / 2 for k in range(count)]
    matrix = mp.matrix(count, count)
    values = mp.matrix(count, 1)
    for row, z in enumerate(nodes):
        values[row] = function(z)
        for column in range(degree + 1):
            matrix[row, column] = z ** column
        for column in range(divisor_degree):
            matrix[row, degree + 1 + column] = -values[row] * z ** (column + 1)
    coefficients = list(mp.lu_solve(matrix, values))
    for part in coefficients[:degree + 1], [1] + coefficients[degree + 1:]:
        print(f"// {name}\n" + ",\n".join(f"    {float(c).hex()}" for c in part))


# For single precision.
# exp(r) = 1 + r + r^2 P(r) for |r| <= log(2) / 2
fit("exp, single", exp_tail, log(2) / 2, 4, low=-log(2) / 2, reference=lambda r: exp(r) / max(r ** 2, mpf("1e-30")))
# tanh(x) = x + x z P(z) for |x| <= 0.625
fit("tanh, single", lambda z: (tanh(sqrt(z)) / sqrt(z) - 1) / z, mpf("0.625") ** 2, 4, reference=lambda z: 1 / z)
# The normal distribution: the chance of a number below x is 1/2 + x P(z) / Q(z) for |x| <= 5.4
fit_quotient("normal, single", lambda z: erf(sqrt(z / 2)) / sqrt(z) / 2, mpf("5.4") ** 2, 6, 5)
