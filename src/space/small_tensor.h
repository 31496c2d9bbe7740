#ifndef SPACE_SMALL_TENSOR_H
#define SPACE_SMALL_TENSOR_H

#include <math.h>
#include <stddef.h>

/// @file
/// Power series of 3 x 3 matrices with small eigenvalues, and the polar factor, without eigenvectors. Matrices are 9
/// numbers, row-major.

/// The largest Frobenius norm of a matrix that small_tensor_expm1() and small_tensor_log1p() take.
#define SMALL_TENSOR_NORM 0.5

enum
{
    /// Newton's iteration ends after ten steps or so, however far it starts.
    SMALL_TENSOR_MAX_STEPS = 40
};

/// Up to this norm shorter series do.
static const double TINY_TENSOR_NORM = 0.125;

/// The square of a symmetric matrix.
static inline void small_tensor_square(const double *s, double *square)
{
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            square[3 * i + j] = square[3 * j + i] =
                s[3 * i] * s[3 * j] + s[3 * i + 1] * s[3 * j + 1] + s[3 * i + 2] * s[3 * j + 2];
}

/// Row i, column j: the cofactor, so that s (cofactors)^T = det(s) I.
static inline void small_tensor_cofactors(const double *s, double *c)
{
    c[0] = s[4] * s[8] - s[5] * s[7];
    c[1] = s[5] * s[6] - s[3] * s[8];
    c[2] = s[3] * s[7] - s[4] * s[6];
    c[3] = s[2] * s[7] - s[1] * s[8];
    c[4] = s[0] * s[8] - s[2] * s[6];
    c[5] = s[1] * s[6] - s[0] * s[7];
    c[6] = s[1] * s[5] - s[2] * s[4];
    c[7] = s[2] * s[3] - s[0] * s[5];
    c[8] = s[0] * s[4] - s[1] * s[3];
}

/// The sum over k < count of coefficients_k s^k, for a symmetric s, by Horner's rule in the three numbers a, b, c of a I + b
/// s + c s^2: the product with s is reduced by s^3 = trace s^2 - (sum of principal minors) s + determinant (Cayley and
/// Hamilton).
static inline void small_tensor_series(const double *s, const double *coefficients, size_t count, double *sum)
{
    double square[9];
    small_tensor_square(s, square);
    double minor = s[4] * s[8] - s[5] * s[5];
    double trace = s[0] + s[4] + s[8];
    double minors = minor + (s[0] * s[8] - s[2] * s[2]) + (s[0] * s[4] - s[1] * s[1]);
    double determinant = s[0] * minor - s[1] * (s[1] * s[8] - s[5] * s[2]) + s[2] * (s[1] * s[5] - s[4] * s[2]);
    double a = 0, b = 0, c = 0;
    for (size_t k = count; k-- > 0;)
    {
        double next = a - minors * c;
        a = coefficients[k] + determinant * c;
        c = b + trace * c;
        b = next;
    }
    for (int i = 0; i < 9; i++)
        sum[i] = b * s[i] + c * square[i] + (i % 4 == 0 ? a : 0);
}

/// e^s - I.
static inline void small_tensor_expm1(const double *s, double norm, double *result)
{
    static const double COEFFICIENTS[] = {0,
                                          1,
                                          1.0 / 2,
                                          1.0 / 6,
                                          1.0 / 24,
                                          1.0 / 120,
                                          1.0 / 720,
                                          1.0 / 5040,
                                          1.0 / 40320,
                                          1.0 / 362880,
                                          1.0 / 3628800,
                                          1.0 / 39916800,
                                          1.0 / 479001600,
                                          1.0 / 6227020800,
                                          1.0 / 87178291200};
    small_tensor_series(s, COEFFICIENTS, norm <= TINY_TENSOR_NORM ? 12 : 15, result);
}

/// log(I + s) = 2 artanh(z), z = s (2 I + s)^-1.
static inline void small_tensor_log1p(const double *s, double norm, double *result)
{
    static const double COEFFICIENTS[] = {2.0,      2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11,
                                          2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21, 2.0 / 23,
                                          2.0 / 25, 2.0 / 27, 2.0 / 29, 2.0 / 31, 2.0 / 33};
    double shifted[9], inverse[9], z[9], square[9], ratio[9];
    for (int i = 0; i < 9; i++)
        shifted[i] = s[i] + (i % 4 == 0 ? 2 : 0);
    small_tensor_cofactors(shifted, inverse);
    double scale = 1 / (shifted[0] * inverse[0] + shifted[1] * inverse[1] + shifted[2] * inverse[2]);
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            z[3 * i + j] = z[3 * j + i] =
                scale * (s[3 * i] * inverse[j] + s[3 * i + 1] * inverse[3 + j] + s[3 * i + 2] * inverse[6 + j]);
    small_tensor_square(z, square);
    small_tensor_series(square, COEFFICIENTS, norm <= TINY_TENSOR_NORM ? 7 : 17, ratio);
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            result[3 * i + j] = result[3 * j + i] =
                z[3 * i] * ratio[j] + z[3 * i + 1] * ratio[3 + j] + z[3 * i + 2] * ratio[6 + j];
}

/// The orthogonal factor u of k = p u, p positive definite, for a k of positive determinant: Newton's iteration x -> (x +
/// x^-T) / 2, scaled while x is far from orthogonal (Higham 1986). It squares the distance, so what a step of 1e-9 leads to
/// is exact.
static inline void small_tensor_polar(const double *k, double *u)
{
    double change = 1;
    for (int i = 0; i < 9; i++)
        u[i] = k[i];
    for (int step = 0; step < SMALL_TENSOR_MAX_STEPS && change > 1e-9; step++)
    {
        double inverse[9], own = 0, other = 0, scale = 1; // x^-T; squared norms of x and x^-T, both 3 when orthogonal
        small_tensor_cofactors(u, inverse);
        double reciprocal = 1 / (u[0] * inverse[0] + u[1] * inverse[1] + u[2] * inverse[2]);
        for (int i = 0; i < 9; i++)
        {
            inverse[i] *= reciprocal;
            own += u[i] * u[i];
            other += inverse[i] * inverse[i];
        }
        if (own + other > 8)
            scale = sqrt(sqrt(other / own));
        change = 0;
        for (int i = 0; i < 9; i++)
        {
            double next = 0.5 * (scale * u[i] + inverse[i] / scale);
            change = fmax(change, fabs(next - u[i]));
            u[i] = next;
        }
    }
}

#endif
