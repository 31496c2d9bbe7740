#ifndef LINALG_POLYTOPE_H
#define LINALG_POLYTOPE_H

#include "batten/base.h"

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

/// The hull of +-radius e_j, with room for `capacity` vertices in all.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status polytope_make(size_t dimension, size_t capacity, double radius, polytope *result, bat_error *error);
void polytope_free(polytope *p);

/// Add a vertex; false when there is no more room.
bool polytope_add(polytope *p, const double *vertex);

/// An upper bound of the norm of every vector within `uncertainty` (entry by entry) of `x`, valid whatever rounding did, and
/// equal to the norm of `x` but for rounding, unless the norm is at most `enough`: then the bound is at most `enough` too,
/// but for rounding, and the search ends early.
///
/// norm(x) = min { sum |c_i| : x = sum c_i v_i }, by the primal simplex method with long steps.
double polytope_norm(polytope *p, const double *x, const double *uncertainty, double enough);

#endif
