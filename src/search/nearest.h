#ifndef SEARCH_NEAREST_H
#define SEARCH_NEAREST_H

#include "batten/base.h"

/// @file
/// Exact nearest neighbours in R^n, for everyone: points, or segments between points, under the Euclidean distance or the
/// Euclidean distance times a weight of each item.
///
/// A k-d tree with the items' coordinates copied into the order of its leaves, and a bounding box for each node. Building
/// takes O(n log n), a query O(log n) for items spread along a curve or a surface.

/// One of the items nearest to a query.
typedef struct nearest_hit
{
    size_t item;     ///< its number; of several at the same distance the lowest
    double distance; ///< not squared; times the root of the item's weight
} nearest_hit;

/// What the items are.
typedef enum nearest_kind
{
    NEAREST_POINTS = 1, ///< rows of dim numbers
    NEAREST_SEGMENTS    ///< rows of 2 dim numbers: both ends
} nearest_kind;

/// The tree. It owns its arrays; release it with nearest_free(). Queries do not change it and may run in parallel.
typedef struct nearest_tree
{
    nearest_kind kind;
    size_t count, dim;
    double *coordinates; ///< count rows in leaf order
    double *weights;     ///< count in leaf order, or null: all 1
    size_t *items;       ///< count item numbers in leaf order
    double *boxes;       ///< per node its box: dim lowest, then dim highest coordinates
    double *min_weights; ///< per node, or null
    size_t *min_items;   ///< per node, the lowest item number below it
} nearest_tree;

/// Build the tree over `count` items with coordinates of at most DBL_MAX / 2; they are copied.
/// @param weights that squared distances are multiplied by: count numbers from 1 to 2^60, or null for the plain distance
/// @return BAT_OK or BAT_NO_MEMORY; `tree` is untouched on failure
bat_status nearest_build(nearest_kind kind, const double *coordinates, const double *weights, size_t count, size_t dim,
                         nearest_tree *tree, bat_error *error);
void nearest_free(nearest_tree *tree);

/// The item nearest to a point of dim coordinates of at most DBL_MAX / 2; item BAT_NO_INDEX when the tree is empty.
/// Distances neither overflow nor underflow on the way; one that a double cannot hold is infinite.
nearest_hit nearest_find(const nearest_tree *tree, const double *point);

#endif
