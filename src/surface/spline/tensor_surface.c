/// @file
/// Tensor-product B-spline surfaces: restriction.
///     S(u, v) = sum_ij c_ij B_i(u) B_j(v)
/// A change of the knot vector of a direction is a linear map of the control points. Row i of the map has degree + 1
/// weights: the blossom at the knots of the new function i.

#include "surface/spline/tensor_surface.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>

void tensor_surface_free(tensor_surface *surface)
{
    for (int d = 0; d < 2; d++)
        knot_vector_free(&surface->knots[d]);
    free(surface->control);
    *surface = (tensor_surface){0};
}

void blossom_weights(const bat_knot_vector *knots, size_t span, const double *arguments, double *weights)
{
    const double *after = knots->knots + span + 1;
    weights[0] = 1;
    for (int j = 1; j <= knots->degree; j++)
    {
        double t = arguments[j - 1], saved = 0;
        for (int r = 0; r < j; r++)
        {
            double upper = after[r], lower = after[r - j], share = weights[r] / (upper - lower);
            weights[r] = saved + (upper - t) * share;
            saved = (t - lower) * share;
        }
        weights[j] = saved;
    }
}

/// The index of the last knot <= t, which is not the last of all knots.
static size_t last_not_above(const bat_knot_vector *knots, double t)
{
    size_t last = knots->count - 1;
    while (knots->knots[last] > t)
        last--;
    return last;
}

/// Set the control points over the knots `to` of a direction.
static void convert(const tensor_surface *surface, int direction, const bat_knot_vector *to, double *control)
{
    const bat_knot_vector *old = &surface->knots[direction];
    size_t p = (size_t)old->degree, dimension = surface->dimension, rows = knot_vector_functions(to);
    size_t others = knot_vector_functions(&surface->knots[1 - direction]);
    // Control point i of the direction and k of the other one has the index i step + k across.
    size_t step = direction == 0 ? 1 : others, across = direction == 0 ? rows : 1;
    size_t old_across = direction == 0 ? knot_vector_functions(old) : 1;
    for (size_t i = 0; i < rows; i++)
    {
        double weights[BAT_SPLINE_MAX_DEGREE + 1];
        const double *support = to->knots + i;
        size_t span = knot_vector_span(old, support[0] + (support[p + 1] - support[0]) / 2);
        blossom_weights(old, span, support + 1, weights);
        for (size_t k = 0; k < others; k++)
        {
            double *point = control + (i * step + k * across) * dimension;
            for (size_t w = 0; w <= p; w++)
            {
                const double *from = surface->control + ((span - p + w) * step + k * old_across) * dimension;
                for (size_t d = 0; d < dimension && weights[w] != 0; d++)
                    point[d] += weights[w] * from[d];
            }
        }
    }
}

bat_status tensor_surface_restrict(tensor_surface *surface, int direction, double low, double high, bat_error *error)
{
    bat_knot_vector *old = &surface->knots[direction];
    size_t p = (size_t)old->degree, begin = last_not_above(old, low) + 1, end = begin;
    while (old->knots[end] < high)
        end++;
    size_t count = end - begin + 2 * (p + 1);
    size_t size = (count - p - 1) * knot_vector_functions(&surface->knots[1 - direction]) * surface->dimension;
    bat_knot_vector to = {memory_array(count, sizeof *to.knots), count, old->degree};
    double *control = calloc(size, sizeof *control);
    if (to.knots == NULL || control == NULL)
    {
        free(to.knots);
        free(control);
        return error_memory(error, size * sizeof *control);
    }
    for (size_t i = 0; i < count; i++)
        to.knots[i] = i <= p ? low : i - p - 1 < end - begin ? old->knots[begin + (i - p - 1)] : high;
    convert(surface, direction, &to, control);
    free(surface->control);
    surface->control = control;
    knot_vector_free(old);
    *old = to;
    return BAT_OK;
}
