#ifndef LINALG_AVERAGE_HIERARCHY_H
#define LINALG_AVERAGE_HIERARCHY_H

#include "linalg/sparse_rows.h"

/// @file
/// An approximate inverse of I - W by smoothed aggregation (Vaněk, Mandel and Brezina 1996): unknowns are gathered around
/// some of them; a correction is constant on each gathering, smoothed once; a coarser level's equations are the sums over
/// gatherings. One cycle is a sweep of Gauss and Seidel forward, the correction from the coarser level, and a sweep
/// backward. All vectors have two columns.

typedef struct average_level
{
    sparse_rows matrix;       ///< the diagonal first in each row
    sparse_rows prolongation; ///< to this level from the next coarser one; none on the last
    uint32_t *gathering;      ///< of each unknown: its number on the next coarser level
    double *right;            ///< count x 2 each: what the cycle has to undo here, its result, and the rest;
    double *result;           ///< the finest level's right side and result are the caller's
    double *rest;
} average_level;

enum
{
    AVERAGE_LEVELS = 24,
    AVERAGE_BLOCK =
        16384,            ///< rows that a sweep goes through one after the other; blocks do not see each other's new numbers
    AVERAGE_COARSEST = 48 ///< unknowns that are solved for densely
};

typedef struct average_hierarchy
{
    average_level levels[AVERAGE_LEVELS];
    size_t level_count;
    double *dense; ///< the LU decomposition of the last level, row-major
    size_t *pivots;
    int threads; ///< of the cycle; the result is the same
} average_hierarchy;

/// @return BAT_OK, BAT_NO_CONVERGENCE where unknowns cannot be gathered or the coarsest matrix is singular, BAT_NO_MEMORY
bat_status average_hierarchy_build(const sparse_rows *weights, int threads, average_hierarchy *hierarchy, bat_error *error);
void average_hierarchy_free(average_hierarchy *hierarchy);

/// result = roughly (I - W)^-1 right, linear in `right`.
void average_hierarchy_cycle(average_hierarchy *hierarchy, const double *right, double *result);

#endif
