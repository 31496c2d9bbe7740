#include "search/nearest.h"

#include "base/array_grow.h"
#include "base/error.h"

#include <math.h>

// Nodes are numbered as in a heap: node 1 holds all items, the children of node n are 2 n and 2 n + 1. A node's items are
// consecutive in leaf order; its first child holds the lower half of them.

enum
{
    ROOT = 1,
    LEAF_POINTS = 16, ///< of a leaf; a segment has two
    MAX_DEPTH = 64,
    /// Up to this many neighbours are sorted by insertion.
    FEW_ENTRIES = 48
};

static size_t middle_of(size_t begin, size_t end)
{
    return begin + (end - begin) / 2;
}

/// Numbers that store one item.
static size_t item_size(const nearest_tree *tree)
{
    return tree->dim * (size_t)tree->kind;
}

/// Whether so many items are a leaf.
static inline bool is_leaf(const nearest_tree *tree, size_t count)
{
    return count * (size_t)tree->kind <= LEAF_POINTS;
}

static double *box_of(const nearest_tree *tree, size_t node)
{
    return tree->boxes + node * 2 * tree->dim;
}

void nearest_free(nearest_tree *tree)
{
    memory_pool_free(&tree->pool);
    *tree = (nearest_tree){0};
}

/// What building needs: the caller's arrays, and scratch that holds the items in the order reached so far with their keys.
typedef struct builder
{
    nearest_tree *tree;
    const double *coordinates, *weights;
    keyed *entries;
} builder;

/// Fill in what a node knows of its items begin … end - 1. Inlined with constants, its loops over axes unroll.
static inline __attribute__((always_inline)) void describe(const builder *build, size_t node, size_t begin, size_t end,
                                                           size_t dim, size_t size)
{
    const nearest_tree *tree = build->tree;
    double *low = box_of(tree, node), *high = low + dim, min_weight = INFINITY;
    size_t min_item = BAT_NO_INDEX;
    for (size_t axis = 0; axis < dim; axis++)
    {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
    }
    for (size_t i = begin; i < end; i++)
    {
        size_t item = build->entries[i].item;
        const double *row = build->coordinates + item * size;
        for (size_t corner = 0; corner < size; corner += dim)
            for (size_t axis = 0; axis < dim; axis++)
            {
                low[axis] = row[corner + axis] < low[axis] ? row[corner + axis] : low[axis];
                high[axis] = row[corner + axis] > high[axis] ? row[corner + axis] : high[axis];
            }
        min_item = item < min_item ? item : min_item;
        if (build->weights != NULL)
            min_weight = fmin(min_weight, build->weights[item]);
    }
    tree->min_items[node] = min_item;
    if (tree->weights != NULL)
        tree->min_weights[node] = min_weight;
}

/// Order items begin … end - 1 below a node: halve them across the longest side of the box until a leaf holds few.
static void arrange(const builder *build, size_t node, size_t begin, size_t end)
{
    size_t dim = build->tree->dim, size = item_size(build->tree), widest = 0;
    if (dim == 3 && size == 3)
        describe(build, node, begin, end, 3, 3);
    else
        describe(build, node, begin, end, dim, size);
    if (is_leaf(build->tree, end - begin))
        return;
    const double *low = box_of(build->tree, node), *high = low + dim;
    for (size_t axis = 1; axis < dim; axis++)
        if (high[axis] - low[axis] > high[widest] - low[widest])
            widest = axis;
    for (size_t i = begin; i < end; i++)
    {
        const double *row = build->coordinates + build->entries[i].item * size;
        build->entries[i].key = row[widest] * 0.5 + row[size - dim + widest] * 0.5;
    }
    size_t middle = middle_of(begin, end);
    select_nth(build->entries + begin, end - begin, middle - begin);
    arrange(build, 2 * node, begin, middle);
    arrange(build, 2 * node + 1, middle, end);
}

/// Heap numbers up to the deepest level that the items need.
static size_t node_capacity(const nearest_tree *tree)
{
    size_t leaves = 1;
    for (size_t largest = tree->count; !is_leaf(tree, largest); largest = largest / 2 + largest % 2)
        leaves *= 2;
    return 2 * leaves;
}

static bool allocate(nearest_tree *tree, bool weighted)
{
    size_t row, box, nodes = node_capacity(tree);
    if (size_multiply_overflows(item_size(tree), sizeof(double), &row) ||
        size_multiply_overflows(2 * tree->dim, sizeof(double), &box))
        return false;
    tree->coordinates = memory_pool_array(&tree->pool, tree->count, row);
    tree->items = memory_pool_array(&tree->pool, tree->count, sizeof *tree->items);
    tree->boxes = memory_pool_array(&tree->pool, nodes, box);
    tree->min_items = memory_pool_array(&tree->pool, nodes, sizeof *tree->min_items);
    if (weighted)
    {
        tree->weights = memory_pool_array(&tree->pool, tree->count, sizeof *tree->weights);
        tree->min_weights = memory_pool_array(&tree->pool, nodes, sizeof *tree->min_weights);
    }
    return tree->pool.missing == 0;
}

bat_status nearest_build(nearest_kind kind, const double *coordinates, const double *weights, size_t count, size_t dim,
                         nearest_tree *tree, bat_error *error)
{
    nearest_tree made = {.kind = kind, .count = count, .dim = dim};
    builder build = {&made, coordinates, weights, memory_array(count, sizeof(keyed))};
    if (!allocate(&made, weights != NULL) || build.entries == NULL)
    {
        nearest_free(&made);
        free(build.entries);
        return error_memory(error, count * (sizeof(keyed) + item_size(&made) * sizeof(double)));
    }
    for (size_t i = 0; i < count; i++)
        build.entries[i] = (keyed){0, i};
    arrange(&build, ROOT, 0, count);
    size_t size = item_size(&made);
    for (size_t i = 0; i < count; i++)
    {
        size_t item = made.items[i] = build.entries[i].item;
        memcpy(made.coordinates + i * size, coordinates + item * size, size * sizeof *coordinates);
        if (weights != NULL && made.weights != NULL)
            made.weights[i] = weights[item];
    }
    free(build.entries);
    *tree = made;
    return BAT_OK;
}

/// No item of the node is nearer than this. Every rounding here is no greater than its like in point_squared().
static inline double box_squared(const nearest_tree *tree, size_t node, const double *point, size_t dim, double scale)
{
    const double *low = tree->boxes + node * 2 * dim, *high = low + dim;
    double sum = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double below = low[axis] - point[axis], above = point[axis] - high[axis];
        double gap = below > above ? below : above;
        gap = gap > 0 ? gap * scale : 0;
        sum += gap * gap;
    }
    return tree->weights == NULL ? sum : sum * tree->min_weights[node];
}

/// A node that waits to be searched.
typedef struct visit
{
    size_t node, begin, end;
    double bound;
} visit;

/// The children of a node, the nearer one first.
static inline __attribute__((always_inline)) void
visit_children(const nearest_tree *tree, const visit *here, const double *point, size_t dim, double scale, visit children[2])
{
    size_t middle = middle_of(here->begin, here->end), child = 2 * here->node;
    visit lower = {child, here->begin, middle, box_squared(tree, child, point, dim, scale)};
    visit upper = {child + 1, middle, here->end, box_squared(tree, child + 1, point, dim, scale)};
    bool lower_first = lower.bound <= upper.bound;
    children[0] = lower_first ? lower : upper;
    children[1] = lower_first ? upper : lower;
}

/// The best item so far.
typedef struct finding
{
    size_t item, position; ///< its number, and its place in leaf order
    double squared;        ///< distance times scale, squared, times the item's weight
} finding;

static inline bool can_improve(const nearest_tree *tree, const visit *next, const finding *best)
{
    return next->bound < best->squared || (next->bound == best->squared && tree->min_items[next->node] < best->item);
}

static inline void search_leaf(const nearest_tree *tree, const visit *leaf, const double *point, size_t dim, double scale,
                               finding *best)
{
    for (size_t i = leaf->begin; i < leaf->end; i++)
    {
        const double *row = tree->coordinates + i * dim * (size_t)tree->kind;
        double squared = tree->kind == NEAREST_POINTS ? point_squared(row, point, dim, scale)
                                                      : segment_squared(row, row + dim, point, dim, scale);
        if (tree->weights != NULL)
            squared *= tree->weights[i];
        if (squared < best->squared || (squared == best->squared && tree->items[i] < best->item))
            *best = (finding){tree->items[i], i, squared};
    }
}

/// Depth first, the nearer child first. Inlined with a constant `dim`, its loops over axes unroll.
static inline __attribute__((always_inline)) finding search(const nearest_tree *tree, const double *point, size_t dim,
                                                            double scale)
{
    finding best = {BAT_NO_INDEX, 0, INFINITY};
    visit waiting[MAX_DEPTH];
    size_t top = 0;
    waiting[top++] = (visit){ROOT, 0, tree->count, 0};
    while (top > 0)
    {
        visit here = waiting[--top];
        while (can_improve(tree, &here, &best) && !is_leaf(tree, here.end - here.begin))
        {
            visit children[2];
            visit_children(tree, &here, point, dim, scale, children);
            here = children[0];
            waiting[top++] = children[1];
        }
        if (can_improve(tree, &here, &best))
            search_leaf(tree, &here, point, dim, scale, &best);
    }
    return best;
}

/// Where the squares leave the range.
static __attribute__((noinline)) finding search_scaled(const nearest_tree *tree, const double *point, double scale)
{
    return search(tree, point, tree->dim, scale);
}

/// Whether what was found is the point itself, so that its distance of 0 is not an underflow.
static bool is_at(const nearest_tree *tree, const finding *found, const double *point)
{
    if (found->squared > 0 || tree->kind != NEAREST_POINTS)
        return false;
    const double *row = tree->coordinates + found->position * tree->dim;
    for (size_t axis = 0; axis < tree->dim; axis++)
        if (row[axis] != point[axis])
            return false;
    return true;
}

nearest_hit nearest_find(const nearest_tree *tree, const double *point)
{
    finding found = tree->dim == 2   ? search(tree, point, 2, 1)
                    : tree->dim == 3 ? search(tree, point, 3, 1)
                                     : search(tree, point, tree->dim, 1);
    double scale = segment_scale(found.squared);
    if (scale == 1 || tree->count == 0 || is_at(tree, &found, point))
        return (nearest_hit){found.item, sqrt(found.squared)};
    found = search_scaled(tree, point, scale);
    return (nearest_hit){found.item, sqrt(found.squared) / scale};
}

// Neighbours in R^3

void neighbour_list_free(neighbour_list *list)
{
    free(list->entries);
    *list = (neighbour_list){0};
}

bat_status neighbours_build(const double *points, size_t count, nearest_tree *tree, bat_error *error)
{
    if (count > UINT32_MAX)
        return ERROR_TOO_LARGE(error, "there are %zu points, more than %u", count, UINT32_MAX);
    return nearest_build(NEAREST_POINTS, points, NULL, count, 3, tree, error);
}

static inline bool nearer(neighbour a, neighbour b)
{
    return a.squared < b.squared || (a.squared == b.squared && a.item < b.item);
}

/// Restore the max-heap property below index `at`.
static void sift_down(neighbour *heap, size_t count, size_t at)
{
    neighbour entry = heap[at];
    for (size_t child = 2 * at + 1; child < count; child = 2 * at + 1)
    {
        child += child + 1 < count && nearer(heap[child], heap[child + 1]);
        if (!nearer(entry, heap[child]))
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
        for (; at > 0 && nearer(entry, entries[at - 1]); at--)
            entries[at] = entries[at - 1];
        entries[at] = entry;
    }
}

static inline void leaf_distances(const nearest_tree *tree, const visit *leaf, const double place[3],
                                  double squared[LEAF_POINTS])
{
    const double *row = tree->coordinates + 3 * leaf->begin;
    for (size_t i = 0; i < leaf->end - leaf->begin; i++, row += 3)
        squared[i] = point_squared(row, place, 3, 1);
}

/// Append the points of a leaf within the radius. False when out of memory.
static bool add_leaf(const nearest_tree *tree, const visit *leaf, const double place[3], double max_squared,
                     neighbour_list *list)
{
    double squared[LEAF_POINTS];
    size_t count = leaf->end - leaf->begin;
    if (!ARRAY_GROW(list->entries, list->capacity, list->count + count))
        return false;
    leaf_distances(tree, leaf, place, squared);
    neighbour *out = list->entries + list->count;
    for (size_t i = 0; i < count; i++)
    {
        *out = (neighbour){squared[i], (uint32_t)tree->items[leaf->begin + i]};
        out += squared[i] <= max_squared;
    }
    list->count = (size_t)(out - list->entries);
    return true;
}

bat_status neighbours_within(const nearest_tree *tree, const double place[3], double radius, neighbour_list *list,
                             bat_error *error)
{
    double max_squared = radius * radius;
    visit waiting[MAX_DEPTH], children[2];
    size_t top = 0;
    list->count = 0;
    waiting[top++] = (visit){ROOT, 0, tree->count, 0};
    while (top > 0)
    {
        visit here = waiting[--top];
        if (here.bound > max_squared)
            continue;
        if (here.end - here.begin > LEAF_POINTS)
        {
            visit_children(tree, &here, place, 3, 1, children);
            waiting[top++] = children[1];
            waiting[top++] = children[0]; // first, so that the list is almost in order
        }
        else if (!add_leaf(tree, &here, place, max_squared, list))
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

/// Update the `wanted` nearest points by those of a leaf. The list becomes a heap once it is full.
static void update_nearest(const nearest_tree *tree, const visit *leaf, const double place[3], size_t wanted,
                           neighbour_list *list)
{
    double squared[LEAF_POINTS];
    leaf_distances(tree, leaf, place, squared);
    for (size_t i = 0; i < leaf->end - leaf->begin; i++)
    {
        neighbour found = {squared[i], (uint32_t)tree->items[leaf->begin + i]};
        if (list->count < wanted)
        {
            list->entries[list->count++] = found;
            if (list->count == wanted)
                heap_make(list->entries, wanted);
        }
        else if (nearer(found, list->entries[0]))
        {
            list->entries[0] = found;
            sift_down(list->entries, wanted, 0);
        }
    }
}

bat_status neighbours_nearest(const nearest_tree *tree, const double place[3], size_t wanted, neighbour_list *list,
                              bat_error *error)
{
    visit waiting[MAX_DEPTH], children[2];
    size_t top = 0;
    list->count = 0;
    wanted = wanted < tree->count ? wanted : tree->count;
    if (wanted == 0)
        return BAT_OK;
    if (!ARRAY_GROW(list->entries, list->capacity, wanted))
        return error_memory(error, wanted * sizeof *list->entries);
    waiting[top++] = (visit){ROOT, 0, tree->count, 0};
    while (top > 0)
    {
        visit here = waiting[--top];
        // A point at the same distance may have a lower index.
        if (list->count == wanted && here.bound > list->entries[0].squared)
            continue;
        if (here.end - here.begin <= LEAF_POINTS)
        {
            update_nearest(tree, &here, place, wanted, list);
            continue;
        }
        visit_children(tree, &here, place, 3, 1, children);
        waiting[top++] = children[1];
        waiting[top++] = children[0];
    }
    if (list->count < wanted)
        heap_make(list->entries, list->count);
    heap_sort(list->entries, list->count);
    return BAT_OK;
}

// Selection

static bool precedes(keyed a, keyed b)
{
    return a.key < b.key || (a.key == b.key && a.item < b.item);
}

/// A place for the pivot that no arrangement of keys foresees (splitmix64's mixing).
static size_t pivot_place(size_t begin, size_t end)
{
    uint64_t z = (uint64_t)begin * 0x9e3779b97f4a7c15u + (uint64_t)end;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return begin + (size_t)((z ^ (z >> 31)) % (end - begin));
}

/// Split entries begin … end - 1, at least two, in two parts that are not empty; those in the first are not greater than a
/// pivot, those in the second not smaller (Hoare's partition). Returns where the second begins.
static size_t partition(keyed *entries, size_t begin, size_t end)
{
    keyed pivot = entries[pivot_place(begin, end)];
    size_t low = begin, high = end - 1;
    for (;;)
    {
        while (precedes(entries[low], pivot))
            low++;
        while (precedes(pivot, entries[high]))
            high--;
        if (low >= high)
            return low == begin ? begin + 1 : low;
        keyed kept = entries[low];
        entries[low++] = entries[high];
        entries[high--] = kept;
    }
}

void select_nth(keyed *entries, size_t count, size_t nth)
{
    size_t begin = 0, end = count;
    while (end - begin > 1)
    {
        size_t middle = partition(entries, begin, end);
        if (nth < middle)
            end = middle;
        else
            begin = middle;
    }
}

/// The exponent that brings the largest component of q - p to 1/2 … 1; false when they are equal.
static bool exponent_of_difference(const double *p, const double *q, size_t dim, int *exponent)
{
    double largest = 0;
    for (size_t axis = 0; axis < dim; axis++)
        largest = fmax(largest, fabs(q[axis] - p[axis]));
    (void)frexp(largest, exponent);
    return largest > 0;
}

double segment_share_of_any(const double *a, const double *b, const double *point, size_t dim)
{
    int of_side, of_point;
    if (!exponent_of_difference(a, b, dim, &of_side) || !exponent_of_difference(a, point, dim, &of_point))
        return 0;
    double along = 0, squared = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double side = ldexp(b[axis] - a[axis], -of_side);
        along += ldexp(point[axis] - a[axis], -of_point) * side;
        squared += side * side;
    }
    double share = ldexp(along / squared, of_point - of_side);
    return share <= 0 ? 0 : share >= 1 ? 1 : share;
}
