#ifndef SURFACE_FIT_TEAM_H
#define SURFACE_FIT_TEAM_H

#include "batten/surface_fit.h"

/// @file
/// Sums and other results over the points of all processes of a fit. A null team is one process alone. Every rank receives
/// each result.

static inline bool team_is_first(const bat_surface_team *team)
{
    return team == NULL || team->rank == 0;
}

/// Every rank receives the bytes of rank 0.
bat_status team_broadcast(const bat_surface_team *team, void *bytes, size_t size, bat_error *error);
/// Every rank receives a status of rank 0, with its text.
bat_status team_agree(const bat_surface_team *team, bat_status status, bat_error *error);

/// Every rank receives the failure of the lowest rank that failed.
bat_status team_agree_all(const bat_surface_team *team, bat_status status, bat_error *error);

/// Rank 0 receives what all ranks have; `sizes` and `all` need free().
bat_status team_gather(const bat_surface_team *team, const void *bytes, size_t size, size_t **sizes, char **all,
                       bat_error *error);

/// Sums over ranks of each number.
bat_status team_sum_counts(const bat_surface_team *team, uint64_t *numbers, size_t count, bat_error *error);
/// The sum over lower ranks.
bat_status team_sum_before(const bat_surface_team *team, uint64_t number, uint64_t *sum, bat_error *error);
/// The largest over ranks of each number.
bat_status team_largest(const bat_surface_team *team, double *numbers, size_t count, bat_error *error);

/// The sum of rows of numbers, first those of rank 0, one row after another.
/// @param rows count x width: one for each block of points
/// @param sums receives `width`
bat_status team_sum_rows(const bat_surface_team *team, const double *rows, size_t count, size_t width, double *sums,
                         bat_error *error);

/// The number of blocks that hold so many points.
static inline size_t team_blocks(size_t points)
{
    return (points + BAT_SURFACE_FIT_BLOCK - 1) / BAT_SURFACE_FIT_BLOCK;
}

/// The sums over points of a few terms: block by block, then over the blocks of all ranks.
/// @param terms adds the terms of a point to `sums` [width]
/// @param width at most TEAM_TERMS
enum
{
    TEAM_TERMS = 8
};
typedef void team_terms(const void *context, size_t row, double *sums);
bat_status team_sum_points(const bat_surface_team *team, size_t points, team_terms *terms, const void *context, size_t width,
                           int threads, double *sums, bat_error *error);

/// The value of this place among those of all ranks in ascending order. Values are not negative.
/// @param place less than the number of all values
bat_status team_select(const bat_surface_team *team, const double *values, size_t count, uint64_t place, double *selected,
                       bat_error *error);

#endif
