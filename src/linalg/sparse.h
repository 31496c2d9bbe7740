#ifndef LINALG_SPARSE_H
#define LINALG_SPARSE_H

#include "batten/base.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/// @file
/// Sparse matrices by rows, and the few products that a hierarchy of them needs. Each result comes out the same on every
/// run.

/// Row i holds values[starts[i]] … values[starts[i + 1] - 1] in the columns of the same places, each column at most once.
typedef struct sparse_rows
{
    size_t row_count;
    size_t column_count; ///< at most UINT32_MAX
    size_t *starts;      ///< row_count + 1
    uint32_t *columns;
    double *values;
} sparse_rows;

/// Room for `entries` entries; the caller fills them.
bat_status sparse_rows_make(size_t row_count, size_t column_count, size_t entries, sparse_rows *matrix, bat_error *error);
void sparse_rows_free(sparse_rows *matrix);

/// product = matrix x for `x` of column_count rows of two numbers, by up to so many threads.
void sparse_rows_apply_pairs(const sparse_rows *matrix, int threads, const double *x, double *product);

/// transposed = matrix^T, rows with rising columns.
bat_status sparse_rows_transpose(const sparse_rows *matrix, sparse_rows *transposed, bat_error *error);

/// product = a b (Gustavson 1978). With `diagonal_first`, an entry on the diagonal is the first of its row.
bat_status sparse_rows_multiply(const sparse_rows *a, const sparse_rows *b, bool diagonal_first, sparse_rows *product,
                                bat_error *error);

// Eigenvalues of small symmetric matrices by Jacobi's cyclic method: whole square matrices of side n, row-major. Inline, so
// that a constant n is unrolled.

enum
{
    /// Jacobi's method ends after six sweeps or so; its last ones converge quadratically.
    SYMMETRIC_MAX_SWEEPS = 40
};

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
    double largest = 0;
    for (size_t i = 0; i < n * n; i++)
        largest = fmax(largest, fabs(a[i]));
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

// Systems whose unknowns are averages of each other and of something given: x_i = sum_k w_ik x_k + c_i with w_ik >= 0, w_ii
// = 0 and sum_k w_ik <= 1, each unknown joined by some chain of weights to one whose sum is below 1. The matrix I - W is
// then an M-matrix: there is one solution, and where the c_i are the missing shares of given values, it lies within their
// range.

/// Solve for two columns at once by an LU decomposition, without pivoting, which M-matrices do not need.
/// @param weights  count x count
/// @param constant count x 2
/// @param x        receives count x 2
/// @return BAT_OK, BAT_NO_CONVERGENCE for a singular system, BAT_NO_MEMORY, BAT_TOO_LARGE
bat_status average_solve_direct(const sparse_rows *weights, const double *constant, double *x, bat_error *error);

/// The same by BiCGSTAB (van der Vorst 1992) over a multilevel cycle, in time and memory in proportion to the entries. Where
/// it does not settle, as on large clouds with noise as wide as their spacing, average_solve_direct() takes over, up to
/// 100,000 unknowns. Unknowns that are joined should lie close to each other in number.
///
/// The largest residual ends up within some units of rounding of the largest number.
/// @param threads as many as OpenMP gives when 0; the result is the same
/// @return BAT_OK, BAT_NO_CONVERGENCE, BAT_NO_MEMORY
bat_status average_solve_iterative(const sparse_rows *weights, const double *constant, int threads, double *x,
                                   bat_error *error);

#endif
