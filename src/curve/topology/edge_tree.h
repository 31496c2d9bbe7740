#pragma once

#include "batten/curve.h"

#include <stdbool.h>

/// @file
/// Exact predicates of points and geodesic edges. Every answer is that of exact arithmetic on the coordinates as they are
/// stored. A floating-point value with a proven error bound decides most cases; where it cannot, the determinant is summed
/// without rounding, as an expansion (Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
/// Predicates, 1997).
///
/// All three surfaces are one case of the same geometry. A point stands for a vector: (x, y, 1) in the plane, (x, y, z) on
/// the sphere, and (x, y, (1 + x^2 + y^2) / 2) in the disk, which is Klein's model in homogeneous coordinates. A geodesic is
/// the intersection with a plane through the origin, and the orientation of a, b, c is the sign of det[a, b, c].

/// The surfaces that have predicates.
typedef enum surface_kind
{
    SURFACE_PLANE,
    SURFACE_SPHERE, ///< points of the unit sphere in R^3, taken as directions: their lengths do not matter
    SURFACE_DISK    ///< Poincaré's disk
} surface_kind;

/// No product of coordinates may underflow or overflow: a coordinate that is not 0 must lie between 2^-PREDICATE_RANGE of
/// its surface and, in the plane, 2^PREDICATE_RANGE.
#define PREDICATE_RANGE_PLANE 480
#define PREDICATE_RANGE_SPHERE 300
#define PREDICATE_RANGE_DISK 200

/// 1 when a, b, c turn left, -1 right, 0 when one geodesic contains them. On the sphere left is seen from outside.
int predicate_orientation(surface_kind kind, const double *a, const double *b, const double *c);

/// Whether the edges ab and cd have a point in common, ends included. Both edges have a length.
bool predicate_edges_meet(surface_kind kind, const double *a, const double *b, const double *c, const double *d);

/// Whether the edges ab and bc have more in common than b: they lie on one geodesic and fold back.
bool predicate_folds_back(surface_kind kind, const double *a, const double *b, const double *c);

// The pairs of edges of a set of curves that cross or touch, found by a tree of boxes.
//
// A leaf of the tree holds consecutive edges of one curve, a node two consecutive nodes of the level below. A search
// compares the tree with itself and leaves out pairs of nodes whose boxes are disjoint. A node also knows the directions of
// its edges: a chain of edges whose directions lie in a half-plane cannot meet itself, so that smooth pieces cost nothing
// but their boxes. For curves whose pieces lie near in space where they are near in order, such as coasts, building and
// searching take O(n log n). The predicates are exact.

enum
{
    /// The number of edges of a leaf.
    EDGE_LEAF = 16,
    EDGE_MAX_LEVELS = 64
};

/// A box that contains edges, in R^3 on the sphere, in Klein's model of the disk.
typedef struct edge_box
{
    double low[3], high[3];
} edge_box;

typedef struct edge_node
{
    edge_box box;
    unsigned directions;            ///< a bit for each class of directions that an edge has
    bool changed;                   ///< since the last search
    size_t first_curve, last_curve; ///< the curves whose edges it holds
} edge_node;

/// A curve of the set.
typedef struct tree_curve
{
    const double *points;
    double *copy; ///< of the points, in the range of the predicates; null where the points are in it
    size_t count, edges, first_leaf;
    bool closed;
} tree_curve;

typedef struct edge_tree
{
    surface_kind kind;
    size_t dim;
    double scale; ///< of the copies: a power of two
    double slack; ///< SURFACE_PLANE: the boxes of edges are so much larger on each side.
    int threads;  ///< of searches
    double turn;  ///< SURFACE_PLANE: x and x + turn are the same place; 0 for none. Set it before a search
    tree_curve *curves;
    size_t curve_count;
    edge_node *nodes;
    size_t level_count, level_begin[EDGE_MAX_LEVELS], level_size[EDGE_MAX_LEVELS];
} edge_tree;

/// Which pairs of edges count.
typedef enum edge_pairs
{
    EDGE_PAIRS_SAME_CURVE,
    EDGE_PAIRS_ALL,
    EDGE_PAIRS_NEAR, ///< all whose boxes meet, neighbours of a curve too; nothing else is tested
    EDGE_PAIRS_ARCS  ///< all; different curves may share their end points, and then count where they have more in common
} edge_pairs;

/// An edge of the set: it begins at point `edge` of the curve.
typedef struct edge_place
{
    size_t curve, edge;
} edge_place;

/// Receives a pair of edges with a common point, the first in order first. False ends the search.
typedef bool edge_pair_found(void *context, edge_place first, edge_place second);

/// The surface of a space; false for spaces without predicates.
bool surface_of_space(const bat_space *space, surface_kind *kind);

/// Make the tree of curves in one space with predicates. The points must outlive the tree.
/// @param slack   see edge_tree; 0 for exact boxes
/// @param threads of building and searching; 0: as many as OpenMP gives, fewer for few edges
/// @param tree    release it with edge_tree_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status edge_tree_make(const bat_curve *curves, size_t count, double slack, int threads, edge_tree *tree,
                          bat_error *error);
void edge_tree_free(edge_tree *tree);

/// Mark the edges begin … end - 1 of a curve, whose points were moved.
void edge_tree_mark(edge_tree *tree, size_t curve, size_t begin, size_t end);
/// Compute the boxes again of what is marked; call it before the next search.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status edge_tree_update(edge_tree *tree, bat_error *error);
/// Forget the marks.
void edge_tree_settle(edge_tree *tree);

/// Find the pairs of edges with a common point. Edges of one curve that follow each other share their common vertex; such a
/// pair counts where they fold back onto each other. Edges without length, between points that are equal, do not count. An
/// open curve whose last point equals its first is a ring. With a turn, edges one turn apart count as well; the second edge
/// of such a pair is the one that is moved by +turn to meet the first.
/// Several threads may search, but `found` is called by the calling thread, in the same order.
/// @param changed_only only pairs with a marked edge; neighbours of marked edges may count as marked
/// @return false when `found` ended the search
bool edge_tree_search(const edge_tree *tree, edge_pairs pairs, bool changed_only, edge_pair_found *found, void *context);
/// The same search of curves without a tree for more.
/// @return BAT_OK, also where `found` ended the search, or BAT_NO_MEMORY
bat_status edge_pairs_find(const bat_curve *curves, size_t count, double turn, edge_pairs pairs, int threads,
                           edge_pair_found *found, void *context, bat_error *error);
