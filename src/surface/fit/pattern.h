#ifndef SURFACE_FIT_PATTERN_H
#define SURFACE_FIT_PATTERN_H

#include "batten/spline.h"

/// @file
/// Sparsity pattern of the Gram matrix of a space, and assembly of matrices with this pattern.
///
/// Entry (i, j) belongs to the pattern when functions i and j both do not vanish on some cell.

/// The lower triangle of a symmetric matrix in compressed columns: diagonal first, rows ascending. Release it with
/// fit_pattern_free().
typedef struct fit_pattern
{
    size_t functions;
    int *first; ///< functions + 1
    int *row;
} fit_pattern;

bat_status fit_pattern_make(const bat_hierarchical_space *space, int threads, fit_pattern *pattern, bat_error *error);
void fit_pattern_free(fit_pattern *pattern);

/// The contribution of a cell: a symmetric active x active matrix (only its lower triangle is read), and active x columns
/// right-hand sides.
typedef struct fit_cell_work
{
    /// Compute the contribution of a cell to `matrix` (null if not requested) and `right` (null without columns).
    void (*fill)(const void *context, size_t cell, double *scratch, double *matrix, double *right);
    /// In place of `fill` where several processes have the data; all of them take part. The first receives the contributions
    /// of cells begin to end - 1, each `matrix`, then `right`.
    /// @param place   offset of each cell in `numbers`
    /// @param numbers null in other processes
    bat_status (*collect)(const void *context, size_t begin, size_t end, const size_t *place, double *numbers,
                          bat_error *error);
    const void *context;
    bool square;       ///< whether a matrix is requested
    size_t scratch;    ///< size of the workspace of `fill`, in numbers
    size_t columns;    ///< number of right-hand sides
    double operations; ///< estimated arithmetic operations of `fill` for all cells
    double *values;    ///< entries of the matrix, receives the sum over all cells
    double *right;     ///< functions x columns, receives the sum; null if not requested
} fit_cell_work;

/// Sum the contributions of all cells. Processes after the first have no pattern, and no sums. The order of summation does
/// not depend on the number of threads.
bat_status fit_pattern_sum(const fit_pattern *pattern, const bat_hierarchical_space *space, const fit_cell_work *work,
                           int threads, bat_error *error);

#endif
