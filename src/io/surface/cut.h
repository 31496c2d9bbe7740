#ifndef IO_SURFACE_CUT_H
#define IO_SURFACE_CUT_H

#include "batten/spline.h"
#include "surface/spline/tensor_surface.h"

/// @file
/// Parts of splines as clamped splines, which CAD programs use for separate curves and surfaces.

/// The clamped knot vector of a part of the domain, with the same interior knots.
/// @param cut release it with knot_vector_free()
bat_status cut_knots(const bat_knot_vector *knots, double from, double to, bat_knot_vector *cut, bat_error *error);

/// Compute the control points over a refined knot vector or a part of it, by blossoms (Goldman, 1990). Unchanged points keep
/// all their bits.
/// @param control points of `dimension` coordinates for the functions of `knots`
/// @param result  the same for the functions of `cut`
bat_status cut_control(const bat_knot_vector *knots, const bat_knot_vector *cut, const double *control, size_t dimension,
                       double *result, bat_error *error);

/// Clamp a surface to its domain in both directions.
bat_status cut_clamp(tensor_surface *surface, bat_error *error);

#endif
