#ifndef CURVE_MAP_ARC_SMOOTH_H
#define CURVE_MAP_ARC_SMOOTH_H

#include "curve/map/arc_refine.h"

/// @file
/// Smoothing of the arcs of a map, each once, with its nodes fixed.

/// Smooth the arcs of a graph. Arcs that then cross others which they did not cross, or that have passed over another part
/// of the map, are drawn back until none does.
/// @param options with `smooth`
/// @param chart   where arcs must not meet; null: nothing is tested
/// @param report  receives what smoothing did
/// @param error   its `curve` is the failing arc, its `index` the point of that arc
/// @return BAT_OK, BAT_NO_MEMORY, or the failure of smooth_points()
bat_status arcs_smooth(arc_graph *graph, const bat_curve_refine_options *options, const map_chart *chart,
                       bat_curve_refine_report *report, bat_error *error);

#endif
