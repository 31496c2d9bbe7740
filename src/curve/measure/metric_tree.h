#pragma once

#include "batten/space.h"
#include "search/nearest.h"

/// Exact nearest neighbours by geodesic distance in any space: a vantage-point tree (Yianilos 1993), which knows nothing but
/// the triangle inequality. It refers to the caller's points; release it with metric_tree_free().
typedef struct metric_tree
{
    const bat_space *space;
    const double *points; ///< the caller's
    size_t count;
    size_t *items;  ///< count point numbers; the first of a subtree's range is its vantage point
    double *shells; ///< per position 4 distances from the vantage point: least and greatest of the inner half, of the outer
} metric_tree;

/// Build the tree over `count` valid points of a space, in O(n log n) distances.
/// @return BAT_OK or BAT_NO_MEMORY; `tree` is untouched on failure
bat_status metric_tree_build(const bat_space *space, const double *points, size_t count, metric_tree *tree,
                             bat_error *error);
void metric_tree_free(metric_tree *tree);

/// The point nearest to a valid point, with its distance; of several one, always the same. Item BAT_NO_INDEX: no points.
nearest_hit metric_tree_find(const metric_tree *tree, const double *point);
