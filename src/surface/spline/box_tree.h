#ifndef SURFACE_SPLINE_BOX_TREE_H
#define SURFACE_SPLINE_BOX_TREE_H

#include "batten/base.h"

/// @file
/// Which level a place of the square has: a k-d tree of boxes with levels, after Kiss, Giannelli and Jüttler, "Algorithms
/// and data structures for truncated hierarchical B-splines" (2014). Coordinates are whole numbers, from 0 to the square's
/// size. A box is only ever cut along the line inside of it that the highest power of two divides, so that the tree's depth
/// is at most twice the number of binary digits of the size, in whatever order levels are raised, and cuts follow the grid
/// of the box that made them.

/// Places from low to high - 1.
typedef struct box_tree_area
{
    uint64_t low[2], high[2];
} box_tree_area;

typedef struct box_tree_node
{
    uint64_t cut;      ///< where the upper child begins
    uint32_t child[2]; ///< 0, 0: a leaf
    uint8_t axis;      ///< that the cut is across
    uint8_t level;     ///< of a leaf
} box_tree_node;

/// Release it with box_tree_free(). Node 0 is the root.
typedef struct box_tree
{
    box_tree_node *nodes;
    size_t count, capacity;
    uint64_t size[2];
} box_tree;

/// One area of level 0. Sizes are above 0.
bat_status box_tree_make(uint64_t width, uint64_t height, box_tree *tree, bat_error *error);
/// A copy that wastes nothing: without nodes out of use, in depth-first order.
bat_status box_tree_copy(const box_tree *tree, box_tree *copy, bat_error *error);
void box_tree_free(box_tree *tree);

/// Raise an area to at least a level.
/// @return BAT_OK or BAT_NO_MEMORY, the area then being raised in part
bat_status box_tree_raise(box_tree *tree, const box_tree_area *area, uint8_t level, bat_error *error);

/// Whether all of an area has at least a level.
bool box_tree_reaches(const box_tree *tree, const box_tree_area *area, uint8_t level);
/// The level of a place.
uint8_t box_tree_level(const box_tree *tree, uint64_t x, uint64_t y);

typedef struct box_tree_leaf
{
    box_tree_area area;
    uint8_t level;
} box_tree_leaf;

/// All boxes; they cover the square once.
/// @param leaves receives an array from malloc()
bat_status box_tree_leaves(const box_tree *tree, box_tree_leaf **leaves, size_t *count, bat_error *error);

#endif
