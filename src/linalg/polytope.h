#ifndef LINALG_POLYTOPE_H
#define LINALG_POLYTOPE_H

#include "linalg/joint_radius.h"

/// A polytope symmetric about the origin, the convex hull of +-v over its vertices v: the unit ball of a norm on R^n.
/// Some listed vertices may lie inside; that costs time only.
typedef struct polytope
{
    size_t dimension;
    size_t count;
    size_t capacity;
    double *vertices; ///< count x dimension; the first `dimension` are multiples of the unit vectors

    /// The simplex method's state, kept from one norm to the next: `dimension` vertices that span the space, and the inverse
    /// of the matrix that has them as columns.
    size_t *basis;
    double *inverse;
    double *scratch;
} polytope;

/// A polytope that grows by the images of its vertices under matrices divided by `rate`, until they all lie inside.
typedef struct polytope_growth
{
    const matrix_set *set;
    double rate;
    polytope hull;
    size_t frontier;       ///< the first vertex whose images have not been looked at
    double largest_inside; ///< the largest norm of an image that was found inside
    bool full;             ///< there was no room for a vertex: further rounds would prove nothing
} polytope_growth;

/// Start from `seed_count` vectors and small multiples of the unit vectors.
/// @param set must outlive the growth
bat_status polytope_growth_make(const matrix_set *set, double rate, const double *seeds, size_t seed_count, size_t capacity,
                                polytope_growth *growth, bat_error *error);
void polytope_growth_free(polytope_growth *growth);

/// One round: measure the images of the newest vertices, then add those outside.
/// @param bound receives rate times the largest norm of an image of a vertex of the polytope as it was before the round: an
///              upper bound of the joint spectral radius
/// @param closed receives whether no image was outside
bat_status polytope_growth_round(polytope_growth *growth, double *bound, bool *closed, bat_error *error);

#endif
