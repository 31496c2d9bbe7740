#ifndef CURVE_MAP_AREA_H
#define CURVE_MAP_AREA_H

#include "curve/map/arc_refine.h"

/// @file
/// Refined arcs, moved so that the rings keep their areas.

/// Give the rings of refined arcs the areas of the given rings, in the plane or on the sphere.
///
/// A point over a given edge of length L moves sideways by 16 t s^2 (1 - s)^2 L, where s is its share of the edge and t
/// belongs to the arc, so that given points stay and no corner appears. The numbers t are those with the smallest weighted
/// sum of squares for which all rings have their areas, by Newton's method. Edges whose points would then cross others
/// stay as they are, and the others take their part.
///
/// @param curves  the curves of the graph
/// @param options of the refinement
/// @param chart   where arcs must not meet
/// @param tested  whether arcs may not meet
/// @param largest receives the largest error of a ring, relative to its area
/// @param error   its `curve` is the one whose area cannot be kept
/// @return BAT_OK, BAT_UNSUPPORTED (another space, or areas that cannot be kept), BAT_NO_MEMORY
bat_status arcs_keep_area(const arc_graph *graph, const bat_curve *curves, size_t count,
                          const bat_curve_refine_options *options, const map_chart *chart, bool tested, refined_arcs *fine,
                          double *largest, bat_error *error);

#endif
