#ifndef RESEARCH_DATA_SIMPLIFY_H
#define RESEARCH_DATA_SIMPLIFY_H

#include "batten/base.h"

/// @file
/// Choice of control points among the points of a plane curve, in the ways in which people sample curves.

typedef enum curve_sampling
{
    CURVE_SAMPLING_EVEN,            ///< equal arc lengths
    CURVE_SAMPLING_UNEVEN,          ///< log-normal arc lengths
    CURVE_SAMPLING_DOUGLAS_PEUCKER, ///< the farthest point first (Douglas and Peucker 1973)
    CURVE_SAMPLING_VISVALINGAM,     ///< the smallest triangle goes first (Visvalingam and Whyatt 1993)
    CURVE_SAMPLING_TIME,            ///< equal times of a moving point, which is slower where the curve turns
    CURVE_SAMPLING_CURVATURE,       ///< equal turns, up to a small share of equal arc lengths
    CURVE_SAMPLING_COUNT
} curve_sampling;

enum
{
    SIMPLIFY_MAX_POINTS = 1024
};

/// Choose `wanted` control points, in the order of the curve.
/// @param points  count x 2, nearly even by arc length; count at most SIMPLIFY_MAX_POINTS, at least 4 wanted
/// @param closed  an open curve keeps its ends
/// @param samples receives `wanted` indices
void curve_sample(curve_sampling how, const double *points, size_t count, bool closed, size_t wanted, bat_random *random,
                  size_t *samples);

#endif
