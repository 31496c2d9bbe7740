#ifndef CURVE_TOPOLOGY_KEEP_SIMPLE_H
#define CURVE_TOPOLOGY_KEEP_SIMPLE_H

#include "batten/curve.h"

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

#endif
