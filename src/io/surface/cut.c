#include "io/surface/cut.h"
#include "surface/spline/knot_vector.h"
#include "surface/spline/tensor_surface.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/// @file
/// Knot insertion by blossoms: the control points over new knots are values of the blossom at consecutive knots (Goldman,
/// "Blossoming and knot insertion algorithms for B-spline curves", 1990).

bat_status cut_knots(const bat_knot_vector *knots, double from, double to, bat_knot_vector *cut, bat_error *error)
{
    size_t degree = (size_t)knots->degree, count = 0;
    double *made = memory_array(knots->count + 2 * degree + 2, sizeof *made);
    if (made == NULL)
        return error_memory(error, (knots->count + 2 * degree + 2) * sizeof *made);
    while (count <= degree)
        made[count++] = from;
    for (size_t i = 0; i < knots->count; i++)
        if (knots->knots[i] > from && knots->knots[i] < to)
            made[count++] = knots->knots[i];
    for (size_t i = 0; i <= degree; i++)
        made[count++] = to;
    *cut = (bat_knot_vector){.knots = made, .count = count, .degree = knots->degree};
    return BAT_OK;
}

/// Evaluate the blossom of the polynomial on a span at `degree` arguments, by de Boor's algorithm, into the last point.
/// Arguments are taken in decreasing order; arguments that are knots of the span then copy points.
static void blossom(const bat_knot_vector *knots, size_t span, const double *arguments, size_t dimension, double *points)
{
    size_t degree = (size_t)knots->degree;
    for (size_t k = 1; k <= degree; k++)
        for (size_t j = degree; j >= k; j--)
        {
            double low = knots->knots[span - degree + j], high = knots->knots[span + j + 1 - k];
            double share = (arguments[degree - k] - low) / (high - low);
            double *point = points + j * dimension;
            const double *before = point - dimension;
            for (size_t c = 0; c < dimension; c++)
                point[c] = (1 - share) * before[c] + share * point[c];
        }
}

bat_status cut_control(const bat_knot_vector *knots, const bat_knot_vector *cut, const double *control, size_t dimension,
                       double *result, bat_error *error)
{
    size_t degree = (size_t)knots->degree, count = knot_vector_functions(cut), size;
    double *points = size_multiply_overflows(degree + 1, dimension, &size) ? NULL : memory_array(size, sizeof *points);
    if (points == NULL)
        return error_memory(error, (degree + 1) * dimension * sizeof *points);
    for (size_t i = 0; i < count; i++)
    {
        size_t span = knot_vector_span(knots, cut->knots[i]);
        memcpy(points, control + (span - degree) * dimension, size * sizeof *points);
        blossom(knots, span, cut->knots + i + 1, dimension, points);
        memcpy(result + i * dimension, points + degree * dimension, dimension * sizeof *result);
    }
    free(points);
    return BAT_OK;
}

static bool is_clamped(const bat_knot_vector *knots)
{
    size_t degree = (size_t)knots->degree, last = knots->count - 1;
    return knots->knots[0] == knots->knots[degree] && knots->knots[last - degree] == knots->knots[last];
}

/// Clamp one direction. For v, rows of control points are the points of one curve; for u, each row is a curve.
static bat_status clamp_direction(tensor_surface *surface, int direction, bat_error *error)
{
    bat_knot_vector *knots = &surface->knots[direction], cut = {0};
    if (is_clamped(knots))
        return BAT_OK;
    size_t degree = (size_t)knots->degree, before = knot_vector_functions(knots);
    size_t curves = direction == 0 ? knot_vector_functions(&surface->knots[1]) : 1;
    size_t dimension = direction == 0 ? surface->dimension : knot_vector_functions(&surface->knots[0]) * surface->dimension;
    bat_status status = cut_knots(knots, knots->knots[degree], knots->knots[before], &cut, error);
    if (status != BAT_OK)
        return status;
    size_t after = knot_vector_functions(&cut);
    double *control = memory_array(curves * after, dimension * sizeof *control);
    if (control == NULL)
        status = error_memory(error, curves * after * dimension * sizeof *control);
    for (size_t i = 0; i < curves && status == BAT_OK; i++)
        status = cut_control(knots, &cut, surface->control + i * before * dimension, dimension,
                             control + i * after * dimension, error);
    if (status != BAT_OK)
    {
        free(control);
        knot_vector_free(&cut);
        return status;
    }
    free(surface->control);
    knot_vector_free(knots);
    surface->control = control;
    *knots = cut;
    return BAT_OK;
}

bat_status cut_clamp(tensor_surface *surface, bat_error *error)
{
    bat_status status = clamp_direction(surface, 0, error);
    return status == BAT_OK ? clamp_direction(surface, 1, error) : status;
}
