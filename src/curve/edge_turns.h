#pragma once

#include <float.h>
#include <math.h>

/// @file
/// The turns of the four vertices around an edge, which the rules for uneven spacing take in place of exterior angles.
///
/// An edge of length e between neighbours of lengths b and a has the exterior angles d_(-1) … d_2, d_0 and d_1 at its ends.
/// The turn of vertex i between edges of lengths l and m is the angle by which a curve of its curvature turns along e:
///
///     y_i = 2 d_i e / max(l + m, e).
///
/// A polygon of a smooth curve has small angles. At a corner, the curve must return to a long edge within the length of the
/// short one beside it. So a vertex counts as a corner with the weight
///
///     w_i = d_i^2 / (d_i^2 + 0.4^2),
///
/// and a corner's turn is divided between its two edges so that both insertions are bounded by the shorter edge: with r the
/// ratio of e to the edge beyond the vertex, c(r) = 1 - r / 2 where r <= 1, else 1 / (2 r),
///
///     z_0 = (1 - w_0) y_0 + w_0 2 d_0 c(e / b),     z_(-1) = (1 - w_(-1) (1 - f(e / b))) y_(-1),
///
/// where f(r) = 1 for r <= 1, else 2 r / (1 + r^2), and z_1, z_2 by reversal. With neighbours as long as the edge, z = y.
///
/// An edge beside a vertex without turn is part of a straight run, unless the curve has its inflection there. With
///
///     s_i = |y_i| + h(y_(i-1), y_(i+1)),     h(u, v) = max(0, -u v) / (|u| + |v|),
///
/// all turns are multiplied by min(1, min(s_0, s_1) / (0.1 max |y_i|)). It is 0 on runs of collinear points, which so remain
/// straight, and 1 on smooth curves.

enum
{
    EDGE_VERTICES = 4,
    EDGE_LENGTHS = 5 ///< of the edges from two before to two behind
};

/// The angle from which on a vertex counts as a corner rather than as part of a smooth curve.
/// Below the share of the largest turn a vertex counts as straight. Chosen among seven and two values on the curves of
/// `reproduce real-curves`.
#define EDGE_CORNER_ANGLE 0.4
#define EDGE_STRAIGHT_SHARE 0.1

/// y_i of an angle between edges of lengths `before` and `after`.
static inline double edge_turn(double angle, double before, double after, double own)
{
    double span = before + after;
    return 2 * angle * own / (span > own ? span : own);
}

/// w_i.
static inline double edge_corner_weight(double angle)
{
    return angle * angle / (angle * angle + EDGE_CORNER_ANGLE * EDGE_CORNER_ANGLE);
}

/// c(own / other).
static inline double edge_corner_share(double own, double other)
{
    return own > other ? 0.5 * other / own : 1 - 0.5 * own / other;
}

/// h(u, v).
static inline double edge_inflection(double u, double v)
{
    double product = -u * v;
    return (product > 0 ? product : 0) / (fabs(u) + fabs(v) + DBL_MIN);
}

/// z_i of an end of the edge; `other` is the length of the edge beyond the vertex.
static inline double edge_near_turn(double angle, double turn, double own, double other)
{
    return turn + edge_corner_weight(angle) * (2 * angle * edge_corner_share(own, other) - turn);
}

/// 1 - f(own / other).
static inline double edge_far_loss(double own, double other)
{
    double ratio = other / own;
    return ratio < 1 ? (1 - ratio) * (1 - ratio) / (1 + ratio * ratio) : 0;
}

/// z_i of a vertex next to an end; `other` is the length of the edge between the two.
static inline double edge_far_turn(double angle, double turn, double own, double other)
{
    return turn * (1 - edge_corner_weight(angle) * edge_far_loss(own, other));
}

/// The lesser of s_0 and s_1.
static inline double edge_least_turn(const double y[EDGE_VERTICES])
{
    double first = fabs(y[1]) + edge_inflection(y[0], y[2]), second = fabs(y[2]) + edge_inflection(y[1], y[3]);
    return first < second ? first : second;
}

/// The factor of all turns, from those of the vertices.
static inline double edge_straight_factor(const double y[EDGE_VERTICES])
{
    double outer = fabs(y[0]) > fabs(y[3]) ? fabs(y[0]) : fabs(y[3]);
    double inner = fabs(y[1]) > fabs(y[2]) ? fabs(y[1]) : fabs(y[2]);
    double least = edge_least_turn(y), largest = outer > inner ? outer : inner;
    double bound = EDGE_STRAIGHT_SHARE * largest + DBL_MIN;
    return least < bound ? least / bound : 1;
}

/// The turns z_i, without the factor.
/// @param angle  of the four vertices
/// @param length of the five edges; angle i lies between length[i] and length[i + 1], and the edge itself has length[2]
/// @param turn   receives the four turns
/// @return edge_straight_factor()
static inline double edge_turns_of(const double *angle, const double *length, double turn[EDGE_VERTICES])
{
    double y[EDGE_VERTICES];
    for (int i = 0; i < EDGE_VERTICES; i++)
        y[i] = edge_turn(angle[i], length[i], length[i + 1], length[2]);
    turn[0] = edge_far_turn(angle[0], y[0], length[2], length[1]);
    turn[1] = edge_near_turn(angle[1], y[1], length[2], length[1]);
    turn[2] = edge_near_turn(angle[2], y[2], length[2], length[3]);
    turn[3] = edge_far_turn(angle[3], y[3], length[2], length[3]);
    return edge_straight_factor(y);
}
