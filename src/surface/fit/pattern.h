#ifndef SURFACE_FIT_PATTERN_H
#define SURFACE_FIT_PATTERN_H

#include "batten/spline_hierarchical.h"

/// @file
/// Which functions of a space meet on a cell, and sums over cells into matrices of that pattern.

/// The lower triangle of a symmetric matrix by columns, diagonal first, rows rising. Release it with fit_pattern_free().
typedef struct fit_pattern
{
    size_t functions;
    int *first; ///< functions + 1
    int *row;
} fit_pattern;

bat_status fit_pattern_make(const bat_hierarchical_space *space, int threads, fit_pattern *pattern, bat_error *error);
void fit_pattern_free(fit_pattern *pattern);

/// What a cell adds: its part of a symmetric matrix, active x active (the lower triangle is read), and of right-hand sides,
/// active x columns.
typedef struct fit_cell_work
{
    /// Fill `matrix` (null when none is wanted) and `right` (null when there are no columns) for a cell.
    void (*fill)(const void *context, size_t cell, double *scratch, double *matrix, double *right);
    const void *context;
    size_t scratch;    ///< numbers of room that `fill` wants
    size_t columns;    ///< of right-hand sides
    double operations; ///< of arithmetic that `fill` takes for all cells beside those to extract and add, roughly
    double *values;    ///< of the matrix, receives the sum over all cells; null: none wanted
    double *right;     ///< functions x columns, receives the sum; null: none
} fit_cell_work;

/// Sum over all cells, in their order whatever the number of threads.
bat_status fit_pattern_sum(const fit_pattern *pattern, const bat_hierarchical_space *space, const fit_cell_work *work,
                           int threads, bat_error *error);

#endif
