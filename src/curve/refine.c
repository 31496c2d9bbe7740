#include "batten/analysis.h"
#include "batten/curve.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/cascade.h"
#include "curve/polygon.h"
#include "space/known.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum
{
    /// More levels than this overflow size_t from any number of points.
    MOST_LEVELS = 60
};

static const double FOUR_POINT_WEIGHT = 1.0 / 16.0;

const char *bat_scheme_name_for_space(const bat_space *space)
{
    if (space->exterior_angle != NULL && space->apex != NULL)
        return "angle-4";
    return space_is_euclidean(space) ? "four-point" : "log-exp-4";
}

bat_scheme bat_scheme_for_space(const bat_space *space)
{
    bat_scheme scheme;
    (void)bat_scheme_by_name(bat_scheme_name_for_space(space), &scheme, NULL);
    return scheme;
}

bat_refine_options bat_refine_defaults(void)
{
    return (bat_refine_options){
        .scheme = bat_scheme_angle(BAT_TENSION_FOUR_POINT),
        .levels = 5,
        .ends = BAT_END_REFLECT,
        .max_points = (size_t)1 << 40,
    };
}

/// Which indices of the last level make the refined curve, and whether the coarse end points are put around them.
typedef struct layout
{
    index_range points;
    bool ends_added;
    size_t count; ///< rows of the refined curve
} layout;

/// A mask has a vertex where its centre is whole: new point i lies at (i - centre) / 2 in units of old indices. `first` and
/// `last` sum to twice the centre.
static int doubled_centre(const refine_kernel *kernel)
{
    return kernel->first + kernel->last;
}

/// The points of the last level whose whole stencils lie inside 0 … count - 1.
static index_range free_range(const refine_kernel *kernel, size_t levels, size_t count)
{
    ptrdiff_t low = 0, high = (ptrdiff_t)count - 1;
    for (size_t level = 0; level < levels && low <= high; level++)
    {
        low = 2 * low + kernel->last - 1;
        high = 2 * high + kernel->first + 1;
    }
    return (index_range){low, high + 1};
}

/// The points of the last level at parameters from 0 to count - 1. After k levels point i lies at
/// i / 2^k - centre (1 - 1 / 2^k), so the first is the smallest i >= centre (2^k - 1).
static index_range range_between_ends(const refine_kernel *kernel, size_t levels, size_t count)
{
    ptrdiff_t doubled = doubled_centre(kernel) * (((ptrdiff_t)1 << levels) - 1);
    ptrdiff_t begin = (doubled + (doubled & 1)) / 2;
    ptrdiff_t length = (ptrdiff_t)(count - 1) << levels;
    return (index_range){begin, begin + length + ((doubled & 1) == 0 ? 1 : 0)};
}

static bat_status lay_out(const refine_kernel *kernel, const bat_curve *coarse, const bat_refine_options *options,
                          layout *result, bat_error *error)
{
    size_t count = coarse->count, levels = options->levels, limit;
    // Room for the indices themselves and for what lies beyond the ends.
    size_t most = (size_t)PTRDIFF_MAX / 4 / sizeof(double) / (kernel->dim > 0 ? kernel->dim : 1);
    limit = options->max_points < most ? options->max_points : most;
    if (levels > MOST_LEVELS || count > limit >> levels)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "%zu points refined %zu times are more than %zu points",
                         count, levels, limit);
    *result = (layout){.points = {0, (ptrdiff_t)(count << levels)}};
    if (!coarse->closed && options->ends == BAT_END_FREE)
        result->points = free_range(kernel, levels, count);
    else if (!coarse->closed)
    {
        result->points = range_between_ends(kernel, levels, count);
        result->ends_added = levels > 0 && (doubled_centre(kernel) & 1) != 0;
    }
    ptrdiff_t length = result->points.end - result->points.begin;
    if (length < 1)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "nothing is left of %zu points after %zu levels without a rule for the ends", count, levels);
    result->count = (size_t)length + (result->ends_added ? 2 : 0);
    if (result->count > limit)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the refined curve has %zu points, more than %zu",
                         result->count, limit);
    return BAT_OK;
}

static bat_status check_mask(const bat_mask *mask, bool interpolatory, bat_error *error)
{
    if (mask->count < 1 || mask->count > BAT_MASK_MAX)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a mask has 1 to %d coefficients, not %zu",
                         BAT_MASK_MAX, mask->count);
    if (mask->first < -BAT_MASK_MAX || mask->first > BAT_MASK_MAX)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the mask's first index %d is not within %d of 0",
                         mask->first, BAT_MASK_MAX);
    for (size_t i = 0; i < mask->count; i++)
        if (!isfinite(mask->coefficients[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "coefficient %zu of the mask is not finite", i);
    if (interpolatory && !bat_mask_is_interpolatory(mask))
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "a log-exp scheme needs the mask of an interpolatory one");
    return BAT_OK;
}

static bat_status check_options(const bat_space *space, const bat_refine_options *options, bat_error *error)
{
    const bat_scheme *scheme = &options->scheme;
    if (scheme->kind != BAT_SCHEME_LINEAR && (options->snap || options->ends == BAT_END_FREE))
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "only linear schemes can %s",
                         options->snap ? "be moved to their limit" : "leave the ends free");
    switch (scheme->kind)
    {
    case BAT_SCHEME_LINEAR:
        if (!space_is_euclidean(space))
            return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                             "a linear scheme needs a Euclidean space, not the %s; try angle-4 or log-exp-4", space->name);
        return check_mask(&scheme->mask, false, error);
    case BAT_SCHEME_ANGLE:
        if (space->exterior_angle == NULL || space->apex == NULL)
            return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                             "an angle-based scheme needs an oriented surface (plane, sphere in R^3, disk), not the %s of "
                             "dimension %zu; try log-exp-4",
                             space->name, space->dimension);
        if (!isfinite(scheme->tension))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the tension is not finite");
        return BAT_OK;
    case BAT_SCHEME_LOG_EXP:
        return check_mask(&scheme->mask, true, error);
    }
    return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there is no scheme of kind %d", (int)scheme->kind);
}

static refine_kernel kernel_of(const bat_space *space, const bat_scheme *scheme)
{
    switch (scheme->kind)
    {
    case BAT_SCHEME_ANGLE:
        return kernel_angle(space, scheme);
    case BAT_SCHEME_LOG_EXP:
        return kernel_log_exp(space, scheme);
    case BAT_SCHEME_LINEAR:
    default:
        return kernel_linear(scheme, space->point_dim);
    }
}

static polygon_end end_of(const bat_scheme *scheme, bat_end_rule rule)
{
    if (rule != BAT_END_EXTRAPOLATE)
        return POLYGON_END_REFLECT;
    if (scheme->kind == BAT_SCHEME_ANGLE)
        return POLYGON_END_MIRROR;
    return bat_mask_is_interpolatory(&scheme->mask) ? POLYGON_END_CUBIC : POLYGON_END_LINE;
}

/// What a curve's channels are refined by: the scheme's own mask, or the four-point mask beside an angle-based scheme.
static bat_scheme channel_scheme(const bat_scheme *scheme)
{
    return bat_scheme_linear(scheme->kind == BAT_SCHEME_ANGLE ? bat_mask_four_point(FOUR_POINT_WEIGHT) : scheme->mask);
}

/// Rows of one kind, points or channels, that are refined together, with room around them for what lies beyond the ends.
typedef struct padded_rows
{
    const bat_space *space;
    double *buffer, *rows; ///< row 0 is `rows`
    size_t before, count, after;
    bool closed;
} padded_rows;

/// Room for `count` rows and for those that `task` reads around them.
static bat_status padded_make(const bat_space *space, const cascade *task, size_t count, bool closed, padded_rows *padded,
                              bat_error *error)
{
    index_range support = cascade_support(task);
    *padded = (padded_rows){.space = space, .count = count, .closed = closed};
    padded->before = support.begin < 0 ? (size_t)-support.begin : 0;
    padded->after = support.end > (ptrdiff_t)count ? (size_t)support.end - count : 0;
    size_t rows = padded->before + count + padded->after;
    padded->buffer = memory_array(rows, space->point_dim * sizeof *padded->buffer);
    if (padded->buffer == NULL)
        return error_memory(error, rows * space->point_dim * sizeof *padded->buffer);
    padded->rows = padded->buffer + padded->before * space->point_dim;
    return BAT_OK;
}

/// Refine rows by the levels of `task`, whose result goes to `fine`.
static bat_status refine_padded(padded_rows *coarse, cascade *task, const bat_scheme *scheme, bat_end_rule ends,
                                double *fine, bat_error *error)
{
    bat_status status = polygon_extend(coarse->space, coarse->rows, coarse->count, coarse->closed, end_of(scheme, ends),
                                       coarse->before, coarse->after, error);
    if (status != BAT_OK)
        return status;
    size_t first = coarse->closed ? 0 : 1, end = coarse->closed ? coarse->count : coarse->count - 1;
    if (scheme->kind == BAT_SCHEME_ANGLE && scheme->adaptive)
        task->kernel.mean_angle = kernel_angle_mean(coarse->space, coarse->rows, first, end);
    return cascade_run(task, coarse->rows, fine, error);
}

static cascade make_task(const bat_space *space, const bat_scheme *scheme, const bat_refine_options *options, size_t count,
                         bool closed)
{
    return (cascade){
        .kernel = kernel_of(space, scheme),
        .count = count,
        .closed = closed,
        .threads = options->threads,
        .progress = options->progress,
    };
}

/// All levels at once, from rows to the layout's rows.
static bat_status refine_rows(const bat_space *space, const double *rows, const bat_curve *coarse, const bat_scheme *scheme,
                              const bat_refine_options *options, const layout *shape, double *fine, bat_error *error)
{
    size_t dim = space->point_dim, count = coarse->count;
    cascade task = make_task(space, scheme, options, count, coarse->closed);
    task.levels = options->levels;
    task.result = shape->points;
    bat_status status = options->snap ? bat_mask_limit_stencil(&scheme->mask, &task.snap, error) : BAT_OK;
    padded_rows padded = {0};
    if (status == BAT_OK)
        status = padded_make(space, &task, count, coarse->closed, &padded, error);
    if (status == BAT_OK)
    {
        memcpy(padded.rows, rows, count * dim * sizeof *rows);
        status = refine_padded(&padded, &task, scheme, options->ends, fine + (shape->ends_added ? dim : 0), error);
    }
    free(padded.buffer);
    // A symmetric mask takes a polygon that is its own point reflection through the end point: only rounding moves it.
    bool keep_ends = !coarse->closed && options->ends == BAT_END_REFLECT && scheme->kind == BAT_SCHEME_LINEAR &&
                     bat_mask_is_symmetric(&scheme->mask);
    if (status == BAT_OK && (shape->ends_added || keep_ends))
    {
        memcpy(fine, rows, dim * sizeof *fine);
        memcpy(fine + (shape->count - 1) * dim, rows + (count - 1) * dim, dim * sizeof *fine);
    }
    return status;
}

/// One level of a whole polygon of `count` points.
static cascade one_level(const bat_curve *coarse, const bat_refine_options *options, size_t count)
{
    cascade task = make_task(coarse->space, &options->scheme, options, count, coarse->closed);
    task.levels = 1;
    task.result = (index_range){0, (ptrdiff_t)(coarse->closed ? 2 * count : 2 * count - 1)};
    return task;
}

/// Level after level, for a rule that looks at the whole polygon of each.
static bat_status refine_level_by_level(const bat_curve *coarse, const bat_refine_options *options, double *fine,
                                        bat_error *error)
{
    const bat_space *space = coarse->space;
    padded_rows now;
    cascade task = one_level(coarse, options, coarse->count);
    bat_status status = padded_make(space, &task, coarse->count, coarse->closed, &now, error);
    if (status == BAT_OK)
        memcpy(now.rows, coarse->points, coarse->count * space->point_dim * sizeof *now.rows);
    for (size_t level = 1; level <= options->levels && status == BAT_OK; level++)
    {
        size_t count = (size_t)task.result.end;
        cascade next_task = one_level(coarse, options, count);
        padded_rows next = {.rows = fine};
        if (level < options->levels)
            status = padded_make(space, &next_task, count, coarse->closed, &next, error);
        if (status == BAT_OK)
            status = refine_padded(&now, &task, &options->scheme, options->ends, next.rows, error);
        free(now.buffer);
        now = next;
        task = next_task;
    }
    free(now.buffer);
    return status;
}

static bat_status refine_points(const bat_curve *coarse, const bat_refine_options *options, const layout *shape,
                                double *fine, bat_error *error)
{
    if (options->scheme.kind == BAT_SCHEME_ANGLE && options->scheme.adaptive && options->levels > 0)
        return refine_level_by_level(coarse, options, fine, error);
    return refine_rows(coarse->space, coarse->points, coarse, &options->scheme, options, shape, fine, error);
}

static bat_status refine_channels(const bat_curve *coarse, const bat_refine_options *options, const layout *shape,
                                  double *fine, bat_error *error)
{
    bat_space space = bat_euclidean(coarse->channel_count);
    bat_scheme scheme = channel_scheme(&options->scheme);
    return refine_rows(&space, coarse->channels, coarse, &scheme, options, shape, fine, error);
}

/// Everything that can be said before anything is computed.
static bat_status prepare(const bat_curve *coarse, const bat_refine_options *options, layout *shape, bat_error *error)
{
    bat_status status = check_options(coarse->space, options, error);
    if (status == BAT_OK && coarse->channel_count > BAT_SPACE_MAX_DIM)
        status = error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "%zu channels are more than %d", coarse->channel_count,
                           BAT_SPACE_MAX_DIM);
    if (status == BAT_OK)
        status = bat_curve_check(coarse, error);
    if (status != BAT_OK)
        return status;
    refine_kernel kernel = kernel_of(coarse->space, &options->scheme);
    return lay_out(&kernel, coarse, options, shape, error);
}

bat_status bat_curve_refined_count(const bat_curve *coarse, const bat_refine_options *options, size_t *count,
                                   bat_error *error)
{
    bat_refine_options defaults = bat_refine_defaults();
    layout shape;
    bat_status status = prepare(coarse, options != NULL ? options : &defaults, &shape, error);
    if (status == BAT_OK)
        *count = shape.count;
    return status;
}

static bat_status fill(const bat_curve *coarse, const bat_refine_options *options, const layout *shape, double *points,
                       double *channels, bat_error *error)
{
    bat_status status = refine_points(coarse, options, shape, points, error);
    if (status == BAT_OK && coarse->channel_count > 0 && channels != NULL)
        status = refine_channels(coarse, options, shape, channels, error);
    return status;
}

bat_status bat_curve_refine_into(const bat_curve *coarse, const bat_refine_options *options, double *points,
                                 double *channels, size_t capacity, bat_error *error)
{
    bat_refine_options defaults = bat_refine_defaults();
    options = options != NULL ? options : &defaults;
    layout shape;
    bat_status status = prepare(coarse, options, &shape, error);
    if (status != BAT_OK)
        return status;
    if (capacity < shape.count)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the refined curve has %zu points, there is room for %zu",
                         shape.count, capacity);
    return fill(coarse, options, &shape, points, channels, error);
}

bat_status bat_curve_refine(const bat_curve *coarse, const bat_refine_options *options, bat_curve *fine, bat_error *error)
{
    bat_refine_options defaults = bat_refine_defaults();
    options = options != NULL ? options : &defaults;
    layout shape;
    bat_status status = prepare(coarse, options, &shape, error);
    if (status != BAT_OK)
        return status;
    size_t channel_count = coarse->channel_count, row = coarse->space->point_dim * sizeof(double);
    bat_curve result = {
        .space = coarse->space, .count = shape.count, .closed = coarse->closed, .channel_count = channel_count};
    result.points = memory_array(shape.count, row);
    if (channel_count > 0)
        result.channels = memory_array(shape.count, channel_count * sizeof *result.channels);
    if (result.points == NULL || (channel_count > 0 && result.channels == NULL))
        status = error_memory(error, shape.count * row);
    else
        status = fill(coarse, options, &shape, result.points, result.channels, error);
    if (status != BAT_OK)
    {
        bat_curve_free(&result);
        return status;
    }
    *fine = result;
    return BAT_OK;
}
