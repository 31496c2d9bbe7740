#ifndef SURFACE_CLOUD_NEIGHBOURS_H
#define SURFACE_CLOUD_NEIGHBOURS_H

#include "batten/base.h"

/// @file
/// Nearest neighbours of points in space by a k-d tree (Bentley, 1975): all points within a radius, or the k nearest points.
/// Results are exact, and sorted independently of the tree.
///
/// The tree stores bounding boxes, and the coordinates in leaf order. Building takes O(n log n).

/// A point and its distance.
typedef struct neighbour
{
    double squared; ///< squared distance
    uint32_t item;  ///< index of the point
} neighbour;

/// Neighbours by ascending distance; ties by index. All zero: empty. It grows as needed and is reused between queries; every
/// thread needs its own.
typedef struct neighbour_list
{
    neighbour *entries;
    size_t count, capacity;
} neighbour_list;

void neighbour_list_free(neighbour_list *list);

/// The bounding box of the points of a node.
typedef struct neighbour_box
{
    double low[3], high[3];
} neighbour_box;

/// The tree. It owns its arrays; release it with neighbour_tree_free(). Queries do not change it and may run in parallel.
typedef struct neighbour_tree
{
    size_t count;
    double *axes[3];      ///< count each, in leaf order; one allocation that begins at axes[0]
    uint32_t *items;      ///< count: indices of the points, in leaf order
    neighbour_box *boxes; ///< boxes of the nodes, in heap order: 1 is the root, 2 n and 2 n + 1 are the children of n: 1 is
                          ///< the root, 2 n and 2 n + 1 are below n
} neighbour_tree;

/// Build the tree. The points are copied.
/// @param points count x 3, finite; squares of differences must not overflow
/// @return BAT_OK, BAT_TOO_LARGE (indices have 32 bits) or BAT_NO_MEMORY; `tree` is untouched on failure
bat_status neighbour_tree_build(const double *points, size_t count, neighbour_tree *tree, bat_error *error);
void neighbour_tree_free(neighbour_tree *tree);

/// All points with squared distance <= radius * radius from a place, including a point at the place itself.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbours_within(const neighbour_tree *tree, const double place[3], double radius, neighbour_list *list,
                             bat_error *error);

/// The `wanted` nearest points, or all when there are fewer.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbours_nearest(const neighbour_tree *tree, const double place[3], size_t wanted, neighbour_list *list,
                              bat_error *error);

#endif
