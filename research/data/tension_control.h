#ifndef RESEARCH_DATA_TENSION_CONTROL_H
#define RESEARCH_DATA_TENSION_CONTROL_H

#include "batten/research/curve_data.h"

/// @file
/// Control polygons from the points of a closed curve, as arc_samples() chooses them, with any start and uneven spacing.

/// How to choose.
typedef struct tension_control_plan
{
    size_t count;  ///< control points, at least 3
    double start;  ///< where the first lies, as a share of the curve's length from its point 0, in [0, 1)
    double jitter; ///< each is moved by up to half of this share of the spacing, in [0, 1); 0: even spacing
} tension_control_plan;

/// For each control point, the first of the curve's points whose chord length from point 0 reaches the control point's
/// place.
///
/// @param points      count x 2, on the sphere count x 3
/// @param random      what the jitter draws from; null only where there is none
/// @param lengths     room for count + 1 numbers; receives the chord lengths from point 0, the last once round
/// @param samples     receives plan->count indices, in the curve's order from the start
/// @return false where neighbours among the chosen coincide or, on the sphere, are nearly antipodal: draw anew
bool tension_control_sample(bat_tension_space space, const double *points, size_t count, const tension_control_plan *plan,
                            bat_random *random, double *lengths, size_t *samples);

#endif
