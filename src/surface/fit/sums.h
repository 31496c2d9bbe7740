#ifndef SURFACE_FIT_SUMS_H
#define SURFACE_FIT_SUMS_H

#include "surface/group.h"

#include "batten/surface_fit.h"

/// @file
/// Sums and other results over the points of all processes of a fit, which are the same for any number of them: points are
/// in blocks, whose sums are added in their order. Every rank receives each result.

/// The sum of rows of numbers, first those of rank 0, one row after another.
/// @param rows count x width: one for each block of points
/// @param sums receives `width`
bat_status fit_sum_rows(const bat_group *group, const double *rows, size_t count, size_t width, double *sums,
                        bat_error *error);

/// The number of blocks that hold so many points.
static inline size_t fit_blocks(size_t points)
{
    return (points + BAT_SURFACE_FIT_BLOCK - 1) / BAT_SURFACE_FIT_BLOCK;
}

/// The sums over points of a few terms: block by block, then over the blocks of all ranks.
/// @param terms adds the terms of a point to `sums` [width]
/// @param width at most FIT_TERMS
enum
{
    FIT_TERMS = 8
};
typedef void fit_terms(const void *context, size_t row, double *sums);
bat_status fit_sum_points(const bat_group *group, size_t points, fit_terms *terms, const void *context, size_t width,
                          int threads, double *sums, bat_error *error);

/// The value of this place among those of all ranks in ascending order. Values are not negative.
/// @param place less than the number of all values
bat_status fit_select(const bat_group *group, const double *values, size_t count, uint64_t place, double *selected,
                      bat_error *error);

#endif
