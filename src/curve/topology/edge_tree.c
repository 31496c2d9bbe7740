#include "curve/topology/edge_tree.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "base/lanes.h"
#include "base/threads.h"
#include "space/builtin.h"

/// Points of the sphere may be off unit length by 1e-9: boxes grow by twice that much and a little.
#define SPHERE_SLACK 2.1e-9
/// A bound of the rounding of Klein's coordinates, and of a cross product of unit vectors.
#define PROJECTIVE_SLACK 2e-15

/// Arithmetic operations that building and searching take for a leaf, roughly.
#define LEAF_WORK 2000.0

/// The classes of directions in the plane and in Klein's model: half open quadrants; two neighbours make a half-plane.
enum
{
    EAST = 1,  ///< dx > 0, dy >= 0
    NORTH = 2, ///< dx <= 0, dy > 0
    WEST = 4,  ///< dx < 0, dy <= 0
    SOUTH = 8, ///< dx >= 0, dy < 0
    ALL_QUADRANTS = 15,
};

/// The classes on the sphere: bit k for an edge that may not turn left about axis k, bit 3 + k likewise for right.
enum
{
    NOT_LEFT = 1,
    NOT_RIGHT = 8,
};

bool surface_of_space(const bat_space *space, surface_kind *kind)
{
    int curvature;
    if (!space_is_surface(space, &curvature))
        return false;
    *kind = curvature < 0 ? SURFACE_DISK : curvature > 0 ? SURFACE_SPHERE : SURFACE_PLANE;
    return true;
}

// The range of coordinates

static int range_of(surface_kind kind)
{
    return kind == SURFACE_PLANE    ? PREDICATE_RANGE_PLANE
           : kind == SURFACE_SPHERE ? PREDICATE_RANGE_SPHERE
                                    : PREDICATE_RANGE_DISK;
}

LANES_CLONES
static bool is_in_range(surface_kind kind, const double *values, size_t count)
{
    double low = ldexp(1, -range_of(kind)), high = ldexp(1, range_of(kind));
    uint64_t outside = 0;
    for (size_t i = 0; i < count; i++)
    {
        double size = fabs(values[i]);
        outside |= (uint64_t)(size > high) | ((uint64_t)(size > 0) & (uint64_t)(size < low));
    }
    return outside == 0;
}

/// Copy the points begin … end - 1 with numbers in range: those that are too small beside the others become 0.
static void copy_points(const edge_tree *tree, const tree_curve *curve, size_t begin, size_t end)
{
    double least = ldexp(1, -range_of(tree->kind));
    for (size_t i = begin * tree->dim; i < end * tree->dim; i++)
    {
        double value = curve->points[i] * tree->scale;
        curve->copy[i] = fabs(value) >= least ? value : 0;
    }
}

static bat_status copy_all(edge_tree *tree, bat_error *error)
{
    double largest = 0;
    for (size_t c = 0; c < tree->curve_count; c++)
        for (size_t i = 0; i < tree->curves[c].count * tree->dim; i++)
            largest = fmax(largest, fabs(tree->curves[c].points[i]));
    tree->scale = 1;
    if (tree->kind == SURFACE_PLANE && largest > 0)
    {
        int exponent = -ilogb(largest);
        tree->scale = ldexp(1, exponent > 1000 ? 1000 : exponent); // exact, as are its products but for small numbers
    }
    for (size_t c = 0; c < tree->curve_count; c++)
    {
        tree_curve *curve = &tree->curves[c];
        if (array_make(&curve->copy, curve->count * tree->dim, sizeof *curve->copy, error) != BAT_OK)
            return BAT_NO_MEMORY;
        copy_points(tree, curve, 0, curve->count);
    }
    return BAT_OK;
}

// Edges

static inline const double *point_of(const edge_tree *tree, const tree_curve *curve, size_t i)
{
    return (curve->copy != NULL ? curve->copy : curve->points) + i * tree->dim;
}

static inline size_t next_point(const tree_curve *curve, size_t i)
{
    return i + 1 == curve->count ? 0 : i + 1;
}

static bool is_same(const edge_tree *tree, const double *p, const double *q)
{
    bool same = p[0] == q[0] && p[1] == q[1];
    return same && (tree->dim < 3 || p[2] == q[2]);
}

/// Edges of a leaf, each with its box and class of directions. Edges without length are left out.
typedef struct leaf_edges
{
    size_t curve, count;
    size_t edges[EDGE_LEAF];
    edge_box boxes[EDGE_LEAF];
    unsigned directions[EDGE_LEAF];
} leaf_edges;

static const edge_box EMPTY_BOX = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
static const edge_box EVERYTHING = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};

/// The quadrant of a direction by the signs of its coordinates, each plus 1; none for 0.
static const unsigned char QUADRANTS[3][3] = {{WEST, WEST, NORTH}, {SOUTH, 0, NORTH}, {SOUTH, EAST, EAST}};

static inline unsigned quadrant_of(const double *p, const double *q)
{
    return QUADRANTS[1 + (q[0] > p[0]) - (q[0] < p[0])][1 + (q[1] > p[1]) - (q[1] < p[1])];
}

static inline double lesser(double a, double b)
{
    return a < b ? a : b;
}

static inline double greater(double a, double b)
{
    return a > b ? a : b;
}

static inline void flat_box(const double *p, const double *q, double slack, edge_box *box)
{
    for (int k = 0; k < 2; k++)
    {
        box->low[k] = lesser(p[k], q[k]) - slack;
        box->high[k] = greater(p[k], q[k]) + slack;
    }
    box->low[2] = box->high[2] = 0;
}

static inline void klein_point(const double *p, double *klein)
{
    double scale = 2 / (1 + p[0] * p[0] + p[1] * p[1]);
    klein[0] = scale * p[0];
    klein[1] = scale * p[1];
}

/// In Klein's coordinates 2 z / (1 + |z|^2) edges are straight.
static inline unsigned disk_edge(const double *p, const double *q, edge_box *box)
{
    double from[2], to[2];
    klein_point(p, from);
    klein_point(q, to);
    flat_box(from, to, PROJECTIVE_SLACK, box);
    bool sure = fabs(to[0] - from[0]) > PROJECTIVE_SLACK && fabs(to[1] - from[1]) > PROJECTIVE_SLACK;
    return sure ? quadrant_of(from, to) : ALL_QUADRANTS;
}

/// An arc leaves its chord of length c by 1 - sqrt(1 - c^2 / 4) at most.
static inline unsigned sphere_edge(const double *p, const double *q, edge_box *box)
{
    double square = chord_square(p, q);
    double root = 1 - 0.25 * square;
    double slack = 0.25 * square / (1 + sqrt(root > 0 ? root : 0)) + SPHERE_SLACK;
    unsigned directions = 0;
    for (int k = 0; k < 3; k++)
    {
        int x = k == 2 ? 0 : k + 1, y = 3 - k - x;
        double turn = p[x] * q[y] - p[y] * q[x];
        directions |= (turn > PROJECTIVE_SLACK ? 0U : (unsigned)NOT_LEFT << k) |
                      (turn < -PROJECTIVE_SLACK ? 0U : (unsigned)NOT_RIGHT << k);
        box->low[k] = lesser(p[k], q[k]) - slack;
        box->high[k] = greater(p[k], q[k]) + slack;
    }
    return directions;
}

/// The box of an edge, and its class of directions.
static inline unsigned edge_bounds(surface_kind kind, const double *p, const double *q, double slack, edge_box *box)
{
    if (kind == SURFACE_SPHERE)
        return sphere_edge(p, q, box);
    if (kind == SURFACE_DISK)
        return disk_edge(p, q, box);
    flat_box(p, q, slack, box);
    return quadrant_of(p, q);
}

static inline bool boxes_meet(const edge_box *a, const edge_box *b)
{
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] && b->low[1] <= a->high[1] &&
           a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

/// The edges begin … end - 1 of a curve that a leaf holds.
static const tree_curve *edges_of_leaf(const edge_tree *tree, size_t index, size_t *begin, size_t *end)
{
    const tree_curve *curve = &tree->curves[tree->nodes[index].first_curve];
    *begin = (index - curve->first_leaf) * EDGE_LEAF;
    *end = curve->edges - *begin < EDGE_LEAF ? curve->edges : *begin + EDGE_LEAF;
    return curve;
}

/// Load the edges of a leaf whose boxes meet a box.
static void load_leaf(const edge_tree *tree, size_t index, const edge_box *clip, leaf_edges *leaf)
{
    size_t begin, end, count = 0;
    const tree_curve *curve = edges_of_leaf(tree, index, &begin, &end);
    const double *p = point_of(tree, curve, begin);
    for (size_t i = begin; i < end; i++)
    {
        const double *q = point_of(tree, curve, next_point(curve, i));
        unsigned directions = edge_bounds(tree->kind, p, q, tree->slack, &leaf->boxes[count]);
        bool wanted = boxes_meet(&leaf->boxes[count], clip) && !is_same(tree, p, q);
        leaf->edges[count] = i;
        leaf->directions[count] = directions;
        count += wanted;
        p = q;
    }
    leaf->curve = tree->nodes[index].first_curve;
    leaf->count = count;
}

// Nodes

static inline void join_boxes(edge_box *box, const edge_box *other)
{
    for (int k = 0; k < 3; k++)
    {
        box->low[k] = lesser(box->low[k], other->low[k]);
        box->high[k] = greater(box->high[k], other->high[k]);
    }
}

/// Whether a chain of edges with these directions in this box cannot meet itself. In the plane: the directions lie in a
/// half-plane. On the sphere: all edges turn the same way about an axis, and the box is on one side of a plane through the
/// axis, so that they turn by less than pi.
static bool is_chain(surface_kind kind, unsigned directions, const edge_box *box)
{
    if (kind != SURFACE_SPHERE)
    {
        const unsigned halves[] = {EAST | NORTH, NORTH | WEST, WEST | SOUTH, SOUTH | EAST};
        for (int k = 0; k < 4; k++)
            if ((directions & ~halves[k]) == 0)
                return true;
        return false;
    }
    bool clear[3];
    for (int k = 0; k < 3; k++)
        clear[k] = box->low[k] > 0 || box->high[k] < 0;
    for (int k = 0; k < 3; k++)
    {
        bool turns = (directions >> k & NOT_LEFT) == 0 || (directions >> k & NOT_RIGHT) == 0;
        if (turns && (clear[k == 2 ? 0 : k + 1] || clear[k == 0 ? 2 : k - 1]))
            return true;
    }
    return false;
}

/// The bounds of edges; `kind` is that of the tree, for the compiler.
static inline unsigned join_edges(const edge_tree *tree, size_t index, surface_kind kind, edge_box *box)
{
    size_t begin, end;
    const tree_curve *curve = edges_of_leaf(tree, index, &begin, &end);
    const double *p = point_of(tree, curve, begin);
    unsigned directions = 0;
    edge_box sum = EMPTY_BOX;
    for (size_t i = begin; i < end; i++)
    {
        edge_box one;
        const double *q = point_of(tree, curve, next_point(curve, i));
        directions |= edge_bounds(kind, p, q, tree->slack, &one);
        join_boxes(&sum, &one);
        p = q;
    }
    *box = sum;
    return directions;
}

static void make_leaf(edge_tree *tree, size_t index)
{
    edge_node *node = &tree->nodes[index];
    // Inlined for each kind.
    node->directions = tree->kind == SURFACE_SPHERE ? join_edges(tree, index, SURFACE_SPHERE, &node->box)
                       : tree->kind == SURFACE_DISK ? join_edges(tree, index, SURFACE_DISK, &node->box)
                                                    : join_edges(tree, index, SURFACE_PLANE, &node->box);
}

/// A node of a level from its one or two children.
static void make_node(edge_tree *tree, size_t level, size_t index)
{
    const edge_node *children = &tree->nodes[tree->level_begin[level - 1] + 2 * index];
    edge_node *node = &tree->nodes[tree->level_begin[level] + index];
    *node = children[0];
    if (2 * index + 1 == tree->level_size[level - 1])
        return;
    join_boxes(&node->box, &children[1].box);
    node->directions |= children[1].directions;
    node->changed |= children[1].changed;
    node->last_curve = children[1].last_curve;
}

static bat_status lay_out(edge_tree *tree, const bat_curve *curves, bat_error *error)
{
    size_t leaves = 0, nodes = 0;
    if (array_zeros(&tree->curves, tree->curve_count, sizeof *tree->curves, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t c = 0; c < tree->curve_count; c++)
    {
        size_t count = curves[c].count, edges = curves[c].closed || count == 0 ? count : count - 1;
        tree->curves[c] = (tree_curve){
            .points = curves[c].points, .count = count, .edges = edges, .first_leaf = leaves, .closed = curves[c].closed};
        leaves += edges / EDGE_LEAF + (edges % EDGE_LEAF != 0);
    }
    for (size_t size = leaves; size > 0; size = size == 1 ? 0 : size / 2 + size % 2)
    {
        tree->level_begin[tree->level_count] = nodes;
        tree->level_size[tree->level_count++] = size;
        nodes += size;
    }
    tree->nodes = memory_array(nodes, sizeof *tree->nodes);
    return tree->nodes != NULL ? BAT_OK : error_memory(error, nodes * sizeof *tree->nodes);
}

/// Make node i of a level above 0, or the leaves of curve i.
static void make_part(edge_tree *tree, size_t level, size_t i)
{
    if (level > 0)
    {
        make_node(tree, level, i);
        return;
    }
    size_t leaf = tree->curves[i].first_leaf;
    for (size_t edge = 0; edge < tree->curves[i].edges; edge += EDGE_LEAF, leaf++)
    {
        tree->nodes[leaf] = (edge_node){.first_curve = i, .last_curve = i};
        make_leaf(tree, leaf);
    }
}

/// Make the nodes from the curves, which are laid out.
static void make_nodes(edge_tree *tree)
{
    for (size_t level = 0; level < tree->level_count; level++)
    {
        size_t count = level > 0 ? tree->level_size[level] : tree->curve_count;
        if (tree->threads == 1)
            for (size_t i = 0; i < count; i++)
                make_part(tree, level, i);
        else
        {
#pragma omp parallel for schedule(dynamic, 16) num_threads(tree->threads)
            for (size_t i = 0; i < count; i++)
                make_part(tree, level, i);
        }
    }
}

bat_status edge_tree_make(const bat_curve *curves, size_t count, double slack, int threads, edge_tree *tree,
                          bat_error *error)
{
    *tree = (edge_tree){.curve_count = count, .scale = 1, .slack = slack, .threads = 1};
    if (count == 0)
        return BAT_OK;
    (void)surface_of_space(curves[0].space, &tree->kind);
    tree->dim = curves[0].space->point_dim;
    bat_status status = lay_out(tree, curves, error);
    bool in_range = true;
    for (size_t c = 0; c < count && in_range; c++)
        in_range = is_in_range(tree->kind, curves[c].points, curves[c].count * tree->dim);
    if (status == BAT_OK && !in_range)
        status = copy_all(tree, error);
    if (status != BAT_OK)
        return status;
    tree->threads =
        tree->level_count > 0 ? threads_worth(threads, tree->level_size[0], LEAF_WORK * (double)tree->level_size[0]) : 1;
    make_nodes(tree);
    return BAT_OK;
}

void edge_tree_free(edge_tree *tree)
{
    for (size_t c = 0; c < tree->curve_count && tree->curves != NULL; c++)
        free(tree->curves[c].copy);
    free(tree->curves);
    free(tree->nodes);
    *tree = (edge_tree){0};
}

void edge_tree_mark(edge_tree *tree, size_t curve, size_t begin, size_t end)
{
    if (begin >= end)
        return;
    size_t first = tree->curves[curve].first_leaf;
    for (size_t leaf = begin / EDGE_LEAF; leaf <= (end - 1) / EDGE_LEAF; leaf++)
        tree->nodes[first + leaf].changed = true;
}

/// Bring the changed points into the range of the predicates.
static bat_status update_copies(edge_tree *tree, bat_error *error)
{
    bool in_range = true;
    for (size_t leaf = 0; leaf < tree->level_size[0]; leaf++)
    {
        if (!tree->nodes[leaf].changed)
            continue;
        size_t begin, end;
        const tree_curve *curve = edges_of_leaf(tree, leaf, &begin, &end);
        end += end < curve->count; // the last edge's end point
        if (curve->copy != NULL)
            copy_points(tree, curve, begin, end);
        else
            in_range &= is_in_range(tree->kind, curve->points + begin * tree->dim, (end - begin) * tree->dim);
    }
    if (in_range)
        return BAT_OK;
    for (size_t leaf = 0; leaf < tree->level_size[0]; leaf++)
        tree->nodes[leaf].changed = true; // the copies have another scale
    return copy_all(tree, error);
}

bat_status edge_tree_update(edge_tree *tree, bat_error *error)
{
    if (tree->level_count == 0)
        return BAT_OK;
    bat_status status = update_copies(tree, error);
    if (status != BAT_OK)
        return status;
    for (size_t leaf = 0; leaf < tree->level_size[0]; leaf++)
        if (tree->nodes[leaf].changed)
            make_leaf(tree, leaf);
    for (size_t level = 1; level < tree->level_count; level++)
        for (size_t i = 0; i < tree->level_size[level]; i++)
        {
            const edge_node *children = &tree->nodes[tree->level_begin[level - 1] + 2 * i];
            bool second = 2 * i + 1 < tree->level_size[level - 1];
            if (children[0].changed || (second && children[1].changed))
                make_node(tree, level, i);
        }
    return BAT_OK;
}

void edge_tree_settle(edge_tree *tree)
{
    for (size_t level = 0; level < tree->level_count; level++)
        for (size_t i = 0; i < tree->level_size[level]; i++)
            tree->nodes[tree->level_begin[level] + i].changed = false;
}

// The search

typedef struct edge_search
{
    const edge_tree *tree;
    edge_pairs pairs;
    double shift; ///< added to the first coordinate of second edges
    bool changed_only, stopped;
    edge_pair_found *found;
    void *context;
} edge_search;

/// Whether the points first … last of a curve are all equal.
static bool is_one_point(const edge_tree *tree, const tree_curve *curve, size_t first, size_t last)
{
    for (size_t i = first; i < last; i++)
        if (!is_same(tree, point_of(tree, curve, i), point_of(tree, curve, i + 1)))
            return false;
    return true;
}

/// Whether edge i of a curve follows edge j > i at the place where the curve closes: all points between them are equal.
static bool closes(const edge_tree *tree, const tree_curve *curve, size_t i, size_t j)
{
    const double *end = point_of(tree, curve, next_point(curve, j));
    if (!is_same(tree, end, point_of(tree, curve, i)) || !is_one_point(tree, curve, 0, i))
        return false;
    return j + 1 == curve->count || is_one_point(tree, curve, j + 1, curve->count - 1);
}

/// Whether edges i < j of a curve have more in common than the vertex that neighbours share.
static bool edges_of_one_meet(const edge_tree *tree, const tree_curve *curve, size_t i, size_t j)
{
    const double *a = point_of(tree, curve, i), *b = point_of(tree, curve, i + 1), *c = point_of(tree, curve, j),
                 *d = point_of(tree, curve, next_point(curve, j));
    bool follows = is_same(tree, b, c) && is_one_point(tree, curve, i + 1, j), around = closes(tree, curve, i, j);
    if (follows && around)
        return true; // there and back
    if (follows)
        return predicate_folds_back(tree->kind, a, b, d);
    if (around)
        return predicate_folds_back(tree->kind, c, d, b);
    return predicate_edges_meet(tree->kind, a, b, c, d);
}

/// The points of an edge, moved by `shift`.
typedef struct placed_edge
{
    double ends[2][3];
    bool at_end[2]; ///< the point is an end of its open curve
} placed_edge;

static placed_edge place_edge(const edge_tree *tree, edge_place place, double shift)
{
    const tree_curve *curve = &tree->curves[place.curve];
    size_t points[2] = {place.edge, next_point(curve, place.edge)};
    placed_edge edge;
    for (int k = 0; k < 2; k++)
    {
        memcpy(edge.ends[k], point_of(tree, curve, points[k]), tree->dim * sizeof(double));
        edge.ends[k][0] += shift;
    }
    edge.at_end[0] = !curve->closed && is_one_point(tree, curve, 0, points[0]);
    edge.at_end[1] = !curve->closed && is_one_point(tree, curve, points[1], curve->count - 1);
    return edge;
}

/// Whether edges of different curves have more in common than an end that the curves share.
static bool arcs_meet(const edge_tree *tree, const placed_edge *p, const placed_edge *q)
{
    int shared = 0, own = 0, other = 0;
    for (int k = 0; k < 2; k++)
        for (int m = 0; m < 2; m++)
            if (p->at_end[k] && q->at_end[m] && is_same(tree, p->ends[k], q->ends[m]))
            {
                shared++;
                own = k;
                other = m;
            }
    if (shared == 0)
        return predicate_edges_meet(tree->kind, p->ends[0], p->ends[1], q->ends[0], q->ends[1]);
    return shared > 1 || predicate_folds_back(tree->kind, p->ends[!own], p->ends[own], q->ends[!other]);
}

static void test_pair(edge_search *search, edge_place first, edge_place second)
{
    const edge_tree *tree = search->tree;
    bool meet;
    if (search->pairs == EDGE_PAIRS_NEAR)
        meet = true;
    else if (first.curve == second.curve && search->shift == 0)
        meet = edges_of_one_meet(tree, &tree->curves[first.curve], first.edge, second.edge);
    else if (search->pairs == EDGE_PAIRS_SAME_CURVE)
        return;
    else
    {
        placed_edge p = place_edge(tree, first, 0), q = place_edge(tree, second, search->shift);
        meet = search->pairs == EDGE_PAIRS_ARCS
                   ? arcs_meet(tree, &p, &q)
                   : predicate_edges_meet(tree->kind, p.ends[0], p.ends[1], q.ends[0], q.ends[1]);
    }
    if (meet)
        search->stopped = !search->found(search->context, first, second);
}

static edge_place place_of(const leaf_edges *leaf, size_t i)
{
    return (edge_place){leaf->curve, leaf->edges[i]};
}

static void search_leaf(edge_search *search, size_t index)
{
    leaf_edges leaf;
    load_leaf(search->tree, index, &EVERYTHING, &leaf);
    for (size_t i = 0; i < leaf.count; i++)
    {
        // Edges up to which a chain begins at edge i cannot meet it.
        edge_box box = leaf.boxes[i];
        unsigned directions = leaf.directions[i];
        size_t j = i + 1;
        for (; j < leaf.count; j++)
        {
            join_boxes(&box, &leaf.boxes[j]);
            directions |= leaf.directions[j];
            if (!is_chain(search->tree->kind, directions, &box))
                break;
        }
        for (; j < leaf.count && !search->stopped; j++)
            if (boxes_meet(&leaf.boxes[i], &leaf.boxes[j]))
                test_pair(search, place_of(&leaf, i), place_of(&leaf, j));
    }
}

static inline edge_box shifted(edge_box box, double shift)
{
    box.low[0] += shift;
    box.high[0] += shift;
    return box;
}

static void search_leaves(edge_search *search, size_t first, size_t second)
{
    const edge_tree *tree = search->tree;
    leaf_edges a, b;
    edge_box there = shifted(tree->nodes[second].box, search->shift);
    edge_box here = shifted(tree->nodes[first].box, -search->shift);
    load_leaf(tree, first, &there, &a);
    if (a.count == 0)
        return;
    load_leaf(tree, second, &here, &b);
    for (size_t j = 0; j < b.count; j++)
        b.boxes[j] = shifted(b.boxes[j], search->shift);
    for (size_t i = 0; i < a.count; i++)
        for (size_t j = 0; j < b.count && !search->stopped; j++)
            if (boxes_meet(&a.boxes[i], &b.boxes[j]))
                test_pair(search, place_of(&a, i), place_of(&b, j));
}

static const edge_node *node_at(const edge_tree *tree, size_t level, size_t index)
{
    return &tree->nodes[tree->level_begin[level] + index];
}

/// Whether two nodes, the first before the second, make one chain: of one curve, one after the other.
static bool make_chain(const edge_tree *tree, const edge_node *a, const edge_node *b, bool adjacent)
{
    if (!adjacent || a->first_curve != b->last_curve)
        return false;
    edge_box box = a->box;
    join_boxes(&box, &b->box);
    return is_chain(tree->kind, a->directions | b->directions, &box);
}

/// A part of the search: the pairs of an edge of node `first` and one of node `second` of a level.
typedef struct node_pair
{
    size_t level, first, second; ///< equal without a shift: the pairs within a node; else first < second without a shift
    double shift;
} node_pair;

/// Whether no pair of edges needs a test.
static inline bool is_clear(const edge_search *search, const node_pair *part)
{
    const edge_tree *tree = search->tree;
    const edge_node *a = node_at(tree, part->level, part->first), *b = node_at(tree, part->level, part->second);
    if (search->changed_only && !a->changed && !b->changed)
        return true;
    if (part->shift > 0)
    {
        edge_box moved = shifted(b->box, part->shift);
        return !boxes_meet(&a->box, &moved);
    }
    if (part->first == part->second)
        return a->first_curve == a->last_curve && is_chain(tree->kind, a->directions, &a->box);
    return (search->pairs == EDGE_PAIRS_SAME_CURVE && a->last_curve < b->first_curve) || !boxes_meet(&a->box, &b->box) ||
           make_chain(tree, a, b, part->first + 1 == part->second);
}

#define MAX_CHILDREN 4

/// The parts of the level below, in the order of the search.
static inline size_t divide(const edge_tree *tree, const node_pair *part, node_pair *children)
{
    size_t level = part->level - 1, size = tree->level_size[level], count = 0;
    if (part->first == part->second && part->shift <= 0)
    {
        size_t first = 2 * part->first, second = first + 1;
        children[count++] = (node_pair){level, first, first, 0};
        if (second == size)
            return count;
        children[count++] = (node_pair){level, second, second, 0};
        children[count++] = (node_pair){level, first, second, 0};
        return count;
    }
    for (size_t i = 2 * part->first; i < 2 * part->first + 2 && i < size; i++)
        for (size_t j = 2 * part->second; j < 2 * part->second + 2 && j < size; j++)
            children[count++] = (node_pair){level, i, j, part->shift};
    return count;
}

static void search_part(edge_search *search, const node_pair *part)
{
    if (search->stopped || is_clear(search, part))
        return;
    if (part->level > 0)
    {
        node_pair children[MAX_CHILDREN];
        size_t count = divide(search->tree, part, children);
        for (size_t i = 0; i < count; i++)
            search_part(search, &children[i]);
        return;
    }
    search->shift = part->shift;
    if (part->first == part->second && part->shift <= 0)
        search_leaf(search, part->first);
    else
        search_leaves(search, part->first, part->second);
}

// The search by several threads

/// The pairs that a thread found in a part.
typedef struct found_pairs
{
    edge_place (*pairs)[2];
    size_t count, capacity;
    bool failed; ///< out of memory, or too many
} found_pairs;

static bool keep_pair(void *context, edge_place first, edge_place second)
{
    static const int MAX_KEPT = 1 << 16; ///< of a part: who searches for few wants no more memory for many
    found_pairs *kept = context;
    kept->failed = kept->count == MAX_KEPT || !ARRAY_GROW(kept->pairs, kept->capacity, kept->count + 1);
    if (kept->failed)
        return false;
    kept->pairs[kept->count][0] = first;
    kept->pairs[kept->count++][1] = second;
    return true;
}

/// Divide the parts until there are `wanted`, in the order of the search.
/// @param parts has room for MAX_CHILDREN x wanted parts, as has `divided`
static size_t divide_all(const edge_search *search, node_pair *parts, size_t count, size_t wanted, node_pair *divided)
{
    for (size_t level = search->tree->level_count - 1; level > 0 && count > 0 && count < wanted; level--)
    {
        size_t next = 0;
        for (size_t i = 0; i < count; i++)
            if (!is_clear(search, &parts[i]))
                next += divide(search->tree, &parts[i], divided + next);
        memcpy(parts, divided, next * sizeof *parts);
        count = next;
    }
    return count;
}

/// Search the parts and hand over their pairs in order. False, without having handed over any, when one failed.
static bool search_shared(edge_search *search, const node_pair *parts, size_t count, int threads)
{
    (void)threads; // without OpenMP
    found_pairs *kept = calloc(count > 0 ? count : 1, sizeof *kept);
    bool done = kept != NULL;
    if (done)
    {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
        for (size_t i = 0; i < count; i++)
        {
            edge_search own = *search;
            own.found = keep_pair;
            own.context = &kept[i];
            search_part(&own, &parts[i]);
        }
    }
    for (size_t i = 0; i < count && done; i++)
        done = !kept[i].failed;
    for (size_t i = 0; i < count && done; i++)
        for (size_t k = 0; k < kept[i].count && !search->stopped; k++)
            search->stopped = !search->found(search->context, kept[i].pairs[k][0], kept[i].pairs[k][1]);
    for (size_t i = 0; i < count && kept != NULL; i++)
        free(kept[i].pairs);
    free(kept);
    return done;
}

/// Search by several threads. False, without having handed over any pair, when one thread has to do it.
static bool search_divided(edge_search *search, const node_pair *whole, size_t count)
{
    static const size_t PARTS = 256; ///< so many differ less in their work than threads can even out
    size_t room = (size_t)MAX_CHILDREN * PARTS;
    node_pair *parts = memory_array(2 * room, sizeof *parts);
    if (parts == NULL)
        return false;
    memcpy(parts, whole, count * sizeof *parts);
    count = divide_all(search, parts, count, PARTS, parts + room);
    bool done = search_shared(search, parts, count, search->tree->threads);
    free(parts);
    return done;
}

bool edge_tree_search(const edge_tree *tree, edge_pairs pairs, bool changed_only, edge_pair_found *found, void *context)
{
    edge_search search = {.tree = tree, .pairs = pairs, .changed_only = changed_only, .found = found, .context = context};
    if (tree->level_count == 0)
        return true;
    node_pair whole[2] = {{tree->level_count - 1, 0, 0, 0}, {tree->level_count - 1, 0, 0, tree->turn * tree->scale}};
    size_t count = whole[1].shift > 0 ? 2 : 1;
    if (tree->threads > 1 && !changed_only && search_divided(&search, whole, count))
        return !search.stopped;
    for (size_t i = 0; i < count; i++)
        search_part(&search, &whole[i]);
    return !search.stopped;
}

bat_status edge_pairs_find(const bat_curve *curves, size_t count, double turn, edge_pairs pairs, int threads,
                           edge_pair_found *found, void *context, bat_error *error)
{
    edge_tree tree;
    bat_status status = edge_tree_make(curves, count, 0, threads, &tree, error);
    tree.turn = turn;
    if (status == BAT_OK)
        (void)edge_tree_search(&tree, pairs, false, found, context);
    edge_tree_free(&tree);
    return status;
}
