/// @file
/// k-d tree of boxes with levels; see hierarchical_space.h.

#include "surface/spline/hierarchical_space.h"

#include "base/array_grow.h"
#include "base/error.h"

static bool is_leaf(const box_tree_node *node)
{
    return node->child[0] == 0;
}

static box_tree_area complete(const box_tree *tree)
{
    return (box_tree_area){{0, 0}, {tree->size[0], tree->size[1]}};
}

/// The half of an area below (side 0) or above (side 1) a node's cut.
static box_tree_area half_of(const box_tree_area *area, const box_tree_node *node, int side)
{
    box_tree_area half = *area;
    *(side == 0 ? &half.high[node->axis] : &half.low[node->axis]) = node->cut;
    return half;
}

/// Whether an area intersects a side of a node's cut.
static bool meets(const box_tree_area *area, const box_tree_node *node, int side)
{
    return side == 0 ? area->low[node->axis] < node->cut : area->high[node->axis] > node->cut;
}

/// Whether an edge of `area` lies strictly inside `bounds`.
static bool crosses(const box_tree_area *area, const box_tree_area *bounds, int axis)
{
    return area->low[axis] > bounds->low[axis] || area->high[axis] < bounds->high[axis];
}

bat_status box_tree_make(uint64_t width, uint64_t height, box_tree *tree, bat_error *error)
{
    *tree = (box_tree){.count = 1, .size = {width, height}};
    if (!ARRAY_GROW(tree->nodes, tree->capacity, 1))
        return error_memory(error, sizeof *tree->nodes);
    tree->nodes[0] = (box_tree_node){0};
    return BAT_OK;
}

/// Copy a subtree to node `to`; descendants are appended.
static void copy_node(const box_tree *tree, uint32_t from, box_tree *copy, uint32_t to)
{
    box_tree_node node = tree->nodes[from];
    copy->nodes[to] = node;
    if (is_leaf(&node))
        return;
    for (uint32_t side = 0; side < 2; side++)
    {
        uint32_t child = (uint32_t)copy->count++;
        copy->nodes[to].child[side] = child;
        copy_node(tree, node.child[side], copy, child);
    }
}

bat_status box_tree_copy(const box_tree *tree, box_tree *copy, bat_error *error)
{
    *copy = (box_tree){.size = {tree->size[0], tree->size[1]}};
    if (!ARRAY_GROW(copy->nodes, copy->capacity, tree->count))
        return error_memory(error, tree->count * sizeof *copy->nodes);
    copy->count = 1;
    copy_node(tree, 0, copy, 0);
    return BAT_OK;
}

void box_tree_free(box_tree *tree)
{
    free(tree->nodes);
    *tree = (box_tree){0};
}

/// Cut a leaf that an edge of `area` crosses; along the longer side if both axes qualify.
static bool cut_leaf(box_tree *tree, uint32_t leaf, const box_tree_area *bounds, const box_tree_area *area)
{
    bool x = crosses(area, bounds, 0), y = crosses(area, bounds, 1);
    bool wide = bounds->high[0] - bounds->low[0] >= bounds->high[1] - bounds->low[1];
    uint8_t axis = y && (!x || !wide);
    if (tree->count > UINT32_MAX - 2 || !ARRAY_GROW(tree->nodes, tree->capacity, tree->count + 2))
        return false;
    box_tree_node *node = &tree->nodes[leaf];
    // Cut at the number strictly between the bounds that the highest power of two divides.
    uint64_t last = bounds->high[axis] - 1;
    int digit = 63 - __builtin_clzll(bounds->low[axis] ^ last);
    *node = (box_tree_node){.cut = last >> digit << digit, .axis = axis, .level = node->level};
    for (int side = 0; side < 2; side++)
    {
        node->child[side] = (uint32_t)tree->count;
        tree->nodes[tree->count++] = (box_tree_node){.level = node->level};
    }
    return true;
}

/// Merge two leaves of the same level into their parent.
static void join_children(box_tree *tree, uint32_t index)
{
    box_tree_node *node = &tree->nodes[index], *lower = &tree->nodes[node->child[0]], *upper = &tree->nodes[node->child[1]];
    if (!is_leaf(lower) || !is_leaf(upper) || lower->level != upper->level)
        return;
    uint8_t level = lower->level;
    if (node->child[1] + 1 == tree->count && node->child[0] + 2 == tree->count)
        tree->count -= 2;
    *node = (box_tree_node){.level = level};
}

static bool raise_node(box_tree *tree, uint32_t index, const box_tree_area *bounds, const box_tree_area *area, uint8_t level)
{
    box_tree_node *node = &tree->nodes[index];
    if (is_leaf(node))
    {
        if (node->level >= level)
            return true;
        if (!crosses(area, bounds, 0) && !crosses(area, bounds, 1))
        {
            node->level = level;
            return true;
        }
        if (!cut_leaf(tree, index, bounds, area))
            return false;
    }
    for (int side = 0; side < 2; side++)
    {
        const box_tree_node *cut = &tree->nodes[index];
        box_tree_area half = half_of(bounds, cut, side);
        if (meets(area, cut, side) && !raise_node(tree, cut->child[side], &half, area, level))
            return false;
    }
    join_children(tree, index);
    return true;
}

bat_status box_tree_raise(box_tree *tree, const box_tree_area *area, uint8_t level, bat_error *error)
{
    box_tree_area bounds = complete(tree);
    return raise_node(tree, 0, &bounds, area, level) ? BAT_OK : error_memory(error, tree->count * sizeof *tree->nodes);
}

static bool reaches(const box_tree *tree, uint32_t index, const box_tree_area *area, uint8_t level)
{
    const box_tree_node *node = &tree->nodes[index];
    if (is_leaf(node))
        return node->level >= level;
    return (!meets(area, node, 0) || reaches(tree, node->child[0], area, level)) &&
           (!meets(area, node, 1) || reaches(tree, node->child[1], area, level));
}

bool box_tree_reaches(const box_tree *tree, const box_tree_area *area, uint8_t level)
{
    return reaches(tree, 0, area, level);
}

uint8_t box_tree_level(const box_tree *tree, uint64_t x, uint64_t y)
{
    const box_tree_node *node = tree->nodes;
    while (!is_leaf(node))
        node = &tree->nodes[node->child[(node->axis == 0 ? x : y) >= node->cut]];
    return node->level;
}

static box_tree_leaf *collect(const box_tree *tree, uint32_t index, const box_tree_area *bounds, box_tree_leaf *next)
{
    const box_tree_node *node = &tree->nodes[index];
    if (is_leaf(node))
    {
        *next = (box_tree_leaf){*bounds, node->level};
        return next + 1;
    }
    for (int side = 0; side < 2; side++)
    {
        box_tree_area half = half_of(bounds, node, side);
        next = collect(tree, node->child[side], &half, next);
    }
    return next;
}

bat_status box_tree_leaves(const box_tree *tree, box_tree_leaf **leaves, size_t *count, bat_error *error)
{
    box_tree_leaf *made = memory_array(tree->count / 2 + 1, sizeof *made);
    if (made == NULL)
        return error_memory(error, tree->count / 2 * sizeof *made);
    box_tree_area bounds = complete(tree);
    *count = (size_t)(collect(tree, 0, &bounds, made) - made);
    *leaves = made;
    return BAT_OK;
}
