#pragma once

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

// Tensor-product surfaces, the patches of hierarchical ones.

/// A tensor-product spline surface (or a function, or a map, by its dimension). Release it with tensor_surface_free().
typedef struct tensor_surface
{
    bat_knot_vector knots[2]; ///< of the parameters u and v
    double *control;  ///< functions(u) x functions(v) rows of `dimension` coordinates; function i of u and j of v has row j
                      ///< functions(u) + i
    size_t dimension; ///< at least 1
} tensor_surface;

/// Free what a surface owns and make it empty.
void tensor_surface_free(tensor_surface *surface);

/// Split a surface into tensor-product patches: rectangles of cells of one level. Each is the B-spline surface of that level
/// over its part of the square, with clamped knots in the coordinates of the square. Neighbouring patches meet exactly; a
/// long side may meet several short ones.
/// @param patches receives an array from malloc(); release each with tensor_surface_free(), then the array
bat_status spline_surface_patches(const bat_spline_surface *surface, tensor_surface **patches, size_t *count,
                                  bat_error *error);

/// Restrict a surface to [low, high] in a direction, low < high within the domain, with clamped knots.
/// @return BAT_OK, or BAT_NO_MEMORY with the surface unchanged
bat_status tensor_surface_restrict(tensor_surface *surface, int direction, double low, double high, bat_error *error);

/// The clamped knot vector of a part of the domain, with the same interior knots. Release it with knot_vector_free().
bat_status knot_vector_cut(const bat_knot_vector *knots, double low, double high, bat_knot_vector *cut, bat_error *error);

/// Compute the control points over a refined knot vector of a direction, or over a part of it. Unchanged points keep all
/// their bits.
/// @param control receives functions(to) x functions(the other direction) rows, ordered as those of the surface
void tensor_surface_convert(const tensor_surface *surface, int direction, const bat_knot_vector *to, double *control);
