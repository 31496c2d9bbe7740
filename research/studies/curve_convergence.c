#include "batten/research/curve_study.h"

#include "base/error.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/polygon.h"
#include "search/nearest.h"
#include "space/builtin.h"

#include <math.h>

enum
{
    /// Vertices that a thread takes at a time.
    BLOCK = 4096,
    /// Edges looked at to either side of the one at a vertex's place.
    REACH = 2
};

/// One question asked of every vertex in begin … end - 1: how far is it from its goal?
typedef struct question
{
    const bat_curve *curve, *coarse;
    const bat_mask_stencil *stencil;
    double (*distance)(const struct question *asked, size_t vertex);
    size_t begin, end;
} question;

static const double *row(const bat_curve *curve, size_t index)
{
    return curve->points + index * curve->space->point_dim;
}

/// The index moved by an offset around a closed curve.
static size_t around(size_t index, ptrdiff_t offset, size_t count)
{
    ptrdiff_t whole = (ptrdiff_t)count, moved = (ptrdiff_t)index + offset;
    if (moved >= 0 && moved < whole)
        return (size_t)moved;
    moved %= whole;
    return (size_t)(moved < 0 ? moved + whole : moved);
}

/// The squared distance of a point from the edges about the place of the polygon, at a scale.
static double edges_squared(const bat_curve *polygon, size_t place, const double *point, double scale)
{
    double nearest = INFINITY;
    for (ptrdiff_t offset = -REACH; offset <= REACH; offset++)
    {
        ptrdiff_t edge = (ptrdiff_t)place + offset;
        if (!polygon->closed && (edge < 0 || edge >= (ptrdiff_t)polygon->count - 1))
            continue;
        size_t begin = around(place, offset, polygon->count), end = around(begin, 1, polygon->count);
        nearest =
            fmin(nearest, segment_squared(row(polygon, begin), row(polygon, end), point, polygon->space->point_dim, scale));
    }
    return nearest;
}

static double distance_from_edges(const question *asked, size_t vertex)
{
    const bat_curve *coarse = asked->coarse, *fine = asked->curve;
    size_t place = (size_t)((double)vertex / (double)fine->count * (double)coarse->count);
    double squared = edges_squared(coarse, place, row(fine, vertex), 1), scale = segment_scale(squared);
    if (scale != 1)
        squared = edges_squared(coarse, place, row(fine, vertex), scale);
    return sqrt(squared) / scale;
}

static double distance_from_limit(const question *asked, size_t vertex)
{
    static const double ORIGIN[BAT_SPACE_MAX_DIM];
    const bat_curve *curve = asked->curve;
    const bat_mask_stencil *stencil = asked->stencil;
    size_t dim = curve->space->point_dim;
    double step[BAT_SPACE_MAX_DIM];
    for (size_t axis = 0; axis < dim; axis++)
        step[axis] = 0;
    for (size_t k = 0; k < stencil->count; k++)
    {
        const double *from = row(curve, vertex), *to = row(curve, around(vertex, stencil->first + (int)k, curve->count));
        for (size_t axis = 0; axis < dim; axis++)
            step[axis] += stencil->weights[k] * (to[axis] - from[axis]);
    }
    double squared = point_squared(step, ORIGIN, dim, 1), scale = segment_scale(squared);
    if (scale != 1)
        squared = point_squared(step, ORIGIN, dim, scale);
    return sqrt(squared) / scale;
}

static double block_max(const question *asked, size_t begin, bat_error *error)
{
    size_t end = asked->end - begin < BLOCK ? asked->end : begin + BLOCK;
    double greatest = 0;
    for (size_t i = begin; i < end; i++)
    {
        double distance = asked->distance(asked, i);
        if (!isfinite(distance))
        {
            (void)error_set(error, BAT_INVALID_POINT, i, 0, "the distance at point %zu is too large for a double", i);
            return INFINITY;
        }
        greatest = fmax(greatest, distance);
    }
    return greatest;
}

static bat_status max_distance(const question *asked, const bat_curve_measure_options *options, double *distance,
                               bat_error *error)
{
    bat_curve_measure_options how = options != NULL ? *options : bat_curve_measure_defaults();
    size_t count = asked->end > asked->begin ? asked->end - asked->begin : 0, blocks = count / BLOCK + (count % BLOCK > 0);
    shared_work work = shared_work_make(blocks, how.progress);
    int threads = threads_for(how.threads, blocks);
    double greatest = 0;
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads) reduction(max : greatest) if (threads > 1)
    for (size_t block = 0; block < blocks; block++)
    {
        if (!shared_work_wants(&work, block))
            continue;
        bat_error own;
        double here = block_max(asked, asked->begin + block * BLOCK, &own);
        greatest = fmax(greatest, here);
        shared_work_finish(&work, block, isfinite(here) ? BAT_OK : BAT_INVALID_POINT, &own);
    }
    bat_status status = shared_work_end(&work, error);
    if (status == BAT_OK)
        *distance = greatest;
    return status;
}

bat_status bat_curve_chord_distance(const bat_curve *coarse, const bat_curve *fine, const bat_curve_measure_options *options,
                                    double *distance, bat_error *error)
{
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status != BAT_OK)
        return status;
    if (coarse->count < 2 || fine->count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the %s curve has too few points",
                         fine->count == 0 ? "fine" : "coarse");
    if (coarse->space->point_dim != fine->space->point_dim)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the coarse curve has %zu coordinates a point and the fine one %zu", coarse->space->point_dim,
                         fine->space->point_dim);
    status = coordinates_check(coarse, "coarse", error);
    if (status == BAT_OK)
        status = coordinates_check(fine, "fine", error);
    question asked = {.curve = fine, .coarse = coarse, .distance = distance_from_edges, .end = fine->count};
    return status == BAT_OK ? max_distance(&asked, options, distance, error) : status;
}

bat_status bat_curve_limit_distance(const bat_curve *curve, const bat_mask_stencil *stencil,
                                    const bat_curve_measure_options *options, double *distance, bat_error *error)
{
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status != BAT_OK)
        return status;
    if (curve->count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the curve has no points");
    if (!space_is_euclidean(curve->space))
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "a limit stencil has no meaning in the space %s",
                         curve->space->name);
    status = coordinates_check(curve, "refined", error);
    question asked = {.curve = curve, .stencil = stencil, .distance = distance_from_limit, .end = curve->count};
    if (!curve->closed)
    {
        int last = stencil->first + (int)stencil->count - 1;
        size_t before = 1 + (size_t)(stencil->first < 0 ? -stencil->first : 0), after = 1 + (size_t)(last > 0 ? last : 0);
        asked.begin = before;
        asked.end = curve->count > after ? curve->count - after : 0;
    }
    return status == BAT_OK ? max_distance(&asked, options, distance, error) : status;
}
