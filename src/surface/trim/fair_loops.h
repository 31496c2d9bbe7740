#ifndef SURFACE_TRIM_FAIR_LOOPS_H
#define SURFACE_TRIM_FAIR_LOOPS_H

#include "surface/trim/outline.h"

/// @file
/// Trimming curves through the loops of an outline: corners, and cubic splines of least squares between them.

/// Fit trimming curves to loops. Points inside a patch that was scanned at random places end before the true edge. Their
/// loops are rough, and the curves lie outside of them by OFFSET times the roughness. Points on the edge are met.
/// @param sides      of the rectangle that the square stands for, in units of the scaled cloud
/// @param parameters of the points, count x 2
/// @param spacing    of the points, in units of the scaled cloud
/// @param noise      standard deviation of a coordinate, in units of the scaled cloud
/// @return BAT_OK or BAT_NO_MEMORY; `trim` is empty on failure
bat_status fair_loops_make(const outline_loops *loops, const double sides[2], const double *parameters,
                           const double *spacing, double noise, bat_spline_trim *trim, bat_error *error);

#endif
