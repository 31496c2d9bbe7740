#ifndef SURFACE_SPLINE_TENSOR_SURFACE_H
#define SURFACE_SPLINE_TENSOR_SURFACE_H

#include "surface/spline/knot_vector.h"

/// @file
/// Tensor-product surfaces, the patches of hierarchical ones.

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

#endif
