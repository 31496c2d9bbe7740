#ifndef SURFACE_SPLINE_BOX_TREE_H
#define SURFACE_SPLINE_BOX_TREE_H

#include "batten/base.h"

/// @file
/// The level of every cell of the square: a k-d tree of boxes with levels, after Kiss, Giannelli and Jüttler, "Algorithms
/// and data structures for truncated hierarchical B-splines" (2014).
///
/// Coordinates are integers from 0 to the size of the square. A box is cut at the interior integer divisible by the highest
/// power of two. The depth is therefore at most twice the number of binary digits of the size, for any order of insertions,
/// and cuts follow the dyadic grids.

/// The integer box [low, high).
typedef struct box_tree_area
{
    uint64_t low[2], high[2];
} box_tree_area;

/// A node: an inner node with a cut, or a leaf with a level.
typedef struct box_tree_node
{
    uint64_t cut;      ///< first coordinate of the upper child
    uint32_t child[2]; ///< indices of the children; 0, 0 for a leaf
    uint8_t axis;      ///< axis of the cut
    uint8_t level;     ///< level of a leaf
} box_tree_node;

/// The tree; node 0 is the root. Release it with box_tree_free().
typedef struct box_tree
{
    box_tree_node *nodes;
    size_t count, capacity;
    uint64_t size[2];
} box_tree;

/// Make a tree with one box of level 0. Both sizes are positive.
bat_status box_tree_make(uint64_t width, uint64_t height, box_tree *tree, bat_error *error);
/// A compact copy: without unused nodes, in depth-first order.
bat_status box_tree_copy(const box_tree *tree, box_tree *copy, bat_error *error);
void box_tree_free(box_tree *tree);

/// Raise all of an area to at least `level`.
/// @return BAT_OK, or BAT_NO_MEMORY with the area partly raised
bat_status box_tree_raise(box_tree *tree, const box_tree_area *area, uint8_t level, bat_error *error);

/// Whether all of an area has at least the level `level`.
bool box_tree_reaches(const box_tree *tree, const box_tree_area *area, uint8_t level);
/// The level at (x, y).
uint8_t box_tree_level(const box_tree *tree, uint64_t x, uint64_t y);

/// A box of constant level.
typedef struct box_tree_leaf
{
    box_tree_area area;
    uint8_t level;
} box_tree_leaf;

/// List the boxes of the leaves, which tile the square.
/// @param leaves receives an array from malloc()
bat_status box_tree_leaves(const box_tree *tree, box_tree_leaf **leaves, size_t *count, bat_error *error);

#endif
