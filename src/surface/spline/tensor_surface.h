#ifndef SURFACE_SPLINE_TENSOR_SURFACE_H
#define SURFACE_SPLINE_TENSOR_SURFACE_H

#include "batten/spline.h"

/// @file
/// Operations on tensor-product surfaces besides those of batten/spline.h.

/// Restrict a surface to [low, high] in a direction, low < high within the domain, with clamped knots.
/// @return BAT_OK, or BAT_NO_MEMORY with the surface unchanged
bat_status tensor_surface_restrict(bat_tensor_surface *surface, int direction, double low, double high, bat_error *error);

/// The blossom (polar form) of a spline segment: the symmetric multiaffine polynomial b(t_1, …, t_p) with b(t, …, t) = S(t).
/// Its values at p consecutive knots are the control points, for any knot vector of the spline (Ramshaw, "Blossoming: a
/// connect-the-dots approach to splines", 1987).

/// Weights of a blossom value: b(arguments) = sum_k weights[k] c_(span - degree + k).
/// @param span      segment, with knots[span] < knots[span + 1]
/// @param arguments degree numbers
/// @param weights   receives degree + 1 numbers with sum 1
void blossom_weights(const bat_knot_vector *knots, size_t span, const double *arguments, double *weights);

#endif
