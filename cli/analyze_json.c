#include "analyze.h"

#include "report.h"

#include <math.h>

// jansson's json_array_append_new() and json_object_set_new() take over their value and fail on a null one, so a failed
// allocation anywhere shows in the last check: `failed`.

/// An object under construction. Infinite bounds, which stand for none, become null.
typedef struct builder
{
    json_t *object;
    bool failed;
} builder;

static void put(builder *b, const char *key, json_t *value)
{
    b->failed = json_object_set_new(b->object, key, value) != 0 || b->failed;
}

static json_t *numbers(builder *b, const double *values, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        b->failed = json_array_append_new(array, report_number(values[i])) != 0 || b->failed;
    return array;
}

static json_t *indexed(builder *b, const char *key, const double *values, size_t count, int first)
{
    builder inner = {.object = json_object()};
    put(&inner, "first", json_integer(first));
    put(&inner, key, numbers(&inner, values, count));
    b->failed = b->failed || inner.failed;
    return inner.object;
}

static json_t *stencil(builder *b, const bat_mask_stencil *s)
{
    return s->count > 0 ? indexed(b, "weights", s->weights, s->count, s->first) : json_null();
}

static json_t *smoothness(int order)
{
    return order >= 0 ? json_integer(order) : json_null();
}

static json_t *matrix(builder *b, const bat_analysis *analysis)
{
    json_t *rows = json_array();
    for (size_t row = 0; row < analysis->matrix_size; row++)
    {
        const double *values = analysis->matrix + row * analysis->matrix_size;
        b->failed = json_array_append_new(rows, numbers(b, values, analysis->matrix_size)) != 0 || b->failed;
    }
    return rows;
}

static json_t *eigenvector(builder *b, const double *vector, size_t size)
{
    json_t *entries = json_array();
    for (size_t i = 0; i < size; i++)
        b->failed = json_array_append_new(entries, numbers(b, vector + 2 * i, 2)) != 0 || b->failed;
    return entries;
}

static json_t *eigenvalues(builder *b, const bat_analysis *analysis)
{
    json_t *array = json_array();
    for (size_t e = 0; e < analysis->eigenvalue_count; e++)
    {
        const bat_analysis_eigenvalue *value = &analysis->eigenvalues[e];
        builder inner = {.object = json_object()};
        put(&inner, "real", report_number(value->real));
        put(&inner, "imaginary", report_number(value->imaginary));
        put(&inner, "multiplicity", json_integer((json_int_t)value->multiplicity));
        json_t *vectors = json_array();
        for (size_t v = 0; v < value->vector_count; v++)
        {
            const double *row = analysis->eigenvectors + 2 * analysis->matrix_size * (value->vector + v);
            inner.failed =
                json_array_append_new(vectors, eigenvector(&inner, row, analysis->matrix_size)) != 0 || inner.failed;
        }
        put(&inner, "eigenvectors", vectors);
        b->failed = json_array_append_new(array, inner.object) != 0 || inner.failed || b->failed;
    }
    return array;
}

static json_t *derivatives(builder *b, const bat_analysis *analysis)
{
    json_t *array = json_array();
    double lower, upper;
    for (size_t order = 0; bat_analysis_derivative_exponent(analysis, order, &lower, &upper); order++)
    {
        builder inner = {.object = json_object()};
        put(&inner, "order", json_integer((json_int_t)order));
        put(&inner, "exponent_lower", report_number(lower));
        put(&inner, "exponent_upper", isfinite(analysis->exponent_upper) ? report_number(upper) : json_null());
        b->failed = json_array_append_new(array, inner.object) != 0 || inner.failed || b->failed;
    }
    return array;
}

/// The object, or null after releasing it when something failed.
static json_t *finish(builder *b)
{
    if (!b->failed)
        return b->object;
    json_decref(b->object);
    return NULL;
}

json_t *analyze_json(const char *scheme, const bat_analysis *analysis)
{
    builder b = {.object = json_object()};
    put(&b, "scheme", json_string(scheme));
    put(&b, "mask", indexed(&b, "coefficients", analysis->mask.coefficients, analysis->mask.count, analysis->mask.first));
    put(&b, "multiplicity", json_integer((json_int_t)analysis->multiplicity));
    put(&b, "quotient",
        indexed(&b, "coefficients", analysis->quotient.coefficients, analysis->quotient.count, analysis->quotient.first));
    put(&b, "remainder", report_number(analysis->remainder));
    put(&b, "interpolatory", json_boolean(analysis->is_interpolatory));
    put(&b, "symmetric", json_boolean(analysis->is_symmetric));
    put(&b, "shift", report_number(analysis->shift));
    put(&b, "generation_degree", json_integer((json_int_t)analysis->generation_degree));
    put(&b, "reproduction_degree", json_integer((json_int_t)analysis->reproduction_degree));
    put(&b, "matrix_first", json_integer(analysis->matrix_first));
    put(&b, "matrix", matrix(&b, analysis));
    put(&b, "eigenvalues", eigenvalues(&b, analysis));
    put(&b, "converges", json_string(bat_analysis_verdict_name(analysis->converges)));
    put(&b, "limit_stencil", stencil(&b, &analysis->limit));
    put(&b, "tangent_stencil", stencil(&b, &analysis->tangent));
    put(&b, "vertex_stencil", stencil(&b, &analysis->vertex));
    put(&b, "radius_lower", report_number(analysis->radius_lower));
    put(&b, "radius_upper", report_number(analysis->radius_upper));
    put(&b, "product", json_string(analysis->product));
    put(&b, "depth", json_integer((json_int_t)analysis->depth));
    put(&b, "stable", json_boolean(analysis->is_stable));
    put(&b, "exponent_lower", report_number(analysis->exponent_lower));
    put(&b, "exponent_upper", report_number(analysis->exponent_upper));
    put(&b, "derivatives", derivatives(&b, analysis));
    put(&b, "smooth_proven", smoothness(analysis->smooth_proven));
    put(&b, "smooth_disproven", smoothness(analysis->smooth_disproven));
    put(&b, "lipschitz", json_string(bat_analysis_verdict_name(analysis->lipschitz)));
    return finish(&b);
}

json_t *analyze_sweep_json(const char *scheme, const analyze_sweep *sweep)
{
    builder b = {.object = json_object()};
    put(&b, "scheme", json_string(scheme));
    put(&b, "parameter", json_string(sweep->parameter));
    put(&b, "smoothness", json_integer((json_int_t)sweep->smoothness));
    json_t *array = json_array();
    for (size_t i = 0; i < sweep->count; i++)
    {
        builder inner = {.object = json_object()};
        put(&inner, "begin", report_number(sweep->intervals[i].begin));
        put(&inner, "end", report_number(sweep->intervals[i].end));
        put(&inner, "verdict", json_string(bat_analysis_verdict_name(sweep->intervals[i].verdict)));
        b.failed = json_array_append_new(array, inner.object) != 0 || inner.failed || b.failed;
    }
    put(&b, "intervals", array);
    return finish(&b);
}
