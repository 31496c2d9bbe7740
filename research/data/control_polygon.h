#ifndef RESEARCH_DATA_CONTROL_POLYGON_H
#define RESEARCH_DATA_CONTROL_POLYGON_H

#include "batten/base.h"
#include "batten/research/curve_data.h"

/// @file
/// Vertices of a polyline that are evenly spaced by chord length, as Ugail and Howard (2026), section 6.1, choose control
/// points.

/// A vertex that falls short of its share by no more than this part of the total length has reached it: on symmetric curves
/// vertices lie exactly at a share, where rounding must not choose between them and the next.
///
/// Measured over the 1,200 published curves: rounding moves a length by at most 1.5e-14 of the total. Vertices at a share by
/// symmetry miss it by at most 1.2e-14, but for superellipses, where cos(pi / 2) = 6.1e-17 to a power below 1 counts: those
/// miss theirs by 1e-16 to 6.4e-7. No other vertex comes nearer to a share than 1.6e-8, and no vertex misses one by the
/// tolerance to within 1.9e-11.
#define ARC_SAMPLES_TOLERANCE 1e-9

/// For k = 0 … sample_count - 1, the first vertex whose chord length from vertex 0 reaches k / sample_count of the total.
///
/// @param points  count x dim, count >= 1
/// @param closed  whether the total includes the segment from the last point to the first
/// @param lengths receives the count + 1 chord lengths from vertex 0 to each vertex and once round to vertex 0
/// @param samples receives sample_count indices
void arc_samples(const double *points, size_t count, size_t dim, bool closed, double *lengths, size_t sample_count,
                 size_t *samples);

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
