#ifndef SURFACE_SPLINE_RUN_SET_H
#define SURFACE_SPLINE_RUN_SET_H

#include "batten/base.h"

/// @file
/// Sets of grid cells or of functions on a grid, stored as runs of columns in rows. Runs are sorted by row and column; runs
/// of a row do not touch. After numbering, the number of an element is `first` plus the number of elements before it.

/// The columns [begin, end) of a row.
typedef struct grid_run
{
    uint32_t row, begin, end;
    uint32_t number; ///< number of the first element
} grid_run;

/// A set. All zero: the empty set. Release it with run_set_free(). Functions that return false are out of memory.
typedef struct run_set
{
    grid_run *runs;
    size_t count, capacity;
} run_set;

void run_set_free(run_set *set);

/// Append a run after all others; merge it with the last one if they touch or overlap.
bool run_set_append(run_set *set, uint32_t row, uint32_t begin, uint32_t end);
/// Sort runs that were appended in any order, and merge those that touch or overlap.
void run_set_sort(run_set *set);
/// The number of elements.
uint64_t run_set_size(const run_set *set);
/// Number the elements consecutively from `first`. The last number must fit into 32 bits.
void run_set_number(run_set *set, uint32_t first);

/// Index of the first run that ends after (row, column), or `count`.
size_t run_set_lower_bound(const run_set *set, uint32_t row, uint32_t column);
/// The same, starting from the result `*hint` of the previous search, and updating it: fast for searches in ascending order.
size_t run_set_lower_bound_from(const run_set *set, uint32_t row, uint32_t column, size_t *hint);
/// The number of an element, or UINT32_MAX if it is not in the set.
uint32_t run_set_find(const run_set *set, uint32_t row, uint32_t column);

/// The union of two sets.
bool run_set_unite(const run_set *a, const run_set *b, run_set *both);
/// The difference of two sets.
bool run_set_subtract(const run_set *from, const run_set *what, run_set *rest);
/// The set on the grid of half the resolution; the rows and columns of `set` come in pairs.
bool run_set_halve(const run_set *set, run_set *coarse);

/// The functions of bidegree `degree` on a clamped grid of size[0] x size[1] cells whose support lies in a set of cells. The
/// support of function (i, j) consists of columns i - degree[0] to i and rows j - degree[1] to j, clipped to the grid.
bool run_set_supports(const run_set *cells, const uint32_t size[2], const int degree[2], run_set *functions);

/// The end of the runs; null for a set without memory.
static inline const grid_run *run_set_end(const run_set *set)
{
    return set->runs != NULL ? set->runs + set->count : NULL;
}

#endif
