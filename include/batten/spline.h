#ifndef BATTEN_SPLINE_H
#define BATTEN_SPLINE_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Univariate and tensor-product B-splines of any degree.
///
/// Notation is that of Piegl and Tiller, "The NURBS Book" (1997): a knot vector of degree p with n + p + 1 knots carries n
/// functions; function i lives on [knots[i], knots[i + p + 1]].

/// The highest degree that any call takes.
#define BAT_SPLINE_MAX_DEGREE 15

/// A knot vector. All zero: none. Release it with bat_knot_vector_free().
typedef struct bat_knot_vector
{
    double *knots; ///< count numbers, nondecreasing, owned
    size_t count;  ///< at least 2 degree + 2
    int degree;    ///< 0 to BAT_SPLINE_MAX_DEGREE
} bat_knot_vector;

/// The clamped knot vector of [0, 1] with `spans` equal spans.
/// @return BAT_OK, BAT_INVALID_ARGUMENT (degree, no spans), BAT_TOO_LARGE or BAT_NO_MEMORY
BAT_API bat_status bat_knot_vector_uniform(int degree, size_t spans, bat_knot_vector *knots, bat_error *error);
/// Check the conditions of every call that takes a knot vector: finite nondecreasing knots, none more than degree + 1 times,
/// and a domain [knots[degree], knots[count - degree - 1]] of positive length.
/// @return BAT_OK or BAT_INVALID_ARGUMENT with the failing knot
BAT_API bat_status bat_knot_vector_check(const bat_knot_vector *knots, bat_error *error);
/// Copy a knot vector.
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_knot_vector_copy(const bat_knot_vector *knots, bat_knot_vector *copy, bat_error *error);
/// Free what a knot vector owns and make it empty.
BAT_API void bat_knot_vector_free(bat_knot_vector *knots);

/// The number of functions.
static inline size_t bat_knot_vector_functions(const bat_knot_vector *knots)
{
    return knots->count - (size_t)knots->degree - 1;
}

/// The span of a parameter t in the domain: the i with knots[i] <= t < knots[i + 1], at the domain's end the last such one.
BAT_API size_t bat_knot_vector_span(const bat_knot_vector *knots, double t);
/// The degree + 1 functions that do not vanish on a span, and their derivatives (The NURBS Book, A2.3).
/// @param values receives (derivatives + 1) x (degree + 1) numbers: row k the k-th derivatives of functions span - degree to
///               span
BAT_API void bat_knot_vector_basis(const bat_knot_vector *knots, size_t span, double t, int derivatives, double *values);

/// A spline curve. Release it with bat_spline_curve_free().
typedef struct bat_spline_curve
{
    bat_knot_vector knots;
    double *control;  ///< functions x dimension, owned
    size_t dimension; ///< at least 1
} bat_spline_curve;

/// Free what a curve owns and make it empty.
BAT_API void bat_spline_curve_free(bat_spline_curve *curve);

/// A tensor-product spline surface (or a function, or a map, by its dimension). Release it with bat_tensor_surface_free().
typedef struct bat_tensor_surface
{
    bat_knot_vector knots[2]; ///< of the parameters u and v
    double *control;  ///< functions(u) x functions(v) rows of `dimension` coordinates; function i of u and j of v has row j
                      ///< functions(u) + i
    size_t dimension; ///< at least 1
} bat_tensor_surface;

/// Check both knot vectors, the dimension, and that control points are finite.
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_INVALID_POINT with the control point
BAT_API bat_status bat_tensor_surface_check(const bat_tensor_surface *surface, bat_error *error);
/// Copy a surface.
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_tensor_surface_copy(const bat_tensor_surface *surface, bat_tensor_surface *copy, bat_error *error);
/// Free what a surface owns and make it empty.
BAT_API void bat_tensor_surface_free(bat_tensor_surface *surface);

/// Evaluate a surface and its derivatives.
/// @param parameters  count x 2, in the domain
/// @param derivatives 0: positions; 1: also S_u, S_v; 2: also S_uu, S_uv, S_vv
/// @param values      receives count x (1, 3 or 6) x dimension, in that order
/// @return BAT_OK or BAT_INVALID_POINT with the parameter that is not in the domain
BAT_API bat_status bat_tensor_surface_evaluate(const bat_tensor_surface *surface, const double *parameters, size_t count,
                                               int derivatives, double *values, bat_error *error);

BAT_C_END

#endif
