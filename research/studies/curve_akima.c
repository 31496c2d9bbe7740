#include "curve_akima.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/polygon.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    /// Slopes on either side of a curve that its end points' derivatives depend on.
    BEYOND = 2
};

/// Below this share of the largest change of slopes a derivative is the mean of its neighbours'.
static const double FLAT = 1e-9;

typedef struct akima
{
    const bat_curve *coarse;
    size_t dim, edges;
    double *lengths;     ///< of the edges
    double *slopes;      ///< rows -BEYOND … edges + BEYOND - 1, row 0 here
    double *derivatives; ///< at the points
} akima;

static const double *slope(const akima *a, ptrdiff_t edge)
{
    return a->slopes + edge * (ptrdiff_t)a->dim;
}

static void measure(const akima *a)
{
    const bat_curve *coarse = a->coarse;
    for (size_t i = 0; i < a->edges; i++)
    {
        const double *p = coarse->points + i * a->dim, *q = coarse->points + (i + 1) % coarse->count * a->dim;
        a->lengths[i] = coarse->space->distance(coarse->space, p, q);
        for (size_t c = 0; c < a->dim; c++)
            a->slopes[i * a->dim + c] = (q[c] - p[c]) / a->lengths[i];
    }
}

/// The slopes beyond the ends: those of the other end, or linear continuation.
static void extend(const akima *a)
{
    ptrdiff_t edges = (ptrdiff_t)a->edges, dim = (ptrdiff_t)a->dim;
    for (ptrdiff_t k = 1; k <= BEYOND; k++)
        for (ptrdiff_t c = 0; c < dim; c++)
        {
            double *before = a->slopes - k * dim + c, *after = a->slopes + (edges - 1 + k) * dim + c;
            if (a->coarse->closed)
            {
                *before = a->slopes[(edges - k) * dim + c];
                *after = a->slopes[(k - 1) * dim + c];
            }
            else if (edges == 1)
                *before = *after = a->slopes[c];
            else
            {
                *before = 2 * before[dim] - before[2 * dim];
                *after = 2 * after[-dim] - after[-2 * dim];
            }
        }
}

/// The changes of slopes beside point i: after it and before it.
static void weights(const akima *a, size_t i, size_t c, double *after, double *before)
{
    ptrdiff_t at = (ptrdiff_t)i;
    *after = fabs(slope(a, at + 1)[c] - slope(a, at)[c]);
    *before = fabs(slope(a, at - 1)[c] - slope(a, at - 2)[c]);
}

static void differentiate(const akima *a)
{
    double largest = 0, after, before;
    for (size_t i = 0; i < a->coarse->count; i++)
        for (size_t c = 0; c < a->dim; c++)
        {
            weights(a, i, c, &after, &before);
            largest = fmax(largest, after + before);
        }
    for (size_t i = 0; i < a->coarse->count; i++)
        for (size_t c = 0; c < a->dim; c++)
        {
            ptrdiff_t at = (ptrdiff_t)i;
            weights(a, i, c, &after, &before);
            a->derivatives[i * a->dim + c] =
                after + before > FLAT * largest ? (after * slope(a, at - 1)[c] + before * slope(a, at)[c]) / (after + before)
                                                : 0.5 * (slope(a, at + 1)[c] + slope(a, at - 2)[c]);
        }
}

static void evaluate(const akima *a, size_t levels, double *fine)
{
    const bat_curve *coarse = a->coarse;
    size_t parts = (size_t)1 << levels;
    for (size_t i = 0; i < a->edges; i++)
    {
        size_t next = (i + 1) % coarse->count;
        for (size_t k = 0; k < parts; k++)
            for (size_t c = 0; c < a->dim; c++)
            {
                double t = (double)k / (double)parts, r = 1 - t, third = a->lengths[i] / 3;
                double p = coarse->points[i * a->dim + c], q = coarse->points[next * a->dim + c];
                double u = p + third * a->derivatives[i * a->dim + c], v = q - third * a->derivatives[next * a->dim + c];
                fine[(i * parts + k) * a->dim + c] = (r * r * r * p + t * t * t * q) + 3 * r * t * (r * u + t * v);
            }
    }
    if (!coarse->closed)
        memcpy(fine + a->edges * parts * a->dim, coarse->points + (coarse->count - 1) * a->dim, a->dim * sizeof *fine);
}

bat_status curve_akima(const bat_curve *coarse, size_t levels, bat_curve *fine, bat_error *error)
{
    akima a = {.coarse = coarse, .dim = coarse->space->point_dim};
    a.edges = polygon_edges(coarse->count, coarse->closed);
    bat_curve result = {.space = coarse->space, .closed = coarse->closed};
    result.count = (a.edges << levels) + (coarse->closed ? 0 : 1);
    a.lengths = memory_array(a.edges, sizeof *a.lengths);
    a.derivatives = memory_array(coarse->count * a.dim, sizeof *a.derivatives);
    double *slopes = memory_array((a.edges + 2 * (size_t)BEYOND) * a.dim, sizeof *slopes);
    result.points = memory_array(result.count * a.dim, sizeof *result.points);
    bat_status status = BAT_OK;
    if (a.lengths == NULL || a.derivatives == NULL || slopes == NULL || result.points == NULL)
        status = error_memory(error, (result.count + 2 * coarse->count) * a.dim * sizeof *slopes);
    else
    {
        a.slopes = slopes + BEYOND * a.dim;
        measure(&a);
        extend(&a);
        differentiate(&a);
        evaluate(&a, levels, result.points);
    }
    free(a.lengths);
    free(a.derivatives);
    free(slopes);
    if (status == BAT_OK)
        *fine = result;
    else
        bat_curve_free(&result);
    return status;
}
