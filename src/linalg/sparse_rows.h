#ifndef LINALG_SPARSE_ROWS_H
#define LINALG_SPARSE_ROWS_H

#include "batten/base.h"

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

#endif
