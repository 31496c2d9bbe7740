#ifndef CURVE_MAP_ARC_GRAPH_H
#define CURVE_MAP_ARC_GRAPH_H

#include "batten/curve.h"

/// @file
/// A set of curves, cut into arcs at nodes. Curves that run over the same edges share the arcs.

/// A run of a curve over a whole arc.
typedef struct arc_use
{
    size_t arc;
    size_t offset; ///< closed arcs: the point of the arc at which the curve begins; else 0
    bool reversed; ///< the curve runs from the arc's last point to its first
} arc_use;

/// Where the first curve over an arc has the arc's first point.
typedef struct arc_origin
{
    size_t curve, point;
} arc_origin;

/// The arcs of a set of curves. Two arcs have no edge in common, and an arc meets others only at its ends, or where two
/// lines cross at a common vertex. All zero: empty.
typedef struct arc_graph
{
    bat_curve *arcs; ///< arc_count polylines without channels; closed where a ring has no node; points are in `points`
    size_t arc_count;
    double *points;
    arc_origin *origins; ///< of each arc
    arc_use *uses;       ///< curve after curve, in the order of the curves' points
    size_t *first_use;   ///< curve i has the uses first_use[i] … first_use[i + 1] - 1
    size_t use_count;
    size_t *begins; ///< of each curve, the point where its first use begins; not 0 for rings whose first point is no node
    size_t *components; ///< of each arc, the connected part of the set that it belongs to, from 0
    size_t component_count;
    bool has_corners; ///< curves had flags of corners
    size_t nodes;     ///< vertices at which arcs end
    size_t shared;    ///< arcs with more than one use
} arc_graph;

/// Cut curves into arcs. A node is a vertex with more than two neighbours, an end of an open curve, a corner, or the tip
/// of a path that returns. The crossing of two lines at a vertex that no other curve passes is no node with `cross`.
/// Points are equal where all coordinates are.
///
/// @param curves  checked curves in one space
/// @param corners of each curve flags of its points, or null; null for none at all
/// @param cross   whether lines may cross at a vertex without being cut
/// @param graph   release it with arc_graph_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status arc_graph_make(const bat_curve *curves, size_t count, unsigned char *const *corners, bool cross, arc_graph *graph,
                          bat_error *error);

void arc_graph_free(arc_graph *graph);

#endif
