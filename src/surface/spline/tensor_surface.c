#include "batten/spline.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The numbers of a surface's control points.
static size_t control_size(const bat_tensor_surface *surface)
{
    return bat_knot_vector_functions(&surface->knots[0]) * bat_knot_vector_functions(&surface->knots[1]) *
           surface->dimension;
}

bat_status bat_tensor_surface_check(const bat_tensor_surface *surface, bat_error *error)
{
    for (int d = 0; d < 2; d++)
    {
        bat_status status = bat_knot_vector_check(&surface->knots[d], error);
        if (status != BAT_OK)
            return status;
    }
    if (surface->dimension == 0 || surface->control == NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "a surface needs control points of dimension 1 or more");
    for (size_t i = 0; i < control_size(surface); i++)
        if (!isfinite(surface->control[i]))
            return error_set(error, BAT_INVALID_POINT, i / surface->dimension, 0, "control point %zu is not finite",
                             i / surface->dimension);
    return BAT_OK;
}

bat_status bat_tensor_surface_copy(const bat_tensor_surface *surface, bat_tensor_surface *copy, bat_error *error)
{
    bat_tensor_surface made = {.dimension = surface->dimension};
    bat_status status = bat_knot_vector_copy(&surface->knots[0], &made.knots[0], error);
    if (status == BAT_OK)
        status = bat_knot_vector_copy(&surface->knots[1], &made.knots[1], error);
    size_t size = control_size(surface);
    if (status == BAT_OK && (made.control = memory_array(size, sizeof *made.control)) == NULL)
        status = error_memory(error, size * sizeof *made.control);
    if (status != BAT_OK)
    {
        bat_tensor_surface_free(&made);
        return status;
    }
    memcpy(made.control, surface->control, size * sizeof *made.control);
    *copy = made;
    return BAT_OK;
}

void bat_tensor_surface_free(bat_tensor_surface *surface)
{
    for (int d = 0; d < 2; d++)
        bat_knot_vector_free(&surface->knots[d]);
    free(surface->control);
    *surface = (bat_tensor_surface){0};
}

static bool in_domain(const bat_knot_vector *knots, double t)
{
    return t >= knots->knots[knots->degree] && t <= knots->knots[bat_knot_vector_functions(knots)];
}

/// Add what the functions of one parameter make of the control points, for derivative `u` by the first and `v` by the
/// second.
static void add_products(const bat_tensor_surface *surface, const size_t span[2], const double *across, const double *along,
                         double *value)
{
    size_t p = (size_t)surface->knots[0].degree, q = (size_t)surface->knots[1].degree, dimension = surface->dimension;
    size_t row = bat_knot_vector_functions(&surface->knots[0]);
    for (size_t b = 0; b <= q; b++)
    {
        const double *control = surface->control + ((span[1] - q + b) * row + span[0] - p) * dimension;
        for (size_t a = 0; a <= p; a++)
            for (size_t d = 0; d < dimension; d++)
                value[d] += along[b] * across[a] * control[a * dimension + d];
    }
}

static void evaluate_point(const bat_tensor_surface *surface, const double *parameter, int derivatives, double *values)
{
    double basis[2][3 * (BAT_SPLINE_MAX_DEGREE + 1)];
    size_t span[2], count[2];
    for (int d = 0; d < 2; d++)
    {
        span[d] = bat_knot_vector_span(&surface->knots[d], parameter[d]);
        count[d] = (size_t)surface->knots[d].degree + 1;
        bat_knot_vector_basis(&surface->knots[d], span[d], parameter[d], derivatives, basis[d]);
    }
    for (size_t order = 0; order <= (size_t)derivatives; order++)
        for (size_t v = 0; v <= order; v++, values += surface->dimension)
        {
            memset(values, 0, surface->dimension * sizeof *values);
            add_products(surface, span, basis[0] + (order - v) * count[0], basis[1] + v * count[1], values);
        }
}

bat_status bat_tensor_surface_evaluate(const bat_tensor_surface *surface, const double *parameters, size_t count,
                                       int derivatives, double *values, bat_error *error)
{
    if (derivatives < 0 || derivatives > 2)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "derivatives of order %d are not among 0 to 2",
                         derivatives);
    size_t size = (derivatives == 0 ? 1 : derivatives == 1 ? 3 : 6) * surface->dimension;
    for (size_t i = 0; i < count; i++)
    {
        const double *parameter = parameters + 2 * i;
        if (!in_domain(&surface->knots[0], parameter[0]) || !in_domain(&surface->knots[1], parameter[1]))
            return error_set(error, BAT_INVALID_POINT, i, 0, "parameter %zu, (%g, %g), is not in the domain", i,
                             parameter[0], parameter[1]);
        evaluate_point(surface, parameter, derivatives, values + i * size);
    }
    return BAT_OK;
}
