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

/// The blossom (polar form) of a spline segment: the symmetric multiaffine polynomial b(t_1, …, t_p) with b(t, …, t) = S(t).
/// Its values at p consecutive knots are the control points, for any knot vector of the spline (Ramshaw, "Blossoming: a
/// connect-the-dots approach to splines", 1987).

/// Weights of a blossom value: b(arguments) = sum_k weights[k] c_(span - degree + k).
/// @param span      segment, with knots[span] < knots[span + 1]
/// @param arguments degree numbers
/// @param weights   receives degree + 1 numbers with sum 1
void blossom_weights(const bat_knot_vector *knots, size_t span, const double *arguments, double *weights);

#endif
