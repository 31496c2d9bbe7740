#ifndef IO_SURFACE_CUT_H
#define IO_SURFACE_CUT_H

#include "batten/spline.h"

/// @file
/// Parts of splines as clamped splines: what CAD programs take for a curve or a surface of its own.

/// The clamped knots of a part of the domain, with the same knots inside.
/// @param cut release it with bat_knot_vector_free()
bat_status cut_knots(const bat_knot_vector *knots, double from, double to, bat_knot_vector *cut, bat_error *error);

/// The control points of a curve over finer knots, or over those of a part, as blossoms (Goldman, 1990; the Oslo algorithm).
/// Points that do not change keep all their bits.
/// @param control points of `dimension` coordinates for the functions of `knots`
/// @param result  the same for those of `cut`
bat_status cut_control(const bat_knot_vector *knots, const bat_knot_vector *cut, const double *control, size_t dimension,
                       double *result, bat_error *error);

/// Clamp a surface to its domain in both directions.
bat_status cut_clamp(bat_tensor_surface *surface, bat_error *error);

#endif
