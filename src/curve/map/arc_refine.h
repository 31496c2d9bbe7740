#ifndef CURVE_MAP_ARC_REFINE_H
#define CURVE_MAP_ARC_REFINE_H

#include "batten/curve_map.h"

#include "curve/map/arc_graph.h"
#include "curve/map/chart.h"

/// @file
/// Refinement of the arcs of a map, so that those that do not meet before do not meet after.

/// Refined arcs. All zero: empty.
typedef struct refined_arcs
{
    bat_curve *arcs; ///< `count`, in the order of the graph
    size_t count;
    size_t **starts; ///< of each arc: its point i is point starts[i] of the refined one; null: equally many to each edge
} refined_arcs;

/// Refine the arcs of a graph.
/// @param options complete and valid, with a scheme; corners are ends of arcs already
/// @param chart   where arcs must not meet; null: nothing is tested
/// @param report  receives what was found and done
/// @param fine    release it with refined_arcs_free(), also on failure
/// @param error   its `curve` is the failing arc, its `index` the point of that arc
/// @return as bat_curve_map_refine()
bat_status refined_arcs_make(const arc_graph *graph, const bat_curve_refine_options *options, const map_chart *chart,
                             bat_curve_map_refine_report *report, refined_arcs *fine, bat_error *error);

/// The row of a refined arc where vertex `i` of the arc is, for schemes that keep the given points.
size_t refined_arcs_row(const refined_arcs *fine, const arc_graph *graph, size_t arc, size_t i);

void refined_arcs_free(refined_arcs *fine);

#endif
