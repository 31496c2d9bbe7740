#pragma once

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

/// transposed = matrix^T, rows with rising columns.
bat_status sparse_rows_transpose(const sparse_rows *matrix, sparse_rows *transposed, bat_error *error);

// Systems whose unknowns are averages of each other and of something given: x_i = sum_k w_ik x_k + c_i with w_ik >= 0, w_ii
// = 0 and sum_k w_ik <= 1, each unknown joined by some chain of weights to one whose sum is below 1. The matrix I - W is
// then an M-matrix: there is one solution, and where the c_i are the missing shares of given values, it lies within their
// range.

/// Solve for two columns at once by an LU decomposition, without pivoting, which M-matrices do not need.
/// @param weights  count x count
/// @param constant count x 2
/// @param x        receives count x 2
/// @return BAT_OK, BAT_NO_CONVERGENCE for a singular system, BAT_NO_MEMORY, BAT_TOO_LARGE
bat_status average_solve(const sparse_rows *weights, const double *constant, double *x, bat_error *error);
