#ifndef SPACE_TRIANGULAR_H
#define SPACE_TRIANGULAR_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/// @file
/// Symmetric matrices by their upper triangle, and what the metric of tensors does with a Cholesky factor. Whole matrices
/// are square of side n, row-major. Inline, so that a constant n is unrolled.

/// The largest side.
#define TRIANGLE_MAX_SIDE 32

/// Functions that are worth having once for each constant n.
#define FOR_EVERY_SIDE static inline __attribute__((always_inline))

/// The whole matrix of an upper triangle stored row by row, its entries off the diagonal times `scale`.
FOR_EVERY_SIDE void triangle_unpack(size_t n, const double *packed, double scale, double *a)
{
    for (size_t i = 0; i < n; i++)
    {
        a[i * n + i] = *packed++;
        for (size_t j = i + 1; j < n; j++)
            a[i * n + j] = a[j * n + i] = scale * *packed++;
    }
}

FOR_EVERY_SIDE void triangle_pack(size_t n, const double *a, double scale, double *packed)
{
    for (size_t i = 0; i < n; i++)
    {
        *packed++ = a[i * n + i];
        for (size_t j = i + 1; j < n; j++)
            *packed++ = scale * a[i * n + j];
    }
}

/// Whether a symmetric matrix is positive definite: no pivot is zero or below to rounding, none is infinite. Overwrites it.
FOR_EVERY_SIDE bool triangle_is_positive(size_t n, double *a)
{
    double diagonal[TRIANGLE_MAX_SIDE];
    for (size_t j = 0; j < n; j++)
        diagonal[j] = a[j * n + j];
    for (size_t j = 0; j < n; j++)
    {
        double pivot = a[j * n + j];
        if (!(pivot > (double)n * DBL_EPSILON * diagonal[j]) || pivot > DBL_MAX)
            return false;
        double inverse = 1 / pivot;
        for (size_t i = j + 1; i < n; i++)
        {
            double share = a[j * n + i] * inverse;
            for (size_t k = i; k < n; k++)
                a[i * n + k] -= share * a[j * n + k];
        }
    }
    return true;
}

/// a = l l^T with l lower triangular; its upper part is set to zero, and `inverse` receives 1 / l_ii.
/// False where a pivot is zero or below to rounding.
FOR_EVERY_SIDE bool triangle_cholesky(size_t n, const double *a, double *l, double *inverse)
{
    for (size_t j = 0; j < n; j++)
    {
        double pivot = a[j * n + j];
        for (size_t k = 0; k < j; k++)
            pivot -= l[j * n + k] * l[j * n + k];
        if (!(pivot > (double)n * DBL_EPSILON * a[j * n + j]) || pivot > DBL_MAX)
            return false;
        l[j * n + j] = sqrt(pivot);
        inverse[j] = 1 / l[j * n + j];
        for (size_t i = j + 1; i < n; i++)
        {
            double sum = a[i * n + j];
            for (size_t k = 0; k < j; k++)
                sum -= l[i * n + k] * l[j * n + k];
            l[i * n + j] = sum * inverse[j];
            l[j * n + i] = 0;
        }
    }
    return true;
}

/// l^-1 b, in place.
FOR_EVERY_SIDE void triangle_solve(size_t n, const double *l, const double *inverse, double *b)
{
    for (size_t i = 0; i < n; i++)
    {
        for (size_t k = 0; k < i; k++)
            for (size_t j = 0; j < n; j++)
                b[i * n + j] -= l[i * n + k] * b[k * n + j];
        for (size_t j = 0; j < n; j++)
            b[i * n + j] *= inverse[i];
    }
}

/// l^-1 s l^-T of a symmetric matrix, in place and exactly symmetric.
FOR_EVERY_SIDE void triangle_whiten(size_t n, const double *l, const double *inverse, double *s)
{
    triangle_solve(n, l, inverse, s);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++)
        {
            double sum = s[i * n + j];
            for (size_t k = 0; k < j; k++)
                sum -= s[i * n + k] * l[j * n + k];
            s[i * n + j] = sum * inverse[j];
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j < n; j++)
            s[i * n + j] = s[j * n + i];
}

/// base + sum over k of values_k r_k r_k^T for the rows r_k of `rows`: the upper triangle packed, what is added off the
/// diagonal times `scale`. `base` is packed; null stands for zero.
FOR_EVERY_SIDE void triangle_compose(size_t n, const double *rows, const double *values, const double *base, double scale,
                                     double *packed)
{
    for (size_t i = 0, at = 0; i < n; i++)
        for (size_t j = i; j < n; j++, at++)
        {
            double sum = 0;
            for (size_t k = 0; k < n; k++)
                sum += values[k] * rows[k * n + i] * rows[k * n + j];
            packed[at] = (base == NULL ? 0 : base[at]) + (i == j ? 1 : scale) * sum;
        }
}

/// Row k of `images` is l times row k of `rows`.
FOR_EVERY_SIDE void triangle_apply(size_t n, const double *l, const double *rows, double *images)
{
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n; i++)
        {
            double sum = 0;
            for (size_t j = 0; j <= i; j++)
                sum += l[i * n + j] * rows[k * n + j];
            images[k * n + i] = sum;
        }
}

/// base + l s l^T for a symmetric s, the upper triangles packed; a null base stands for zero.
FOR_EVERY_SIDE void triangle_congruence(size_t n, const double *l, const double *s, const double *base, double *packed)
{
    double half[TRIANGLE_MAX_SIDE * TRIANGLE_MAX_SIDE];
    triangle_apply(n, l, s, half); // (l s)^T
    for (size_t i = 0, at = 0; i < n; i++)
        for (size_t j = i; j < n; j++, at++)
        {
            double sum = 0;
            for (size_t k = 0; k <= i; k++)
                sum += l[i * n + k] * half[k * n + j];
            packed[at] = (base == NULL ? 0 : base[at]) + sum;
        }
}

#endif
