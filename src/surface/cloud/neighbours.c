/// @file
/// k-d tree for points in space; see neighbours.h. The points of a node are consecutive in leaf order; the first child has
/// the lower half.

#include "surface/cloud/neighbours.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "base/memory.h"
#include "search/nearest.h"

#include <math.h>

// A node's points are consecutive in leaf order; its first child holds the lower half of them.

enum
{
    ROOT = 1,
    LEAF_ITEMS = 16,
    MAX_DEPTH = 40,
    /// Up to this many entries are sorted by insertion.
    FEW_ENTRIES = 48
};

typedef struct node_range
{
    size_t node, begin, end;
} node_range;

static node_range lower_child(node_range range)
{
    return (node_range){2 * range.node, range.begin, range.begin + (range.end - range.begin) / 2};
}

static node_range upper_child(node_range range)
{
    return (node_range){2 * range.node + 1, range.begin + (range.end - range.begin) / 2, range.end};
}

static bool is_leaf(node_range range)
{
    return range.end - range.begin <= LEAF_ITEMS;
}

void neighbour_list_free(neighbour_list *list)
{
    free(list->entries);
    *list = (neighbour_list){0};
}

void neighbour_tree_free(neighbour_tree *tree)
{
    free(tree->axes[0]);
    free(tree->items);
    free(tree->boxes);
    *tree = (neighbour_tree){0};
}

typedef struct tree_builder
{
    neighbour_tree *tree;
    const double *points;
    keyed *entries;
} tree_builder;

static neighbour_box box_around(const tree_builder *build, size_t begin, size_t end)
{
    neighbour_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = begin; i < end; i++)
    {
        const double *point = build->points + 3 * build->entries[i].item;
        for (int axis = 0; axis < 3; axis++)
        {
            box.low[axis] = point[axis] < box.low[axis] ? point[axis] : box.low[axis];
            box.high[axis] = point[axis] > box.high[axis] ? point[axis] : box.high[axis];
        }
    }
    return box;
}

/// Split the points of a node at the median along the longest side of their box, recursively down to the leaves.
static void arrange(const tree_builder *build, node_range range)
{
    neighbour_box box = box_around(build, range.begin, range.end);
    build->tree->boxes[range.node] = box;
    if (is_leaf(range))
        return;
    size_t widest = 0;
    for (size_t axis = 1; axis < 3; axis++)
        if (box.high[axis] - box.low[axis] > box.high[widest] - box.low[widest])
            widest = axis;
    for (size_t i = range.begin; i < range.end; i++)
        build->entries[i].key = build->points[3 * build->entries[i].item + widest];
    select_nth(build->entries + range.begin, range.end - range.begin, (range.end - range.begin) / 2);
    arrange(build, lower_child(range));
    arrange(build, upper_child(range));
}

/// The number of heap indices for `count` points.
static size_t node_capacity(size_t count)
{
    size_t leaves = 1;
    for (size_t largest = count; largest > LEAF_ITEMS; largest = largest / 2 + largest % 2)
        leaves *= 2;
    return 2 * leaves;
}

static bool allocate_tree(neighbour_tree *tree)
{
    size_t numbers;
    if (size_multiply_overflows(tree->count, 3, &numbers))
        return false;
    tree->axes[0] = memory_array(numbers, sizeof(double));
    tree->items = memory_array(tree->count, sizeof *tree->items);
    tree->boxes = memory_array(node_capacity(tree->count), sizeof *tree->boxes);
    return tree->axes[0] != NULL && tree->items != NULL && tree->boxes != NULL;
}

bat_status neighbour_tree_build(const double *points, size_t count, neighbour_tree *tree, bat_error *error)
{
    if (count > UINT32_MAX)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "there are %zu points, more than %u", count, UINT32_MAX);
    neighbour_tree made = {.count = count};
    tree_builder build = {&made, points, memory_array(count, sizeof(keyed))};
    if (!allocate_tree(&made) || build.entries == NULL)
    {
        neighbour_tree_free(&made);
        free(build.entries);
        return error_memory(error, count * (sizeof(keyed) + 3 * sizeof(double)));
    }
    for (size_t i = 0; i < count; i++)
        build.entries[i] = (keyed){0, i};
    arrange(&build, (node_range){ROOT, 0, count});
    for (int axis = 1; axis < 3; axis++)
        made.axes[axis] = made.axes[axis - 1] + count;
    for (size_t i = 0; i < count; i++)
    {
        size_t item = build.entries[i].item;
        made.items[i] = (uint32_t)item;
        for (int axis = 0; axis < 3; axis++)
            made.axes[axis][i] = points[3 * item + (size_t)axis];
    }
    free(build.entries);
    *tree = made;
    return BAT_OK;
}

/// Squared distance from a box, a lower bound for its points also in floating point: each rounding error is at most the
/// corresponding one in leaf_distances().
static inline double box_squared(const neighbour_box *box, const double place[3])
{
    double gaps[3];
    for (int axis = 0; axis < 3; axis++)
    {
        double below = box->low[axis] - place[axis], above = place[axis] - box->high[axis];
        double gap = below > above ? below : above;
        gaps[axis] = gap > 0 ? gap : 0;
    }
    return gaps[0] * gaps[0] + gaps[1] * gaps[1] + gaps[2] * gaps[2];
}

static inline void leaf_distances(const neighbour_tree *tree, size_t begin, size_t count, const double place[3],
                                  double squared[LEAF_ITEMS])
{
    const double *x = tree->axes[0] + begin, *y = tree->axes[1] + begin, *z = tree->axes[2] + begin;
    for (size_t i = 0; i < count; i++)
    {
        double dx = x[i] - place[0], dy = y[i] - place[1], dz = z[i] - place[2];
        squared[i] = dx * dx + dy * dy + dz * dz;
    }
}

static inline bool precedes(neighbour a, neighbour b)
{
    return a.squared < b.squared || (a.squared == b.squared && a.item < b.item);
}

/// Restore the max-heap property below index `at`.
static void sift_down(neighbour *heap, size_t count, size_t at)
{
    neighbour entry = heap[at];
    for (size_t child = 2 * at + 1; child < count; child = 2 * at + 1)
    {
        child += child + 1 < count && precedes(heap[child], heap[child + 1]);
        if (!precedes(entry, heap[child]))
            break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = entry;
}

static void heap_make(neighbour *entries, size_t count)
{
    for (size_t at = count / 2; at-- > 0;)
        sift_down(entries, count, at);
}

static void heap_sort(neighbour *heap, size_t count)
{
    while (count > 1)
    {
        neighbour greatest = heap[0];
        heap[0] = heap[--count];
        heap[count] = greatest;
        sift_down(heap, count, 0);
    }
}

static void insertion_sort(neighbour *entries, size_t count)
{
    for (size_t i = 1; i < count; i++)
    {
        neighbour entry = entries[i];
        size_t at = i;
        for (; at > 0 && precedes(entry, entries[at - 1]); at--)
            entries[at] = entries[at - 1];
        entries[at] = entry;
    }
}

/// Append the points of a leaf within the radius. False when out of memory.
static bool add_leaf(const neighbour_tree *tree, node_range leaf, const double place[3], double max_squared,
                     neighbour_list *list)
{
    double squared[LEAF_ITEMS];
    size_t count = leaf.end - leaf.begin;
    if (!ARRAY_GROW(list->entries, list->capacity, list->count + count))
        return false;
    leaf_distances(tree, leaf.begin, count, place, squared);
    neighbour *out = list->entries + list->count;
    for (size_t i = 0; i < count; i++)
    {
        *out = (neighbour){squared[i], tree->items[leaf.begin + i]};
        out += squared[i] <= max_squared;
    }
    list->count = (size_t)(out - list->entries);
    return true;
}

bat_status neighbours_within(const neighbour_tree *tree, const double place[3], double radius, neighbour_list *list,
                             bat_error *error)
{
    double max_squared = radius * radius;
    node_range waiting[MAX_DEPTH];
    size_t top = 0;
    list->count = 0;
    waiting[top++] = (node_range){ROOT, 0, tree->count};
    while (top > 0)
    {
        node_range here = waiting[--top];
        if (box_squared(&tree->boxes[here.node], place) > max_squared)
            continue;
        if (!is_leaf(here))
        {
            waiting[top++] = upper_child(here);
            waiting[top++] = lower_child(here);
        }
        else if (!add_leaf(tree, here, place, max_squared, list))
            return error_memory(error, list->capacity * sizeof *list->entries);
    }
    if (list->count > FEW_ENTRIES)
    {
        heap_make(list->entries, list->count);
        heap_sort(list->entries, list->count);
    }
    else
        insertion_sort(list->entries, list->count);
    return BAT_OK;
}

/// A node on the stack of a search.
typedef struct visit
{
    node_range range;
    double bound; ///< lower bound of the squared distances of its points
} visit;

static visit visit_to(const neighbour_tree *tree, node_range range, const double place[3])
{
    return (visit){range, box_squared(&tree->boxes[range.node], place)};
}

/// Update the `wanted` nearest points by those of a leaf. The list becomes a heap once it is full.
static void update_nearest(const neighbour_tree *tree, node_range leaf, const double place[3], size_t wanted,
                           neighbour_list *list)
{
    double squared[LEAF_ITEMS];
    size_t count = leaf.end - leaf.begin;
    leaf_distances(tree, leaf.begin, count, place, squared);
    for (size_t i = 0; i < count; i++)
    {
        neighbour entry = {squared[i], tree->items[leaf.begin + i]};
        if (list->count < wanted)
        {
            list->entries[list->count++] = entry;
            if (list->count == wanted)
                heap_make(list->entries, wanted);
        }
        else if (precedes(entry, list->entries[0]))
        {
            list->entries[0] = entry;
            sift_down(list->entries, wanted, 0);
        }
    }
}

bat_status neighbours_nearest(const neighbour_tree *tree, const double place[3], size_t wanted, neighbour_list *list,
                              bat_error *error)
{
    visit waiting[MAX_DEPTH];
    size_t top = 0;
    list->count = 0;
    wanted = wanted < tree->count ? wanted : tree->count;
    if (wanted == 0)
        return BAT_OK;
    if (!ARRAY_GROW(list->entries, list->capacity, wanted))
        return error_memory(error, wanted * sizeof *list->entries);
    waiting[top++] = visit_to(tree, (node_range){ROOT, 0, tree->count}, place);
    while (top > 0)
    {
        visit here = waiting[--top];
        // A point at the same distance may have a lower index.
        if (list->count == wanted && here.bound > list->entries[0].squared)
            continue;
        if (is_leaf(here.range))
        {
            update_nearest(tree, here.range, place, wanted, list);
            continue;
        }
        visit lower = visit_to(tree, lower_child(here.range), place), upper = visit_to(tree, upper_child(here.range), place);
        bool lower_first = lower.bound <= upper.bound;
        waiting[top++] = lower_first ? upper : lower;
        waiting[top++] = lower_first ? lower : upper;
    }
    if (list->count < wanted)
        heap_make(list->entries, list->count);
    heap_sort(list->entries, list->count);
    return BAT_OK;
}
