/// @file
/// Tensor-product B-spline surfaces: evaluation, knot insertion, degree elevation, restriction.
///     S(u, v) = sum_ij c_ij B_i(u) B_j(v)
/// Every change of the knot vector of a direction is a linear map of the control points. Row i of the map has degree + 1
/// weights: the blossom at the knots of the new function i.

#include "surface/spline/tensor_surface.h"
#include "surface/spline/knot_vector.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/spline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The size of the array of control points, in numbers.
static size_t control_size(const tensor_surface *surface)
{
    return knot_vector_functions(&surface->knots[0]) * knot_vector_functions(&surface->knots[1]) * surface->dimension;
}

bat_status tensor_surface_check(const tensor_surface *surface, bat_error *error)
{
    for (int d = 0; d < 2; d++)
    {
        bat_status status = knot_vector_check(&surface->knots[d], error);
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

bat_status tensor_surface_copy(const tensor_surface *surface, tensor_surface *copy, bat_error *error)
{
    tensor_surface made = {.dimension = surface->dimension};
    bat_status status = knot_vector_copy(&surface->knots[0], &made.knots[0], error);
    if (status == BAT_OK)
        status = knot_vector_copy(&surface->knots[1], &made.knots[1], error);
    size_t size = control_size(surface);
    if (status == BAT_OK && (made.control = memory_array(size, sizeof *made.control)) == NULL)
        status = error_memory(error, size * sizeof *made.control);
    if (status != BAT_OK)
    {
        tensor_surface_free(&made);
        return status;
    }
    memcpy(made.control, surface->control, size * sizeof *made.control);
    *copy = made;
    return BAT_OK;
}

void tensor_surface_free(tensor_surface *surface)
{
    for (int d = 0; d < 2; d++)
        knot_vector_free(&surface->knots[d]);
    free(surface->control);
    *surface = (tensor_surface){0};
}

static bool in_domain(const bat_knot_vector *knots, double t)
{
    return t >= knots->knots[knots->degree] && t <= knots->knots[knot_vector_functions(knots)];
}

/// Add sum_ab along[b] across[a] c_ab to a value.
static void add_products(const tensor_surface *surface, const size_t span[2], const double *across, const double *along,
                         double *value)
{
    size_t p = (size_t)surface->knots[0].degree, q = (size_t)surface->knots[1].degree, dimension = surface->dimension;
    size_t row = knot_vector_functions(&surface->knots[0]);
    for (size_t b = 0; b <= q; b++)
    {
        const double *control = surface->control + ((span[1] - q + b) * row + span[0] - p) * dimension;
        for (size_t a = 0; a <= p; a++)
            for (size_t d = 0; d < dimension; d++)
                value[d] += along[b] * across[a] * control[a * dimension + d];
    }
}

static void evaluate_point(const tensor_surface *surface, const double *parameter, int derivatives, double *values)
{
    double basis[2][3 * (BAT_SPLINE_MAX_DEGREE + 1)];
    size_t span[2], count[2];
    for (int d = 0; d < 2; d++)
    {
        span[d] = knot_vector_span(&surface->knots[d], parameter[d]);
        count[d] = (size_t)surface->knots[d].degree + 1;
        knot_vector_basis(&surface->knots[d], span[d], parameter[d], derivatives, basis[d]);
    }
    for (size_t order = 0; order <= (size_t)derivatives; order++)
        for (size_t v = 0; v <= order; v++, values += surface->dimension)
        {
            memset(values, 0, surface->dimension * sizeof *values);
            add_products(surface, span, basis[0] + (order - v) * count[0], basis[1] + v * count[1], values);
        }
}

bat_status tensor_surface_evaluate(const tensor_surface *surface, const double *parameters, size_t count, int derivatives,
                                   double *values, bat_error *error)
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

/// The new control points of a direction from the old ones: point i is the sum of degree + 1 weights times points first[i],
/// first[i] + 1, …
typedef struct conversion
{
    bat_knot_vector knots; ///< new knot vector
    size_t *first;
    double *weights;
} conversion;

static void conversion_free(conversion *made)
{
    knot_vector_free(&made->knots);
    free(made->first);
    free(made->weights);
}

/// Allocate a conversion to `count` knots of a degree.
static bat_status conversion_make(const bat_knot_vector *old, size_t count, int degree, conversion *made, bat_error *error)
{
    size_t functions = count - (size_t)degree - 1, width = (size_t)old->degree + 1;
    *made = (conversion){.knots = {memory_array(count, sizeof *made->knots.knots), count, degree},
                         .first = memory_array(functions, sizeof *made->first),
                         .weights = memory_array(functions * width, sizeof *made->weights)};
    if (made->knots.knots != NULL && made->first != NULL && made->weights != NULL)
        return BAT_OK;
    conversion_free(made);
    return error_memory(error, functions * width * sizeof *made->weights);
}

/// Apply a conversion to a surface. Takes the knots of the conversion on success.
static bat_status convert(tensor_surface *surface, int direction, conversion *to, bat_error *error)
{
    bat_knot_vector *old = &surface->knots[direction];
    size_t width = (size_t)old->degree + 1, dimension = surface->dimension, old_rows = knot_vector_functions(old);
    size_t rows = knot_vector_functions(&to->knots), others = knot_vector_functions(&surface->knots[1 - direction]);
    double *control = calloc(rows * others * dimension, sizeof *control);
    if (control == NULL)
        return error_memory(error, rows * others * dimension * sizeof *control);
    // Control point i of the direction and k of the other one has the index i step + k across.
    size_t step = direction == 0 ? 1 : others, across = direction == 0 ? rows : 1,
           old_across = direction == 0 ? old_rows : 1;
    for (size_t i = 0; i < rows; i++)
        for (size_t k = 0; k < others; k++)
        {
            double *point = control + (i * step + k * across) * dimension;
            for (size_t w = 0; w < width; w++)
            {
                double weight = to->weights[i * width + w];
                const double *from = surface->control + ((to->first[i] + w) * step + k * old_across) * dimension;
                for (size_t d = 0; d < dimension && weight != 0; d++)
                    point[d] += weight * from[d];
            }
        }
    free(surface->control);
    surface->control = control;
    knot_vector_free(old);
    *old = to->knots;
    to->knots = (bat_knot_vector){0};
    return BAT_OK;
}

/// The index of the last knot <= t, which is not the last of all knots.
static size_t last_not_above(const bat_knot_vector *knots, double t)
{
    size_t last = knots->count - 1;
    while (knots->knots[last] > t)
        last--;
    return last;
}

bat_status tensor_surface_restrict(tensor_surface *surface, int direction, double low, double high, bat_error *error)
{
    const bat_knot_vector *old = &surface->knots[direction];
    size_t p = (size_t)old->degree, begin = last_not_above(old, low) + 1, end = begin;
    while (old->knots[end] < high)
        end++;
    conversion to;
    bat_status status = conversion_make(old, end - begin + 2 * (p + 1), old->degree, &to, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < to.knots.count; i++)
        to.knots.knots[i] = i <= p ? low : i - p - 1 < end - begin ? old->knots[begin + (i - p - 1)] : high;
    for (size_t i = 0; i < knot_vector_functions(&to.knots); i++)
    {
        const double *support = to.knots.knots + i;
        size_t span = knot_vector_span(old, support[0] + (support[p + 1] - support[0]) / 2);
        to.first[i] = span - p;
        blossom_weights(old, span, support + 1, to.weights + i * (p + 1));
    }
    status = convert(surface, direction, &to, error);
    conversion_free(&to);
    return status;
}
