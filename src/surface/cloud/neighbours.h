#pragma once

#include "batten/base.h"
#include "batten/cloud.h"

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

/// Neighbours by distance, then index. All zero: empty. Reused between queries; every thread needs its own.
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

// Renumbering of a cloud in a k-d tree's leaf order: close interior points have close indices; the boundary stays.

/// The index of a point of the cloud in the input.
static inline size_t cloud_input_index(const bat_cloud *cloud, size_t point)
{
    return cloud->order != NULL ? cloud->order[point] : point;
}

/// Change the numbers of points, also in the triangles. The boundary and the corners are the caller's.
/// @param order the old number of each point
/// @return BAT_OK or BAT_NO_MEMORY; the cloud is untouched on failure
bat_status cloud_permute(bat_cloud *cloud, const size_t *order, bat_error *error);

/// A renumbered cloud.
typedef struct spatial_order
{
    bat_cloud cloud;     ///< points scaled to unit size, triangles, and indices in the input; no corners
    neighbour_tree tree; ///< tree of these points
    uint32_t *places;    ///< count: index of each point in the given cloud
} spatial_order;

/// Renumber a cloud. `order` is all zero on failure.
bat_status spatial_order_make(const bat_cloud *cloud, spatial_order *order, bat_error *error);
void spatial_order_free(spatial_order *order);

// An order of points that depends on their coordinates alone, so that results do not depend on the order of the input.

/// Half the distance from the centre of the bounding box, by which points are sorted.
double canonical_order_key(const double point[3], const double centre[3]);
/// Sort points by their distance from the centre of their bounding box, those at the same distance by their coordinates. The
/// order of a mirrored cloud is the same up to rounding.
/// @param points count x 3, finite
/// @param order  receives the indices of the points, [count]
/// @return BAT_OK or BAT_NO_MEMORY
bat_status canonical_order_find(const double *points, size_t count, size_t *order, bat_error *error);

/// Sort a cloud's points but for its boundary loop; one without corners begins at the first in the canonical order.
/// @return BAT_OK or BAT_NO_MEMORY; the cloud is untouched on failure
bat_status canonical_order_apply(bat_cloud *cloud, bat_error *error);
