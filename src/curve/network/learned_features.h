#pragma once

#include "learn/klein.h"

/// @file
/// The features of an edge for the learned curve rule, and the classical rule that the network corrects: the six-point rule
/// in turns.
///
/// The exterior angles d and the lengths e around the edge, e_0 being its own, give the turns y_i of curve/edge_turns.h, and
/// the factor that keeps straight runs straight. The six-point rule in turns,
///
///     base = -factor (5 (y_0 + y_1) - (y_(-1) + y_2)) / 32,
///
/// is the outward six-point rule of Ugail and Howard (2026, eq. 9 with mu = -1/4) where the edges are equally long. The
/// learned rule multiplies it by a gate between 0 and 2, and adds a correction of at most
///
///     scale = factor sqrt(t^2 + r^4) / (1 + r),
///
/// where r is the root mean square of the turns and t^2 the variance of the middle ones. Where the curvature is continuous,
/// the scale falls by 4 with every level, and the turns fall by 2. No angle moves the new vertex farther from the edge than
/// half of a neighbouring edge: at the first level the longer of the two, later the one beyond the given point.
///
/// A mirror image has the opposite turns. The reversed polygon has the opposite turns in reversed order. The features are in
/// blocks according to the effect of the two (learn/klein.h): the first reflection is the mirror, the second is mirror and
/// reversal together, which exchanges the two ends of the edge and nothing else.

/// How a polygon was sampled decides how far its curve bulges over an edge: the points of a simplified curve are extreme
/// ones, points at random are not. Statistics of a wider range of the given polygon tell the two apart. The *deviation* of
/// vertex i is its distance from the point of the line between its neighbours that divides it like their edges,
///
///     h_i = e_(i-1) e_i / (e_(i-1) + e_i) 2 sin(|d_i| / 2).
///
/// After Douglas and Peucker's simplification all deviations are above its tolerance, and after Visvalingam and Whyatt's all
/// areas e_(i-1) e_i 2 sin(|d_i| / 2) are above one; so their logarithms vary little.

#ifndef LEARNED_REACH
#define LEARNED_REACH 4
#endif
#ifndef LEARNED_RANGE
#define LEARNED_RANGE 16
#endif

enum
{
    /// Size of the turns (2), their variance, size of the exterior angles, curvature of the space, fairness, level.
    LEARNED_PLAIN_SCALARS = 7,
    /// Mean and deviation of the logarithms of vertex deviations; deviations of those of areas and of lengths; how often
    /// neighbours turn the same way; mean and deviation of absolute angles; share of vertices that are nearly straight; how
    /// far the least and the greatest deviation, the least area and the greatest length lie from their means; correlations
    /// of neighbouring lengths, and of angles with the lengths beside them.
    LEARNED_STATISTICS = 14,
    LEARNED_SCALARS = LEARNED_PLAIN_SCALARS + LEARNED_STATISTICS,
    LEARNED_FEATURES = LEARNED_REACH + LEARNED_SCALARS + LEARNED_REACH + 1 + 4 * LEARNED_REACH
};

/// The blocks of the features.
static inline klein_widths learned_widths(void)
{
    return (klein_widths){{[KLEIN_KEPT] = LEARNED_REACH + LEARNED_SCALARS,
                           [KLEIN_SECOND] = LEARNED_REACH + 1,
                           [KLEIN_FIRST] = 2 * LEARNED_REACH,
                           [KLEIN_BOTH] = 2 * LEARNED_REACH}};
}

/// What the features of an edge depend on besides angles and lengths.
typedef struct learned_setting
{
    double curvature; ///< of the space
    double fairness;
    double level;  ///< 0 for the given polygon, 1 for the first refined one
    double parity; ///< level 1: 1 where the edge begins at a given point, -1 where it ends at one; level 0: 0
} learned_setting;

/// The classical part of the rule for one edge.
typedef struct learned_edge
{
    double base;  ///< insertion angle of the six-point rule in turns, positive to the left of the edge
    double scale; ///< bound of the correction
    double limit; ///< of the insertion angle
} learned_edge;

/// What the features of neighbouring edges share, of vertex i between the edges i - 1 and i. No unit of length changes it.
typedef struct learned_logs
{
    double ratio; ///< ln (e_i / e_(i-1))
    double span;  ///< ln ((e_(i-1) + e_i) / e_i)
    double turn;  ///< ln (2 sin(|d_i| / 2)), and a little more, so that a straight vertex has a logarithm
} learned_logs;

/// The logarithms around a run of edges.
/// @param angles,lengths as learned_features_of() has them, of the first edge
/// @param statistics     whether spans and turns are wanted: those of level 0
/// @param logs           receives count + 2 LEARNED_RANGE - 1 entries, the first of vertex 1 - LEARNED_RANGE
void learned_logs_of(const double *angles, const double *lengths, size_t count, bool statistics, learned_logs *logs);

/// The brake: what is left of an angle of level 0 in a simplified line, whose least deviation is not far below the mean.
///
/// The simplification of Douglas and Peucker leaves out what is nearer to an edge than a tolerance, and hardly a vertex is
/// nearer to the line between its neighbours. So a long edge that would bend by more than the least deviation is straight.
/// In rough lines, where neighbours turn to either side and edges differ, the curve bends less than the network expects.
/// The bounds were chosen with the curves of `reproduce real-curves` and random lines in view.
/// @param wanted share of the loss of rough lines
double learned_braked(const double *angles, const learned_logs *logs, double wanted, double angle);

/// The insertion angle of an edge, within the edge's limit.
/// @param correction,gate the outputs of the network
double learned_angle(learned_edge edge, double correction, double gate);

/// Compute the features of an edge.
/// @param angles    angles[i] is that of vertex i, 1 - LEARNED_RANGE <= i <= LEARNED_RANGE; the edge goes from vertex 0 to 1
/// @param lengths   lengths[i] is that of edge i, -LEARNED_RANGE <= i <= LEARNED_RANGE, positive
/// @param logs      logs[i] is that of vertex i, 1 - LEARNED_RANGE <= i <= LEARNED_RANGE
/// @param features  receives the numbers of learned_widths()
learned_edge learned_features_of(const double *angles, const double *lengths, learned_setting setting,
                                 const learned_logs *logs, double *features);
