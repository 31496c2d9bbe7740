#ifndef SURFACE_SPLINE_KNOT_VECTOR_H
#define SURFACE_SPLINE_KNOT_VECTOR_H

#include "batten/spline.h"

/// @file
/// Univariate B-splines, and curves that trim surfaces. Notation is that of Piegl and Tiller, "The NURBS Book" (1997): a
/// knot vector of degree p with n + p + 1 knots carries n functions; function i lives on [knots[i], knots[i + p + 1]].

/// The clamped knot vector of [0, 1] with `spans` equal spans.
/// @return BAT_OK, BAT_INVALID_ARGUMENT (degree, no spans), BAT_TOO_LARGE or BAT_NO_MEMORY
bat_status knot_vector_uniform(int degree, size_t spans, bat_knot_vector *knots, bat_error *error);
/// Check the conditions of every call that takes a knot vector: finite nondecreasing knots, none more than degree + 1 times,
/// and a domain [knots[degree], knots[count - degree - 1]] of positive length.
/// @return BAT_OK or BAT_INVALID_ARGUMENT with the failing knot
bat_status knot_vector_check(const bat_knot_vector *knots, bat_error *error);
/// Free what a knot vector owns and make it empty.
void knot_vector_free(bat_knot_vector *knots);
/// The number of functions.
static inline size_t knot_vector_functions(const bat_knot_vector *knots)
{
    return knots->count - (size_t)knots->degree - 1;
}

/// The span of a parameter t in the domain: the i with knots[i] <= t < knots[i + 1], at the domain's end the last such one.
size_t knot_vector_span(const bat_knot_vector *knots, double t);
/// The degree + 1 functions that do not vanish on a span, and their derivatives (The NURBS Book, A2.3).
/// @param values receives (derivatives + 1) x (degree + 1) numbers: row k the k-th derivatives of functions span - degree to
///               span
void knot_vector_basis(const bat_knot_vector *knots, size_t span, double t, int derivatives, double *values);
/// Free what a curve owns and make it empty.
void spline_curve_free(bat_spline_curve *curve);

/// Check the conditions of every call that takes trimming curves.
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a wrong knot vector or dimension, a curve that leaves the square or is not
///         clamped, or a loop that is not closed to 1e-9
bat_status spline_trim_check(const bat_spline_trim *trim, bat_error *error);
/// Free what trimming curves own and make them empty.
void spline_trim_free(bat_spline_trim *trim);

#endif
