#include "curve/spline.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/parametric.h"
#include "curve/polygon.h"
#include "space/builtin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// New points computed at a time.
static const size_t PIECE = 1024;

/// Lengths are divided by a power of two near the longest, which changes no digit of the curve.
static bat_status measure_increments(const spline *s, bat_error *error)
{
    const bat_space *points = s->coarse->space;
    double longest = 0;
    for (size_t i = 0; i < s->edges; i++)
    {
        s->increments[i] = points->distance(points, spline_row_at(s, (ptrdiff_t)i), spline_row_at(s, (ptrdiff_t)i + 1));
        longest = fmax(longest, s->increments[i]);
    }
    int exponent = longest > 0 && isfinite(longest) ? ilogb(longest) : 0;
    for (size_t i = 0; i < s->edges; i++)
    {
        s->increments[i] = parametric_increment(s->scheme->parameters, ldexp(s->increments[i], -exponent));
        if (!(s->increments[i] > 0 && isfinite(s->increments[i])))
            return error_point(error, BAT_INVALID_POINT, i, "the edge after point", " is too %s beside the others",
                               s->increments[i] > 0 ? "long" : "short");
    }
    return BAT_OK;
}

static bat_status find_derivatives(const spline *s, const bat_curve_refine_options *options, bat_error *error)
{
    size_t fault = 0;
    bat_status status = s->form->find(s, options, &fault);
    if (status == BAT_NO_MEMORY)
        return error_memory(error, s->count * (s->tangent_dim + 1) * sizeof(double));
    if (status != BAT_OK)
        return error_point(error, status, fault, "the spline has no velocity at point", " (%s)", bat_status_name(status));
    return BAT_OK;
}

/// The control points of an edge.
typedef struct bezier
{
    double points[SPLINE_MAX_DEGREE + 1][BAT_SPACE_MAX_DIM];
} bezier;

/// Inner control point k, from 1 on, counted from point i. `increment` is that of the edge, negative for one that ends at i:
/// with h for it, k h / d times the velocity, and for the second one h^2 / (d (d - 1)) times the acceleration.
static bat_status control_point(const spline *s, size_t i, size_t k, double increment, double *control)
{
    double tangent[BAT_SPACE_MAX_DIM], part = increment / (double)s->form->degree;
    double square = increment * part / (double)(s->form->degree - 1);
    for (size_t c = 0; c < s->tangent_dim; c++)
    {
        tangent[c] = (double)k * part * spline_derivative(s, i, 1)[c];
        if (k == 2)
            tangent[c] += square * spline_derivative(s, i, 2)[c];
    }
    return s->space->exp(s->space, s->rows + i * s->dim, tangent, control);
}

static bat_status bezier_make(const spline *s, size_t i, bezier *edge)
{
    size_t next = i + 1 == s->count ? 0 : i + 1, degree = s->form->degree;
    memcpy(edge->points[0], s->rows + i * s->dim, s->dim * sizeof *s->rows);
    memcpy(edge->points[degree], s->rows + next * s->dim, s->dim * sizeof *s->rows);
    bat_status status = BAT_OK;
    for (size_t k = 1; k <= degree / 2 && status == BAT_OK; k++)
    {
        status = control_point(s, i, k, s->increments[i], edge->points[k]);
        if (status == BAT_OK)
            status = control_point(s, next, k, -s->increments[i], edge->points[degree - k]);
    }
    return status;
}

/// Bernstein's form. The sums are symmetric, so that reversal changes no bit.
static bat_status euclidean_value(const spline *s, const bezier *edge, double t, double *row)
{
    size_t degree = s->form->degree;
    double weights[SPLINE_MAX_DEGREE + 1];
    bool finite = true;
    s->form->weights(t, weights);
    for (size_t c = 0; c < s->dim; c++)
    {
        row[c] = weights[0] * edge->points[0][c] + weights[degree] * edge->points[degree][c];
        for (size_t k = 1; k <= degree / 2; k++)
            row[c] += weights[k] * edge->points[k][c] + weights[degree - k] * edge->points[degree - k][c];
        finite = finite && isfinite(row[c]);
    }
    return finite ? BAT_OK : BAT_INVALID_POINT;
}

/// De Casteljau's algorithm with geodesics.
static bat_status geodesic_value(const spline *s, const bezier *edge, double t, double *row)
{
    bezier now = *edge;
    bat_status status = BAT_OK;
    for (size_t left = s->form->degree; left > 0; left--)
        for (size_t k = 0; k < left && status == BAT_OK; k++)
        {
            double point[BAT_SPACE_MAX_DIM];
            status = bat_space_geodesic(s->space, now.points[k], now.points[k + 1], t, point);
            memcpy(now.points[k], point, s->dim * sizeof *point);
        }
    memcpy(row, now.points[0], s->dim * sizeof *row);
    return status;
}

static void store(const spline *s, const double *row, size_t at, double *points, double *channels)
{
    size_t point_dim = s->dim - s->channel_count;
    memcpy(points + at * point_dim, row, point_dim * sizeof *row);
    if (s->channel_count > 0)
        memcpy(channels + at * s->channel_count, row + point_dim, s->channel_count * sizeof *row);
}

/// New points begin … end - 1. On failure *fault is the edge.
static bat_status run_piece(const spline *s, size_t levels, size_t begin, size_t end, double *points, double *channels,
                            size_t *fault)
{
    bezier edge;
    size_t mask = ((size_t)1 << levels) - 1;
    bool made = false;
    for (size_t at = begin; at < end; at++)
    {
        size_t i = at >> levels, k = at & mask;
        *fault = i;
        if (k == 0)
            store(s, s->rows + i * s->dim, at, points, channels);
        made = made && k != 0;
        if (k == 0)
            continue;
        double row[BAT_SPACE_MAX_DIM], t = ldexp((double)k, -(int)levels);
        bat_status status = made ? BAT_OK : bezier_make(s, i, &edge);
        made = true;
        if (status == BAT_OK)
            status = s->euclidean ? euclidean_value(s, &edge, t, row) : geodesic_value(s, &edge, t, row);
        if (status != BAT_OK)
            return status;
        store(s, row, at, points, channels);
    }
    return BAT_OK;
}

static bat_status evaluate(const spline *s, const refine_plan *plan, double *points, double *channels, bat_error *error)
{
    const bat_curve_refine_options *options = &plan->options;
    shared_work work = shared_work_make((plan->count + PIECE - 1) / PIECE, options->progress);
    int threads = threads_for(options->threads, work.total);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < work.total; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error own;
        size_t end = (i + 1) * PIECE < plan->count ? (i + 1) * PIECE : plan->count, fault = 0;
        bat_status status = run_piece(s, options->levels, i * PIECE, end, points, channels, &fault);
        if (status != BAT_OK)
            (void)error_point(&own, status, fault, "there is no new point after point", " (%s)", bat_status_name(status));
        shared_work_finish(&work, i, status, &own);
    }
    return shared_work_end(&work, error);
}

bat_status spline_make(const spline_form *form, const bat_curve *coarse, const refine_plan *plan, double *points,
                       double *channels, bat_error *error)
{
    spline s = {.coarse = coarse, .scheme = &plan->options.scheme, .count = coarse->count, .form = form};
    s.channel_count = channels != NULL ? coarse->channel_count : 0;
    row_space rows;
    bat_status status = row_space_make(coarse->space, s.channel_count, &rows, error);
    if (status != BAT_OK)
        return status;
    s.space = &rows.space;
    s.euclidean = space_is_euclidean(coarse->space);
    s.dim = rows.space.point_dim;
    s.tangent_dim = rows.space.tangent_dim;
    s.edges = polygon_edges(s.count, coarse->closed);
    s.rows = memory_array(s.count * s.dim, sizeof *s.rows);
    s.derivatives = memory_array(s.count * (form->degree / 2) * s.tangent_dim, sizeof *s.derivatives);
    s.increments = memory_array(s.count, sizeof *s.increments);
    if (s.rows == NULL || s.derivatives == NULL || s.increments == NULL)
        status = error_memory(error, s.count * (s.dim + s.tangent_dim + 1) * sizeof(double));
    if (status == BAT_OK)
    {
        rows_join(coarse, s.channel_count, s.rows);
        status = measure_increments(&s, error);
    }
    if (status == BAT_OK)
        status = find_derivatives(&s, &plan->options, error);
    if (status == BAT_OK)
        status = evaluate(&s, plan, points, channels, error);
    free(s.rows);
    free(s.derivatives);
    free(s.increments);
    return status;
}
