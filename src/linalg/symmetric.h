#pragma once

#include "linalg/vector.h"

#include <float.h>

/// @file
/// Eigenvalues of small symmetric matrices by Jacobi's cyclic method: whole square matrices of side n, row-major. Inline, so
/// that a constant n is unrolled.

/// Jacobi's method ends after six sweeps or so; its last ones converge quadratically.
#define SYMMETRIC_MAX_SWEEPS 40

/// When an entry off the diagonal counts as zero.
typedef enum symmetric_accuracy
{
    SYMMETRIC_BY_NORM,    ///< against the largest entry: eigenvalues to rounding of the largest one
    SYMMETRIC_BY_DIAGONAL ///< against its two diagonal entries: positive definite matrices whose rows differ in scale keep
                          ///< the small eigenvalues to full relative accuracy (Demmel and Veselić 1992)
} symmetric_accuracy;

/// The rotation that makes the entry between i and j vanish.
typedef struct symmetric_rotation
{
    double sine;
    double half_tangent; ///< sine / (1 + cosine)
} symmetric_rotation;

static inline void symmetric_turn_rows(size_t n, double *first, double *second, symmetric_rotation r)
{
    for (size_t k = 0; k < n; k++)
    {
        double x = first[k], y = second[k];
        first[k] = x - r.sine * (y + r.half_tangent * x);
        second[k] = y + r.sine * (x - r.half_tangent * y);
    }
}

static inline void symmetric_rotate(size_t n, double *a, double *vectors, size_t i, size_t j)
{
    double ii = a[i * n + i], jj = a[j * n + j], ij = a[i * n + j];
    double gap = jj - ii;
    double tangent = 2 * ij / (gap + copysign(sqrt(gap * gap + 4 * ij * ij), gap));
    double cosine = 1 / sqrt(1 + tangent * tangent);
    symmetric_rotation r = {.sine = tangent * cosine, .half_tangent = tangent * cosine / (1 + cosine)};
    symmetric_turn_rows(n, a + i * n, a + j * n, r);
    for (size_t k = 0; k < n; k++)
    {
        a[k * n + i] = a[i * n + k];
        a[k * n + j] = a[j * n + k];
    }
    a[i * n + i] = ii - tangent * ij;
    a[j * n + j] = jj + tangent * ij;
    a[i * n + j] = a[j * n + i] = 0;
    if (vectors != NULL)
        symmetric_turn_rows(n, vectors + i * n, vectors + j * n, r);
}

/// Makes `a` diagonal: a becomes Q a Q^T, whose diagonal are the eigenvalues, in no order, and row i of `vectors` (may be
/// null) the eigenvector of the i-th. The entries' squares must not overflow.
static inline void symmetric_eigen(size_t n, double *a, double *vectors, symmetric_accuracy accuracy)
{
    double largest = vector_largest(n * n, a);
    for (size_t i = 0; vectors != NULL && i < n * n; i++)
        vectors[i] = i % (n + 1) == 0 ? 1 : 0;
    const double unit = 0.5 * DBL_EPSILON;
    bool settled = false;
    for (int sweep = 0; sweep < SYMMETRIC_MAX_SWEEPS && !settled; sweep++)
    {
        settled = true;
        for (size_t i = 0; i + 1 < n; i++)
            for (size_t j = i + 1; j < n; j++)
            {
                double ij = a[i * n + j],
                       scale = accuracy == SYMMETRIC_BY_NORM ? largest * largest : a[i * n + i] * a[j * n + j];
                if (ij * ij <= unit * unit * fabs(scale))
                    continue;
                symmetric_rotate(n, a, vectors, i, j);
                settled = false;
            }
    }
}
