#ifndef SURFACE_SPLINE_RUN_SET_H
#define SURFACE_SPLINE_RUN_SET_H

#include "batten/base.h"

/// @file
/// Sets of places of a grid, rows of columns, as runs: sorted by row and column, no two of a row touching. Once numbered, a
/// place's number counts those before it.

/// Columns begin to end - 1 of a row.
typedef struct grid_run
{
    uint32_t row, begin, end;
    uint32_t number; ///< of its first place
} grid_run;

/// All zero: the empty set. Release it with run_set_free(). Calls that return false are out of memory.
typedef struct run_set
{
    grid_run *runs;
    size_t count, capacity;
} run_set;

void run_set_free(run_set *set);

/// Add a run behind all others; where it touches or overlaps the last one it prolongs that.
bool run_set_append(run_set *set, uint32_t row, uint32_t begin, uint32_t end);
/// Bring runs that were added in any order, and may touch or overlap, into order.
void run_set_sort(run_set *set);
/// The number of places.
uint64_t run_set_size(const run_set *set);
/// Number the places from `first` on; the last number fits 32 bits.
void run_set_number(run_set *set, uint32_t first);

/// The first run that does not end before a place or at it, or `count`.
size_t run_set_lower_bound(const run_set *set, uint32_t row, uint32_t column);
/// The same, tried first at and behind `*near`, where the last search ended, and keeping the place: for searches in order.
size_t run_set_lower_bound_from(const run_set *set, uint32_t row, uint32_t column, size_t *hint);
/// The number of a place, or UINT32_MAX.
uint32_t run_set_find(const run_set *set, uint32_t row, uint32_t column);

bool run_set_unite(const run_set *a, const run_set *b, run_set *both);
bool run_set_subtract(const run_set *from, const run_set *what, run_set *rest);
/// The places of a grid half as fine that a set is made of: its rows and columns come in pairs.
bool run_set_halve(const run_set *set, run_set *coarse);

/// Of the functions of a clamped grid of width x height cells and bidegree `degree` those whose support lies in a set of
/// cells: the support of function (i, j) is columns i - degree[0] to i and rows j - degree[1] to j, as far as they are of
/// the grid.
bool run_set_supports(const run_set *cells, const uint32_t size[2], const int degree[2], run_set *functions);

/// Past the last run; null for a set that never had any, as its first is.
static inline const grid_run *run_set_end(const run_set *set)
{
    return set->runs != NULL ? set->runs + set->count : NULL;
}

#endif
