/// @file
/// Tensor-product B-spline surfaces: evaluation, knot insertion, degree elevation, restriction.
///     S(u, v) = sum_ij c_ij B_i(u) B_j(v)
/// Every change of the knot vector of a direction is a linear map of the control points. Row i of the map has degree + 1
/// weights: the blossom at the knots of the new function i.

#include "surface/spline/tensor_surface.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/spline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The size of the array of control points, in numbers.
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

/// Add sum_ab along[b] across[a] c_ab to a value.
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
    bat_knot_vector_free(&made->knots);
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
static bat_status convert(bat_tensor_surface *surface, int direction, conversion *to, bat_error *error)
{
    bat_knot_vector *old = &surface->knots[direction];
    size_t width = (size_t)old->degree + 1, dimension = surface->dimension, old_rows = bat_knot_vector_functions(old);
    size_t rows = bat_knot_vector_functions(&to->knots), others = bat_knot_vector_functions(&surface->knots[1 - direction]);
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
    bat_knot_vector_free(old);
    *old = to->knots;
    to->knots = (bat_knot_vector){0};
    return BAT_OK;
}

/// Apply a conversion and free it.
static bat_status convert_and_free(bat_tensor_surface *surface, int direction, conversion *to, bat_error *error)
{
    bat_status status = convert(surface, direction, to, error);
    conversion_free(to);
    return status;
}

static bat_status check_direction(const bat_tensor_surface *surface, int direction, bat_error *error)
{
    if (direction != 0 && direction != 1)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "direction %d is neither 0 nor 1", direction);
    return bat_tensor_surface_check(surface, error);
}

/// The index of the last knot <= t, which is not the last of all knots.
static size_t last_not_above(const bat_knot_vector *knots, double t)
{
    size_t last = knots->count - 1;
    while (knots->knots[last] > t)
        last--;
    return last;
}

/// Boehm's algorithm: c'_i = share_i c_i + (1 - share_i) c_i-1.
static void insert_weights(const bat_knot_vector *old, double knot, size_t span, conversion *to)
{
    size_t p = (size_t)old->degree, functions = bat_knot_vector_functions(old);
    memset(to->weights, 0, (functions + 1) * (p + 1) * sizeof *to->weights);
    for (size_t i = 0; i <= functions; i++)
    {
        double share = i + p <= span ? 1 : 0;
        if (i + p > span && i <= span && i < functions)
            share = (knot - old->knots[i]) / (old->knots[i + p] - old->knots[i]);
        // The weights of a row refer to existing control points only.
        size_t first = i < functions - p ? i : functions - p - 1;
        first -= first == i && i > 0 && share < 1;
        to->first[i] = first;
        if (share > 0)
            to->weights[i * (p + 1) + i - first] = share;
        if (share < 1)
            to->weights[i * (p + 1) + i - 1 - first] = 1 - share;
    }
}

bat_status bat_tensor_surface_insert_knot(bat_tensor_surface *surface, int direction, double knot, bat_error *error)
{
    bat_status status = check_direction(surface, direction, error);
    if (status != BAT_OK)
        return status;
    const bat_knot_vector *old = &surface->knots[direction];
    size_t p = (size_t)old->degree;
    if (!(knot >= old->knots[p] && knot <= old->knots[bat_knot_vector_functions(old)]))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the knot %g is not in the domain, %g to %g", knot,
                         old->knots[p], old->knots[bat_knot_vector_functions(old)]);
    size_t span = last_not_above(old, knot);
    if (span >= p && old->knots[span - p] == knot)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the knot %g already has multiplicity %zu", knot,
                         p + 1);
    conversion to;
    status = conversion_make(old, old->count + 1, old->degree, &to, error);
    if (status != BAT_OK)
        return status;
    memcpy(to.knots.knots, old->knots, (span + 1) * sizeof *old->knots);
    to.knots.knots[span + 1] = knot;
    memcpy(to.knots.knots + span + 2, old->knots + span + 1, (old->count - span - 1) * sizeof *old->knots);
    insert_weights(old, knot, span, &to);
    return convert_and_free(surface, direction, &to, error);
}

/// The knots after degree elevation: those in the domain gain one in multiplicity; those outside do not matter.
static bat_status elevate_knots(const bat_knot_vector *old, conversion *to, bat_error *error)
{
    size_t p = (size_t)old->degree, last = old->count - 1, functions = bat_knot_vector_functions(old);
    const double *knots = old->knots;
    // The last knot at the beginning of the domain and the first at its end.
    size_t begin = last_not_above(old, knots[p]), end = functions, inner = 0;
    while (knots[end - 1] == knots[functions])
        end--;
    for (size_t i = begin + 1; i < end; i++)
        inner += knots[i] != knots[i - 1] ? 2 : 1;
    size_t before = begin + 2, after = last - end + 2;
    bat_status status = conversion_make(old, before + inner + after, old->degree + 1, to, error);
    if (status != BAT_OK)
        return status;
    double *next = to->knots.knots;
    memcpy(next, knots, (begin + 1) * sizeof *next);
    next += begin + 1;
    *next++ = knots[begin];
    for (size_t i = begin + 1; i < end; i++)
    {
        *next++ = knots[i];
        if (i + 1 == end || knots[i + 1] != knots[i])
            *next++ = knots[i];
    }
    *next++ = knots[end];
    memcpy(next, knots + end, (last - end + 1) * sizeof *next);
    return BAT_OK;
}

/// New control point i is the mean of the blossom over the degree + 1 subsets of its inner knots (Prautzsch, 1984).
static void elevate_weights(const bat_knot_vector *old, conversion *to)
{
    size_t p = (size_t)old->degree, functions = bat_knot_vector_functions(&to->knots);
    double begin = old->knots[p], end = old->knots[bat_knot_vector_functions(old)];
    memset(to->weights, 0, functions * (p + 1) * sizeof *to->weights);
    for (size_t i = 0; i < functions; i++)
    {
        // Every segment of the support gives the same value; the middle one is best conditioned.
        const double *support = to->knots.knots + i, *inner = support + 1;
        double low = fmax(fmin(support[0], end), begin), high = fmin(fmax(support[p + 2], begin), end);
        size_t span = bat_knot_vector_span(old, low + (high - low) / 2);
        to->first[i] = span - p;
        for (size_t left_out = 0; left_out <= p; left_out++)
        {
            double arguments[BAT_SPLINE_MAX_DEGREE + 1], weights[BAT_SPLINE_MAX_DEGREE + 1];
            for (size_t k = 0; k < p; k++)
                arguments[k] = inner[k < left_out ? k : k + 1];
            blossom_weights(old, span, arguments, weights);
            for (size_t w = 0; w <= p; w++)
                to->weights[i * (p + 1) + w] += weights[w] / (double)(p + 1);
        }
    }
}

bat_status bat_tensor_surface_elevate(bat_tensor_surface *surface, int direction, bat_error *error)
{
    bat_status status = check_direction(surface, direction, error);
    if (status != BAT_OK)
        return status;
    const bat_knot_vector *old = &surface->knots[direction];
    if (old->degree == BAT_SPLINE_MAX_DEGREE)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the degree is already the maximum, %d",
                         BAT_SPLINE_MAX_DEGREE);
    conversion to;
    status = elevate_knots(old, &to, error);
    if (status != BAT_OK)
        return status;
    elevate_weights(old, &to);
    return convert_and_free(surface, direction, &to, error);
}

bat_status tensor_surface_restrict(bat_tensor_surface *surface, int direction, double low, double high, bat_error *error)
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
    for (size_t i = 0; i < bat_knot_vector_functions(&to.knots); i++)
    {
        const double *support = to.knots.knots + i;
        size_t span = bat_knot_vector_span(old, support[0] + (support[p + 1] - support[0]) / 2);
        to.first[i] = span - p;
        blossom_weights(old, span, support + 1, to.weights + i * (p + 1));
    }
    return convert_and_free(surface, direction, &to, error);
}
