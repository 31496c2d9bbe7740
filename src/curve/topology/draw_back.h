#pragma once

#include "batten/base.h"
#include "curve/topology/edge_tree.h"

/// @file
/// Points that stay where they are, one for each connected part of a set of curves. When refined edges pass over a part
/// without meeting it, such as a coast over an island, they pass over its anchor.

/// Anchors in a grid. All zero: none.
typedef struct anchor_grid
{
    double *points;     ///< count x 2, cell after cell
    size_t *components; ///< the part of each
    size_t *begins;     ///< the first anchor of each cell, and the count
    size_t count, columns, rows;
    double low[2], cell[2]; ///< the corner of the grid and the size of a cell
} anchor_grid;

/// Make a grid.
/// @param points     count x 2 finite numbers
/// @param components the part of each point
/// @param grid       release it with anchor_grid_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status anchor_grid_make(const double *points, const size_t *components, size_t count, anchor_grid *grid,
                            bat_error *error);
void anchor_grid_free(anchor_grid *grid);

/// Whether an anchor of another part than `component` lies inside a polygon, by the exact parity of edges to its right.
/// @param polygon count x 2; the last point joins the first
bool anchor_grid_inside(const anchor_grid *grid, const double *polygon, size_t count, size_t component);

// Refined curves drawn back towards their polygons until their edges no longer meet.

/// A curve that was refined from another and contains its points.
typedef struct drawn_curve
{
    const bat_curve *coarse;
    /// The coarse point i is point starts[i] of the refined curve; for a closed curve, starts[coarse->count] is the number
    /// of its points. Null: every edge has equally many new points.
    const size_t *starts;
} drawn_curve;

/// What was done.
typedef struct draw_back_counts
{
    size_t allowed;   ///< pairs of refined edges that meet and may
    size_t crossings; ///< other pairs of refined edges that crossed or touched before, and edges that passed over anchors
    size_t edges;     ///< edges of the polygons whose new points were moved
    size_t straight;  ///< of these, edges that became straight
    edge_place stuck; ///< an edge of a polygon that rounding makes meet another one; curve BAT_NO_INDEX where there is none
} draw_back_counts;

/// How new points move.
typedef enum draw_move
{
    DRAW_HALF,    ///< half of the way to the edge
    DRAW_ON_EDGE, ///< onto the edge
    DRAW_TO_START ///< so near to the start of the edge that the tested curve has the same point
} draw_move;

/// What may be drawn back, and how.
typedef struct draw_rules
{
    edge_pairs pairs;
    double turn; ///< as in edge_tree
    /// Move the points begin + 1 … end - 1 of refined curve `curve`, those over edge `edge` of its polygon; points of `fine`
    /// change with them. False where that is impossible. Null: along geodesics, but not to the start
    bool (*move)(void *context, size_t curve, size_t edge, size_t begin, size_t end, draw_move move);
    /// Whether these edges of polygons may meet after refinement. Null: none
    bool (*may_meet)(void *context, edge_place first, edge_place second);
    void *context;
    /// Whether straight edges that rounding makes meet are left so, rather than refused.
    bool straight_may_meet;
    /// Points over which no refined edge may have passed, of curves with two coordinates; null: none
    const anchor_grid *anchors;
    int threads;              ///< 0: as many as OpenMP gives
    const size_t *components; ///< of each curve, its part; an edge may pass over the anchor of its own part
} draw_rules;

/// Whether the refined curve contains the points of the coarse one at the places of `starts` (null as above).
bool contains_points(const bat_curve *coarse, const bat_curve *fine, const size_t *starts);

/// Draw new points of refined curves back towards the edges that they were made for, until no two edges meet that count.
///
/// A new point over an edge of the polygon at share s becomes the point at share lambda of the geodesic from the edge's
/// point at s to the refined point. Each edge of the polygon has one lambda, 1 at first. As long as refined edges meet, the
/// lambda of every edge of the polygon with such a pair is halved, after 1/16 it becomes 0. Points of other edges stay as
/// they are. With lambda 0 everywhere the result is the polygon, whose edges do not meet, so that this ends.
///
/// @param drawn  `count` curves whose polygons' edges do not meet; all contains_points()
/// @param fine   the refined curves in one space with predicates, in the same order; their points are moved
/// @param rules  what may be drawn back, and how
/// @param counts receives what was done
/// @return BAT_OK; BAT_INVALID_POINT with the index of a point of a polygon from which edges come so near that rounding
/// makes
///         the straight ones meet; BAT_NO_MEMORY or BAT_CANCELLED; the points may be moved on failure
bat_status draw_back(const drawn_curve *drawn, bat_curve *fine, size_t count, const draw_rules *rules, bat_progress progress,
                     draw_back_counts *counts, bat_error *error);

/// Whether the edges of a curve meet nowhere but at the vertices that neighbours share.
/// @param curve in a space with predicates; its points are checked
/// @return BAT_OK or BAT_NO_MEMORY
bat_status curve_edges_are_apart(const bat_curve *curve, bool *apart, bat_error *error);

/// Keep a refined curve simple, as options->simple asks.
/// @param coarse its points are checked
/// @param fine   the refined curve; its new points may be moved
/// @param starts coarse point i is point starts[i] of the refined curve, and starts[coarse->count] is fine->count for a
/// closed
///               curve; null: every edge has equally many new points
/// @param report receives what was found
/// @return BAT_OK, BAT_INVALID_POINT, BAT_UNSUPPORTED, BAT_NO_MEMORY or BAT_CANCELLED
bat_status keep_simple(const bat_curve *coarse, const bat_curve_refine_options *options, bat_curve *fine,
                       const size_t *starts, bat_progress progress, bat_curve_refine_report *report, bat_error *error);

/// Whether the options ask for a test of a curve.
bool wants_simple(const bat_curve *coarse, const bat_curve_refine_options *options);
