#ifndef CURVE_NETWORK_LEARNED_FEATURES_H
#define CURVE_NETWORK_LEARNED_FEATURES_H

#include "learn/klein.h"

#include <stddef.h>

/// @file
/// What the shipped curve rule sees of an edge, and where it begins: the six-point rule.
///
/// Everything is made of the exterior angles d and lengths e around the edge, e_0 being its own, as *turns*
///
///     y_i = 2 d_i e_0 / max(e_(i-1) + e_i, e_0),
///
/// which is how far a curve turns over the edge at the curvature that vertex i shows. (The bound matters at a vertex between
/// two edges that together are shorter than this one.) The six-point rule in turns,
///
///     base = -(5 (y_0 + y_1) - (y_(-1) + y_2)) / 32,
///
/// is the outward six-point rule of Ugail and Howard (2026, eq. 9 with mu = -1/4) where the edges are equally long, and
/// gives an arc of constant curvature however long they are. A network adds to it at most
///
///     scale = sqrt(t^2 + r^4) / (1 + r),
///
/// with r the root mean square of the turns and t^2 the variance of the middle ones: an amount that falls by 4 with every
/// level where the curvature is continuous, as the turns themselves fall by 2. So whatever the weights are, the rule comes
/// near the six-point rule as the polygon becomes fine.
///
/// A mirror image has the opposite turns, and so has the reversed polygon, in reversed order. What a network sees is sorted
/// by what the two do to it (learn/klein.h, first the mirror, second mirror and reversal together, which exchanges the two
/// ends of the edge and nothing else).

#ifndef LEARNED_REACH
#define LEARNED_REACH 4
#endif

enum
{
    LEARNED_ANGLES = 2 * LEARNED_REACH,      ///< of the vertices 1 - reach … reach
    LEARNED_LENGTHS = 2 * LEARNED_REACH + 1, ///< of the edges -reach … reach
    LEARNED_SCALARS = 5, ///< how strong the turns are (2), how uneven, the curvature of the space, the fairness
    LEARNED_FEATURES = 4 * LEARNED_REACH + LEARNED_SCALARS
};

/// The blocks of the features.
static inline klein_widths learned_widths(void)
{
    return (klein_widths){{[KLEIN_KEPT] = LEARNED_REACH + LEARNED_SCALARS,
                           [KLEIN_SECOND] = LEARNED_REACH,
                           [KLEIN_FIRST] = LEARNED_REACH,
                           [KLEIN_BOTH] = LEARNED_REACH}};
}

/// One edge.
typedef struct learned_features
{
    double base;  ///< insertion angle of the six-point rule, positive to the left of the edge
    double scale; ///< of what a network may add
} learned_features;

/// @param angles    angles[i] is that of vertex i, 1 - LEARNED_REACH <= i <= LEARNED_REACH; the edge goes from vertex 0 to 1
/// @param lengths   lengths[i] is that of edge i, -LEARNED_REACH <= i <= LEARNED_REACH, positive
/// @param curvature of the space
/// @param features  receives the numbers of learned_widths()
learned_features learned_see(const double *angles, const double *lengths, double curvature, double fairness,
                             double *features);
/// Adds to the gradients, which are placed like the angles and lengths.
void learned_see_back(const double *angles, const double *lengths, double curvature, const double *feature_gradient,
                      learned_features sight_gradient, double *angle_gradient, double *length_gradient);

#endif
