#ifndef SURFACE_SPLINE_TENSOR_SURFACE_H
#define SURFACE_SPLINE_TENSOR_SURFACE_H

#include "batten/spline.h"

/// Cut a surface down to the part between two parameters of a direction's domain, low below high, its knots clamped there.
/// @return BAT_OK or BAT_NO_MEMORY, the surface then being as it was
bat_status tensor_surface_restrict(bat_tensor_surface *surface, int direction, double low, double high, bat_error *error);

/// Blossoms of splines (Ramshaw, "Blossoming: a connect-the-dots approach to splines", 1987): the symmetric polynomial of as
/// many arguments as the degree, linear in each, that is the spline's segment where all are equal. Its values at consecutive
/// knots are the control points; at those of another knot vector of the same spline they are the control points there.

/// What control points count in a blossom: with c those from span - degree on, its value is sum_k weights[k] c[k].
/// @param span      knots[span] < knots[span + 1], the segment
/// @param arguments degree numbers
/// @param weights   receives degree + 1 numbers that add up to one
void blossom_weights(const bat_knot_vector *knots, size_t span, const double *arguments, double *weights);

#endif
