#pragma once

#include "base/memory.h"

#include <float.h>
#include <stddef.h>

/// A number and what it belongs to; ordered by key, then by item.
typedef struct keyed
{
    double key;
    size_t item;
} keyed;

/// Reorder the entries so that entry `nth` is the one that sorting would put there, none before it is greater and none
/// behind it is smaller. The items must differ. Expected time O(count), whatever the keys.
void select_nth(keyed *entries, size_t count, size_t nth);

// Squared Euclidean distances for any finite coordinates up to DBL_MAX / 2. Squares leave the range of a double long before
// their roots do, so every function takes a power of two, `scale`, that differences are multiplied by: 1 first, and where
// segment_scale() says so, once more by another.

/// The scale to measure with, given what came out with scale 1: 1 where that is good.
static inline double segment_scale(double squared)
{
    return squared < 0x1p-900 ? 0x1p600 : squared <= DBL_MAX ? 1 : 0x1p-600;
}

/// From p to q.
static inline double point_squared(const double *p, const double *q, size_t dim, double scale)
{
    double sum = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double difference = (p[axis] - q[axis]) * scale;
        sum += difference * difference;
    }
    return sum;
}

/// segment_share() for segments of any length, and of length 0.
double segment_share_of_any(const double *a, const double *b, const double *point, size_t dim);

/// Where on the segment from `a` to `b` it is nearest to the point: 0 at `a`, 1 at `b`.
static inline double segment_share(const double *a, const double *b, const double *point, size_t dim)
{
    double along = 0, squared = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double side = b[axis] - a[axis];
        along += (point[axis] - a[axis]) * side;
        squared += side * side;
    }
    // Elsewhere one of the two sums may have left the range, or lost digits at its lower end.
    if (!(squared >= 0x1p-200 && squared <= 0x1p900 && along >= -DBL_MAX && along <= DBL_MAX))
        return segment_share_of_any(a, b, point, dim);
    return along <= 0 ? 0 : along >= squared ? 1 : along / squared;
}

/// From the segment from `a` to `b` to the point.
static inline double segment_squared(const double *a, const double *b, const double *point, size_t dim, double scale)
{
    double share = segment_share(a, b, point, dim);
    if (share == 0 || share == 1)
        return point_squared(share == 0 ? a : b, point, dim, scale);
    double sum = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double difference = ((point[axis] - a[axis]) - share * (b[axis] - a[axis])) * scale;
        sum += difference * difference;
    }
    return sum;
}

// Exact nearest neighbours in R^n, for everyone: points, or segments between points, under the Euclidean distance or the
// Euclidean distance times a weight of each item.
//
// A k-d tree (Bentley, 1975) with the items' coordinates copied into the order of its leaves, and a bounding box for each
// node. Building takes O(n log n), a query O(log n) for items spread along a curve or a surface.

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
    memory_pool pool;    ///< of all arrays
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

/// The bounding box of all items: dim lowest, then dim highest coordinates.
static inline const double *nearest_bounds(const nearest_tree *tree)
{
    return tree->boxes + 2 * tree->dim;
}

// Of points in R^3: all within a radius, or the k nearest. Results are exact and do not depend on the order of the points.

/// A point and its distance.
typedef struct neighbour
{
    double squared; ///< squared distance
    uint32_t item;  ///< index of the point
} neighbour;

/// Neighbours by distance, then index. All zero: empty. Reused between queries; every thread needs its own.
typedef struct neighbour_list
{
    neighbour *entries;
    size_t count, capacity;
} neighbour_list;

void neighbour_list_free(neighbour_list *list);

/// Build the tree over points.
/// @param points count x 3, finite; squares of differences must not overflow
/// @return BAT_OK, BAT_TOO_LARGE (indices have 32 bits) or BAT_NO_MEMORY; `tree` is untouched on failure
bat_status neighbours_build(const double *points, size_t count, nearest_tree *tree, bat_error *error);

/// All points with squared distance <= radius * radius from a place, including a point at the place itself.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbours_within(const nearest_tree *tree, const double place[3], double radius, neighbour_list *list,
                             bat_error *error);

/// The `wanted` nearest points, or all when there are fewer.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbours_nearest(const nearest_tree *tree, const double place[3], size_t wanted, neighbour_list *list,
                              bat_error *error);
