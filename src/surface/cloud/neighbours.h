#ifndef SURFACE_CLOUD_NEIGHBOURS_H
#define SURFACE_CLOUD_NEIGHBOURS_H

#include "batten/base.h"

/// @file
/// Which points of a cloud in space lie near a place: all within a radius, the nearest k, or, for every point, its
/// neighbours within a radius at once. All answers are exact, and in an order that depends on nothing but the points.
///
/// A k-d tree of boxes with the coordinates copied into the order of its leaves. Building takes O(n log n).

/// A point of the cloud and how far it is.
typedef struct neighbour
{
    double squared; ///< distance
    uint32_t item;  ///< the point's number
} neighbour;

/// Neighbours in order of their squared distance; of equal ones the lowest number first. All zero: empty. It grows as needed
/// and serves any number of queries, one after the other; every thread needs its own.
typedef struct neighbour_list
{
    neighbour *entries;
    size_t count, capacity;
} neighbour_list;

void neighbour_list_free(neighbour_list *list);

/// A box around the points below a node.
typedef struct neighbour_box
{
    double low[3], high[3];
} neighbour_box;

/// The tree. It owns its arrays; release it with neighbour_tree_free(). Queries do not change it and may run in parallel.
typedef struct neighbour_tree
{
    size_t count;
    double *axes[3];      ///< count each, in leaf order; one allocation that begins at axes[0]
    uint32_t *items;      ///< count: the points' numbers, in leaf order
    neighbour_box *boxes; ///< of the nodes, numbered as in a heap: 1 is the root, 2 n and 2 n + 1 are below n
} neighbour_tree;

/// Build the tree over points, which are copied.
/// @param points count x 3, finite; squares of their differences must fit a double
/// @return BAT_OK, BAT_TOO_LARGE (numbers of points have 32 bits) or BAT_NO_MEMORY; `tree` is untouched on failure
bat_status neighbour_tree_build(const double *points, size_t count, neighbour_tree *tree, bat_error *error);
void neighbour_tree_free(neighbour_tree *tree);

/// All points whose squared distance from a place is not above radius * radius, the place itself among them when it is a
/// point of the tree.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbours_within(const neighbour_tree *tree, const double place[3], double radius, neighbour_list *list,
                             bat_error *error);

/// The `wanted` nearest points, or all when there are fewer.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbours_nearest(const neighbour_tree *tree, const double place[3], size_t wanted, neighbour_list *list,
                              bat_error *error);

/// The neighbours of all points: those of point i are items[starts[i]] … items[starts[i + 1] - 1], rising, itself among
/// them.
typedef struct neighbour_graph
{
    size_t *starts; ///< count + 1
    uint32_t *items;
    size_t count;
} neighbour_graph;

/// Join every point with all points within a radius of it. One pass over the leaves, much faster than a query for each
/// point.
/// @return BAT_OK or BAT_NO_MEMORY; `graph` is untouched on failure
bat_status neighbour_graph_build(const neighbour_tree *tree, double radius, neighbour_graph *graph, bat_error *error);
void neighbour_graph_free(neighbour_graph *graph);

#endif
