#pragma once

#include "base/memory.h"
#include "batten/curve_map.h"
#include "curve/topology/draw_back.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/// @file
/// Hashes of numbers and points, for tables whose order never reaches a result.

static inline size_t hash_mix(size_t hash, uint64_t value)
{
    uint64_t mixed = ((uint64_t)hash ^ value) * UINT64_C(0x9e3779b97f4a7c15);
    return (size_t)(mixed ^ (mixed >> 29));
}

/// The hash of `count` doubles; 0 and -0 are the same.
static inline size_t doubles_hash(const double *values, size_t count)
{
    size_t hash = count;
    for (size_t i = 0; i < count; i++)
    {
        double value = values[i] + 0.0;
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = hash_mix(hash, bits);
    }
    return hash;
}

/// Whether two points are equal, number by number; 0 equals -0.
static inline bool points_equal(const double *p, const double *q, size_t dim)
{
    size_t same = 0;
    while (same < dim && p[same] == q[same])
        same++;
    return same == dim;
}

// The plane in which the curves of a map must not cross. Curves of the plane and the disk are their own charts. Those of
// the sphere have the chart of longitude and latitude, in units of the last decimal that a file holds, because readers of
// the file see straight lines between these numbers (RFC 7946, section 3.1.1).

/// A chart of a space.
typedef struct map_chart
{
    bat_space space;         ///< the plane or the disk
    bool globe;              ///< the chart of the sphere; else the curves are their own charts
    double units_per_degree; ///< globe
    double units_per_radian; ///< globe
    double turn;             ///< globe: 360 degrees in units; else 0
} map_chart;

/// The charts of many curves. All zero: empty.
typedef struct chart_curves
{
    bat_curve *curves; ///< the points of a globe's chart are in `points`; others are those of the curves themselves
    double *points;
    size_t count;
} chart_curves;

/// The chart of a space; false where there is none.
/// @param decimals of degrees on the sphere
bool chart_of_space(const bat_space *space, int decimals, map_chart *chart);

/// Make the charts of curves. Longitudes go on without jumps along a curve. A ring around a pole becomes an open curve whose
/// last point repeats the first one turn further.
///
/// @param curves checked curves
/// @param coarse the charts of the curves from which these were refined, whose points they keep; null for none
/// @param starts of each curve: coarse point i is point starts[i]; null, or null for a curve: every edge has equally many
///               new points
/// @param charts release it with chart_curves_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status chart_curves_make(const map_chart *chart, const bat_curve *curves, size_t count, const chart_curves *coarse,
                             size_t *const *starts, int threads, chart_curves *charts, bat_error *error);
void chart_curves_free(chart_curves *charts);

/// The point of the sphere at a place of the chart.
void chart_to_point(const map_chart *chart, const double *flat, double *point);

/// Move the points begin + 1 … end - 1 of a refined curve of the sphere, in the chart, for edge `edge` of the curve before.
/// @param coarse the chart of the curve before
/// @param flat   the chart of the refined curve; its points move as well
void chart_move(const map_chart *chart, const bat_curve *coarse, bat_curve *fine, bat_curve *flat, size_t edge, size_t begin,
                size_t end, draw_move move);

// Edges of the sphere that are straight in degrees, such as borders along a parallel.

/// Which edges are straight in degrees.
typedef struct degree_edges
{
    bat_curve_map_edges edges;
    double unit; ///< degrees that rounding may change
} degree_edges;

/// Whether an open arc is straight in degrees.
bool degrees_straight(const bat_curve *arc, const degree_edges *how);
/// The point at a share of the straight line in degrees between two points.
void degrees_edge_point(const double *p, const double *q, double share, double *point);
/// Flag all vertices of runs of edges that are straight in degrees and longer than a degree. Runs along parallels and
/// meridians are also longer than 20 units of the coordinates' last decimal, since shorter ones occur by chance.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status degrees_flag_runs(const bat_curve *curve, const degree_edges *how, unsigned char *flags, bat_error *error);

// A set of curves, cut into arcs at nodes. Curves that run over the same edges share the arcs.

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
    memory_pool pool; ///< holds the arrays
    bat_curve *arcs;  ///< arc_count polylines without channels; closed where a ring has no node; points are in `points`
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

// Points of a set of curves that lie nearer to each other than a tolerance, made one.

/// Copies of curves whose points were joined. All zero: empty.
typedef struct snapped_curves
{
    bat_curve *curves; ///< `count`; null when no point had to move, and the given curves serve
    size_t count;
    size_t **origins; ///< of each curve, the given point that each point comes from; of an added one, that before it
    size_t moved;     ///< points that were moved
    size_t added;     ///< vertices that were added to edges
    size_t spikes;    ///< vertices of spikes of rings that were dropped
    double largest;   ///< the longest way of a point
} snapped_curves;

/// Points that are nearer than this are the same point in other digits, on the sphere in radians: 1e-10 degrees.
#define SNAP_ROUNDING_SPHERE 1.75e-12
/// The same in the plane and the disk, relative to the largest coordinate.
#define SNAP_ROUNDING_FLAT 4e-15

/// Join points, then points with edges. In the order of the curves each point moves to the nearest of the points before it
/// that is within the tolerance and has not moved itself. Then a point within the tolerance of an edge, which is straight in
/// the chart, becomes a vertex of the edge. This gives two features the same border where one has a vertex and the other has
/// none. Points that follow each other and have become equal are dropped. Curves that would have fewer points than a curve
/// needs stay as they are.
///
/// @param curves    checked curves on the sphere, in the plane or in the disk
/// @param chart     of their space
/// @param tolerance in the unit of the space's distance; 0: only what rounding tells apart is joined
/// @param snapped   release it with snapped_curves_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status snapped_curves_make(const bat_curve *curves, size_t count, const map_chart *chart, double tolerance, int threads,
                               snapped_curves *snapped, bat_error *error);

void snapped_curves_free(snapped_curves *snapped);

// Fewer points.

/// Copies of curves without the points that Douglas and Peucker's algorithm drops, arc by arc: shared borders stay shared,
/// no dropped point is farther than the tolerance from the edge in its place, and arcs meet and pass where they did before.
/// Nodes, ends and corners stay, and rings keep three points.
///
/// @param chart  of their space; null: nothing tests whether arcs meet
/// @param simple `moved` receives the number of dropped points; release it with snapped_curves_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status simplified_curves_make(const bat_curve *curves, size_t count, double tolerance, const map_chart *chart,
                                  int threads, snapped_curves *simple, bat_error *error);

// Refinement of the arcs of a map, so that those that do not meet before do not meet after.

/// Refined arcs. All zero: empty.
typedef struct refined_arcs
{
    bat_curve *arcs; ///< `count`, in the order of the graph
    size_t count;
    size_t **starts; ///< of each arc: its point i is point starts[i] of the refined one; null: equally many to each edge
} refined_arcs;

/// Refine the arcs of a graph.
/// @param joints  line_chains::joints of the curves; null: no lines were joined
/// @param options complete and valid, with a scheme; corners are ends of arcs already
/// @param chart   where arcs must not meet; null: nothing is tested
/// @param straight which edges are straight in degrees; null: none
/// @param report  receives what was found and done
/// @param fine    release it with refined_arcs_free(), also on failure
/// @param error   its `curve` is the failing arc, its `index` the point of that arc
/// @return as bat_curve_map_refine()
bat_status refined_arcs_make(const arc_graph *graph, unsigned char *const *joints, const bat_curve_refine_options *options,
                             const map_chart *chart, const degree_edges *straight, bat_curve_map_refine_report *report,
                             refined_arcs *fine, bat_error *error);

/// Choose an anchor for each connected part: the first point of its first arc, on the globe with those one turn away.
/// @param charts  of the arcs
/// @param anchors all zero before; release it with anchor_grid_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status arc_anchors_make(const arc_graph *graph, const map_chart *chart, const chart_curves *charts, anchor_grid *anchors,
                            bat_error *error);

/// The row of a refined arc where vertex `i` of the arc is, for schemes that keep the given points.
size_t refined_arcs_row(const refined_arcs *fine, const arc_graph *graph, size_t arc, size_t i);

void refined_arcs_free(refined_arcs *fine);

// Refined arcs, moved so that the rings keep their areas.

/// Give the rings of refined arcs the areas of the given rings, in the plane or on the sphere.
///
/// A point over a given edge of length L moves sideways by 16 t s^2 (1 - s)^2 L, where s is its share of the edge and t
/// belongs to the arc, so that given points stay and no corner appears. The numbers t are those with the smallest weighted
/// sum of squares for which all rings have their areas, by Newton's method. Edges whose points would then cross others
/// become straight, as do those of rings whose area cannot be kept otherwise, and the others take their part.
///
/// @param curves  the curves of the graph
/// @param options of the refinement
/// @param chart   where arcs must not meet
/// @param tested  whether arcs may not meet
/// @param report  receives the largest error of a ring, and the edges drawn back
/// @param error   its `curve` is the one whose area cannot be kept
/// @return BAT_OK, BAT_UNSUPPORTED (another space, or areas that cannot be kept; the arcs are as before), BAT_NO_MEMORY
bat_status arcs_keep_area(const arc_graph *graph, const bat_curve *curves, size_t count,
                          const bat_curve_refine_options *options, const map_chart *chart, bool tested, refined_arcs *fine,
                          bat_curve_map_refine_report *report, bat_error *error);

// Smoothing of the arcs of a map, each once, with its nodes fixed.

/// Smooth the arcs of a graph. Those that then cross others, or have passed over another part, are drawn back.
/// @param options with `smooth`
/// @param chart   where arcs must not meet; null: nothing is tested
/// @param report  receives what smoothing did
/// @param error   its `curve` is the failing arc, its `index` the point of that arc
/// @return BAT_OK, BAT_NO_MEMORY, or the failure of smooth_points()
bat_status arcs_smooth(arc_graph *graph, const bat_curve_refine_options *options, const map_chart *chart,
                       bat_curve_refine_report *report, bat_error *error);

// Edges of arcs that meet in the given map, and may meet in what is made of it.

/// Two edges of arcs that meet.
typedef struct met_pair
{
    edge_place places[2]; ///< each pair occurs in both orders
} met_pair;

/// All zero: none.
typedef struct met_edges
{
    met_pair *pairs; ///< in order
    size_t count, capacity;
} met_edges;

/// Find the edges of arcs that meet, other than at ends that two arcs share.
/// @param charts of the arcs
/// @param met    release it with met_edges_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status met_edges_find(const chart_curves *charts, const map_chart *chart, int threads, met_edges *met, bat_error *error);
void met_edges_free(met_edges *met);

/// Whether two edges meet, or neighbours of them.
bool met_edges_near(const met_edges *met, const bat_curve *arcs, edge_place first, edge_place second);

// Lines that meet end to end, made one line for refinement and cut again after it.

/// Where a curve lies in its chain.
typedef struct chain_member
{
    size_t chain, first; ///< the first point of the curve, or the last of a reversed one, is point `first` of the chain
    bool reversed;
} chain_member;

/// Curves of which some are joined. All zero: no line goes on, and the given curves serve.
typedef struct line_chains
{
    bat_curve *curves;
    size_t count;
    unsigned char **joints; ///< of each chain, flags of the points where curves were joined, twice over
    chain_member *members;  ///< of each given curve
    size_t pairs;           ///< of ends that were joined
} line_chains;

/// Join lines whose ends are at one point. There the set has two neighbouring points, equally many lines end on the side
/// of each, no end is a corner, and both ends have the same channels. A line whose ends meet becomes closed.
///
/// @param curves checked curves in one space
/// @param chains release it with line_chains_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status line_chains_make(const bat_curve *curves, size_t count, line_chains *chains, bat_error *error);

/// Replace a chain and a point of it by a given curve and its point. The point may be BAT_NO_INDEX.
void line_chains_find(const line_chains *chains, const bat_curve *curves, size_t count, size_t *curve, size_t *point);

/// Cut the line from row `first` to row `last` out of a refined chain; around the end of a closed one.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status line_chains_cut(const bat_curve *chain, size_t first, size_t last, bool reversed, bat_curve *line,
                           bat_error *error);

void line_chains_free(line_chains *chains);

/// The flags of an arc's points from line_chains::joints of its curves, null for none.
static inline const unsigned char *arc_joints(const arc_graph *graph, unsigned char *const *joints, size_t arc)
{
    return joints != NULL ? joints[graph->origins[arc].curve] + graph->origins[arc].point : NULL;
}
