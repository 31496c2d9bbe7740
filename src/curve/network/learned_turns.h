#pragma once

#include "batten/curve_scheme.h"
#include "curve/edge_turns.h"
#include "curve/network/learned_features.h"

/// @file
/// What the features of an edge and their gradient, research/train/learned_features_back.c, have in common.

#define LEARNED_MIDDLE 3 ///< on either side: the turns whose variance is taken
/// Root mean square turn from which on an edge's surroundings count as coarse, in one of the features.
static const double LEARNED_FINE = 0.05;
/// Brings exterior angles to the size of the other features.
static const double LEARNED_ANGLE_UNIT = 0.6;
/// The farthest that a new vertex lies from its edge, in lengths of the edge beside it.
static const double LEARNED_BULGE = 1;
/// The six-point rule in turns, by distance from the edge.
static const double LEARNED_SIX_POINT[2] = {-5.0 / 32, 1.0 / 32};

/// What the features and their gradient need. Turn i of the polygon, R = LEARNED_REACH, is turn[i + R - 1], i = 1 - R … R.
typedef struct learned_turns
{
    double turn[2 * LEARNED_REACH];
    double strength, strength_squared; ///< root mean square of the turns
    double mean, variance;             ///< of the middle turns
    double scale;                      ///< without the factor
    double bend;                       ///< root mean square of the exterior angles
    double factor;                     ///< edge_straight_factor()
} learned_turns;

/// The turns around an edge, from the arguments of learned_features_of().
learned_turns learned_turns_of(const double *angles, const double *lengths);

/// The edge whose length bounds the insertion angle.
static inline int learned_bounding_edge(const double *lengths, double parity)
{
    return parity > 0 ? -1 : parity < 0 ? 1 : lengths[-1] > lengths[1] ? -1 : 1;
}

/// The bound of the insertion angle that keeps the new vertex near its edge.
static inline double learned_limit(const double *lengths, double parity)
{
    return fmin(atan(2 * LEARNED_BULGE * lengths[learned_bounding_edge(lengths, parity)] / lengths[0]),
                BAT_CURVE_ANGLE_LIMIT);
}

/// The six-point rule of four turns, without the factor.
static inline double learned_six_point(const double turns[EDGE_VERTICES])
{
    return LEARNED_SIX_POINT[0] * (turns[1] + turns[2]) + LEARNED_SIX_POINT[1] * (turns[0] + turns[3]);
}
