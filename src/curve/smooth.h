#pragma once

#include "base/memory.h"
#include "batten/curve.h"

/// @file
/// Smoothing of the points of a curve, before its refinement.

/// Whether the options (null for the defaults) ask for smoothing.
bool smooth_wanted(const bat_curve_refine_options *options);

/// Smooth the points of a curve. Ends and corners stay.
/// @param curve  a checked curve; only its points are read
/// @param scale  bat_curve_refine_options::smooth, not 0
/// @param corners curve->count flags, or null
/// @param points receives curve->count rows
/// @param noise  receives the estimated standard deviation of a coordinate; 0 where nothing is estimated
/// @return BAT_OK, BAT_UNSUPPORTED (other spaces' closed curves), BAT_CUT_LOCUS, BAT_INVALID_POINT or BAT_NO_MEMORY
bat_status smooth_points(const bat_curve *curve, double scale, const unsigned char *corners, double *points, double *noise,
                         bat_error *error);

/// Add the moves of a curve's points to a report.
void smooth_report(const bat_curve *given, const double *points, double noise, bat_curve_refine_report *report);
/// Add the moves that one report tells to another.
void smooth_report_add(bat_curve_refine_report *sum, const bat_curve_refine_report *one);

/// A curve with smoothed points, with flags of its corners where it has corners or `options` a corner angle. One that is to
/// stay simple, see bat_curve_simple, is drawn back until it is.
/// @param smooth release it with bat_curve_free()
/// @param report receives what smoothing did; its other numbers are 0
/// @return as smooth_points(); BAT_INVALID_ARGUMENT or what bat_curve_check() returns
bat_status smooth_curve(const bat_curve *curve, const bat_curve_refine_options *options, bat_curve *smooth,
                        bat_curve_refine_report *report, bat_error *error);

// Smoothed points drawn back to the given ones, near edges that meet.

/// The points of a smoothed curve, and the shares of their ways that they have come.
typedef struct smooth_back
{
    bat_curve given;  ///< its points are in `pool`
    double *smoothed; ///< the points at share 1
    double *shares, *factors;
    bool marked;      ///< an edge since the last smooth_back_move()
    memory_pool pool; ///< of all arrays
} smooth_back;

/// Copy a given curve.
/// @param back release it with smooth_back_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status smooth_back_make(const bat_curve *given, smooth_back *back, bat_error *error);
void smooth_back_free(smooth_back *back);

/// Take these points as those at share 1.
void smooth_back_begin(smooth_back *back, const double *points);
/// Let the points beside an edge come half as far, and points farther along the curve less and less of it.
void smooth_back_mark(smooth_back *back, size_t edge);
/// Move the points of marked edges along geodesics. `*moved` becomes true where one moved.
/// @return BAT_OK, or what bat_space_geodesic() returns
bat_status smooth_back_move(smooth_back *back, double *points, bool *moved);
