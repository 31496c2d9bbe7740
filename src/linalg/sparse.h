#ifndef LINALG_SPARSE_H
#define LINALG_SPARSE_H

#include "batten/base.h"

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
