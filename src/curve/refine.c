#include "curve/refine.h"

#include "base/memory.h"
#include "base/progress.h"
#include "curve/parametric.h"
#include "linalg/vector.h"

#include <string.h>

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
    if (array_make(&padded->buffer, rows, space->point_dim * sizeof *padded->buffer, error) != BAT_OK)
        return BAT_NO_MEMORY;
    padded->rows = padded->buffer + padded->before * space->point_dim;
    return BAT_OK;
}

/// Fill the rows around a polygon by the end rule.
static bat_status extend(padded_rows *coarse, const refine_kernel *kernel, const bat_curve_scheme *scheme,
                         bat_curve_end_rule ends, bat_error *error)
{
    if (scheme_kind_of(scheme)->beside_channels && ends == BAT_CURVE_END_RULE_EXTRAPOLATE && !coarse->closed)
        return parametric_extend(coarse->space, kernel->space, scheme->parameters, coarse->rows, coarse->count,
                                 coarse->before, coarse->after, error);
    polygon_end end = POLYGON_END_REFLECT;
    if (ends == BAT_CURVE_END_RULE_EXTRAPOLATE)
        end = scheme_end(scheme);
    return polygon_extend(coarse->space, coarse->rows, coarse->count, coarse->closed, end, coarse->before, coarse->after,
                          error);
}

/// Refine rows by the levels of `task`, whose result goes to `fine`.
static bat_status refine_padded(padded_rows *coarse, cascade *task, const bat_curve_scheme *scheme, bat_curve_end_rule ends,
                                double *fine, bat_error *error)
{
    bat_status status = extend(coarse, &task->kernel, scheme, ends, error);
    if (status != BAT_OK)
        return status;
    // Without levels there are no rows around the polygon.
    if (task->kernel.measure != NULL && task->levels > 0)
        task->kernel.measure(&task->kernel, coarse->rows, coarse->count, coarse->closed);
    return cascade_run(task, coarse->rows, fine, error);
}

static cascade make_task(const refine_kernel *kernel, const bat_curve_refine_options *options, size_t count, bool closed)
{
    return (cascade){
        .kernel = *kernel,
        .count = count,
        .closed = closed,
        .threads = options->threads,
    };
}

/// Whether a mask can take numbers of this size out of the range of doubles. A bound, not an estimate.
static bool may_overflow(const bat_mask *mask, size_t levels, double largest)
{
    double sum = 0;
    for (size_t k = 0; k < mask->count; k++)
        sum += fabs(mask->coefficients[k]);
    return !isfinite(largest * pow(fmax(sum, 1), (double)levels + 1));
}

/// The result of a linear scheme is looked through only where it may hold what is not finite.
static bat_status check_overflow(const padded_rows *coarse, const bat_curve_scheme *scheme, const refine_plan *plan,
                                 const double *fine, bat_error *error)
{
    size_t dim = coarse->space->point_dim, rows = coarse->before + coarse->count + coarse->after;
    if (!scheme_kind_of(scheme)->linear ||
        !may_overflow(&scheme->mask, plan->options.levels, vector_largest(rows * dim, coarse->buffer)))
        return BAT_OK;
    for (size_t i = 0; i < plan->count; i++)
        for (size_t c = 0; c < dim; c++)
            if (!isfinite(fine[i * dim + c]))
            {
                size_t point = i >> plan->options.levels;
                return error_point(error, BAT_INVALID_POINT, point, "new points after point", " are too large for doubles");
            }
    return BAT_OK;
}

/// Rows of one kind, and the levels that are still to be computed.
typedef struct refine_input
{
    const bat_space *space;
    const double *rows;
    size_t count;
    bool closed;
    size_t levels;
    size_t base; ///< levels before
} refine_input;

/// All levels at once, from rows to the plan's rows; `kernel` is the scheme's, for rows of the space.
static bat_status refine_rows(const refine_input *from, const bat_curve_scheme *scheme, const refine_kernel *kernel,
                              const refine_plan *plan, bat_progress progress, double *fine, bat_error *error)
{
    const bat_curve_refine_options *options = &plan->options;
    const double *rows = from->rows;
    size_t dim = from->space->point_dim, count = from->count;
    cascade task = make_task(kernel, options, count, from->closed);
    task.levels = from->levels;
    task.base = from->base;
    task.result = plan->points;
    task.snap = plan->snap;
    task.progress = progress;
    padded_rows padded;
    bat_status status = padded_make(from->space, &task, count, from->closed, &padded, error);
    if (status == BAT_OK)
    {
        memcpy(padded.rows, rows, count * dim * sizeof *rows);
        status = refine_padded(&padded, &task, scheme, options->ends, fine + (plan->ends_added ? dim : 0), error);
    }
    // A symmetric mask takes a polygon that is its own point reflection through the end point: only rounding moves it.
    bool keep_ends = !from->closed && options->ends <= BAT_CURVE_END_RULE_REFLECT && scheme_kind_of(scheme)->linear &&
                     mask_is_symmetric(&scheme->mask);
    if (status == BAT_OK && (plan->ends_added || keep_ends))
    {
        memcpy(fine, rows, dim * sizeof *fine);
        memcpy(fine + (plan->count - 1) * dim, rows + (count - 1) * dim, dim * sizeof *fine);
    }
    if (status == BAT_OK)
        status = check_overflow(&padded, scheme, plan, fine, error);
    free(padded.buffer);
    return status;
}

/// The number of levels that must be there as a whole before the next begins.
static size_t whole_levels(const bat_curve_scheme *scheme, const refine_plan *plan, size_t levels)
{
    size_t decided = scheme_decided_levels(scheme), first = plan->options.first_level;
    if (decided > 0)
    {
        size_t left = decided > first ? decided - first : 0;
        return left < levels ? left : levels;
    }
    return scheme_needs_whole_polygons(scheme) ? levels : 0;
}

/// The scheme of the levels after those that a rule decides.
static bat_curve_scheme scheme_after_rule(void)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle(BAT_CURVE_TENSION_SIX_POINT);
    scheme.turns = true;
    return scheme;
}

/// The progress of levels from `first` up to `end` - 1 of `levels`. A level costs twice the one before.
static progress_part level_progress(bat_progress progress, size_t first, size_t end, size_t levels)
{
    double whole = ldexp(1, (int)levels) - 1, begin = ldexp(1, (int)first) - 1;
    return (progress_part){progress, begin / whole, (ldexp(1, (int)end) - 1 - begin) / whole};
}

/// One level of a whole polygon.
/// @param fine receives 2 count points, of an open polygon 2 count - 1
static bat_status refine_once(const refine_input *from, size_t level, const refine_plan *plan, bat_progress progress,
                              double *fine, bat_error *error)
{
    const bat_curve_refine_options *options = &plan->options;
    refine_kernel kernel = scheme_kernel(from->space, &options->scheme);
    kernel.level = options->first_level + level;
    cascade task = make_task(&kernel, options, from->count, from->closed);
    task.levels = 1;
    task.base = level;
    task.result = (index_range){0, (ptrdiff_t)(2 * from->count - (from->closed ? 0 : 1))};
    task.progress = progress;
    padded_rows padded;
    bat_status status = padded_make(from->space, &task, from->count, from->closed, &padded, error);
    if (status == BAT_OK)
    {
        memcpy(padded.rows, from->rows, from->count * from->space->point_dim * sizeof *padded.rows);
        status = refine_padded(&padded, &task, &options->scheme, options->ends, fine, error);
    }
    free(padded.buffer);
    return status;
}

/// The first `whole` levels of a polygon, one after the other.
/// @param from   the polygon; receives that of the last of these levels
/// @param levels in all, for the progress
/// @param fine   where the rows of the last level go if they are the result; else null
/// @param owned  receives the memory of from->rows, to be freed; null if they are in `fine` or given
static bat_status refine_whole_levels(refine_input *from, size_t whole, size_t levels, const refine_plan *plan,
                                      bat_progress progress, double *fine, double **owned, bat_error *error)
{
    bat_status status = BAT_OK;
    *owned = NULL;
    for (size_t level = 0; level < whole && status == BAT_OK; level++)
    {
        size_t count = 2 * from->count - (from->closed ? 0 : 1), size = from->space->point_dim * sizeof(double);
        bool last = fine != NULL && level + 1 == whole;
        double *next = last ? fine : memory_array(count, size);
        progress_part part = level_progress(progress, level, level + 1, levels);
        status = next != NULL ? refine_once(from, level, plan, progress_of_part(&part), next, error)
                              : error_memory(error, count * size);
        free(*owned);
        *owned = last ? NULL : next;
        *from = (refine_input){from->space, next, count, from->closed, from->levels - 1, level + 1};
    }
    if (status != BAT_OK)
    {
        free(*owned);
        *owned = NULL;
    }
    return status;
}

/// Level after level for the first `whole` levels, for a rule that needs the whole polygon of each; then all others at once.
static bat_status refine_level_by_level(const bat_curve *coarse, size_t whole, const refine_plan *plan,
                                        bat_progress progress, double *fine, bat_error *error)
{
    size_t levels = plan->options.levels;
    refine_input now = {coarse->space, coarse->points, coarse->count, coarse->closed, levels, 0};
    double *owned;
    bat_status status =
        refine_whole_levels(&now, whole, levels, plan, progress, whole == levels ? fine : NULL, &owned, error);
    if (status == BAT_OK && whole < levels)
    {
        const bat_curve_scheme scheme = scheme_after_rule();
        progress_part part = level_progress(progress, whole, levels, levels);
        refine_kernel kernel = scheme_kernel(now.space, &scheme);
        status = refine_rows(&now, &scheme, &kernel, plan, progress_of_part(&part), fine, error);
    }
    free(owned);
    return status;
}

static bat_status refine_points(const bat_curve *coarse, const refine_plan *plan, bat_progress progress, double *fine,
                                bat_error *error)
{
    const bat_curve_scheme *scheme = &plan->options.scheme;
    size_t levels = plan->options.levels, whole = whole_levels(scheme, plan, levels);
    if (whole > 0 || (scheme_decided_levels(scheme) > 0 && levels > 0))
        return refine_level_by_level(coarse, whole, plan, progress, fine, error);
    refine_input all = {coarse->space, coarse->points, coarse->count, coarse->closed, levels, 0};
    refine_kernel kernel = scheme_kernel(coarse->space, scheme);
    return refine_rows(&all, scheme, &kernel, plan, progress, fine, error);
}

/// Prepare up to `levels` levels of a polygon.
static bat_status prepare_source(const refine_input *from, const bat_curve_scheme *scheme, const refine_kernel *kernel,
                                 const refine_plan *plan, refine_source *source, bat_error *error)
{
    cascade task = make_task(kernel, &plan->options, from->count, from->closed);
    task.snap = plan->snap;
    task.base = from->base;
    ptrdiff_t centre = (task.kernel.first + task.kernel.last) / 2;
    source->shift = plan->snap.count > 0 && !mask_is_interpolatory(&scheme->mask) ? centre : 0;
    size_t edges = polygon_edges(from->count, from->closed);
    padded_rows padded = {.space = from->space, .count = from->count, .closed = from->closed};
    for (task.levels = 0; task.levels <= from->levels; task.levels++)
    {
        ptrdiff_t begin = refine_source_index(source, task.levels, 0);
        task.result = (index_range){begin, begin + (ptrdiff_t)(edges << task.levels) + 1};
        index_range support = cascade_support(&task);
        size_t before = support.begin < 0 ? (size_t)-support.begin : 0;
        size_t after = support.end > (ptrdiff_t)padded.count ? (size_t)support.end - padded.count : 0;
        padded.before = before > padded.before ? before : padded.before;
        padded.after = after > padded.after ? after : padded.after;
    }
    size_t dim = from->space->point_dim, count = padded.before + padded.count + padded.after;
    if (array_make(&padded.buffer, count, dim * sizeof *padded.buffer, error) != BAT_OK)
        return BAT_NO_MEMORY;
    padded.rows = padded.buffer + padded.before * dim;
    memcpy(padded.rows, from->rows, padded.count * dim * sizeof *padded.rows);
    bat_status status = extend(&padded, kernel, scheme, plan->options.ends, error);
    if (status != BAT_OK)
    {
        free(padded.buffer);
        return status;
    }
    if (task.kernel.measure != NULL)
        task.kernel.measure(&task.kernel, padded.rows, padded.count, padded.closed);
    source->space = from->space;
    source->task = task;
    source->buffer = padded.buffer;
    source->rows = padded.rows;
    return BAT_OK;
}

bat_status refine_source_make(const bat_space *space, const double *rows, const bat_curve *coarse,
                              const bat_curve_scheme *scheme, const refine_kernel *kernel, const refine_plan *plan,
                              size_t levels, refine_source *source, bat_error *error)
{
    refine_input now = {space, rows, coarse->count, coarse->closed, levels, 0};
    size_t whole = whole_levels(scheme, plan, levels);
    *source = (refine_source){.base = whole};
    if (whole == 0 && scheme_decided_levels(scheme) == 0)
        return prepare_source(&now, scheme, kernel, plan, source, error);
    double *owned;
    bat_status status = refine_whole_levels(&now, whole, levels, plan, (bat_progress){0}, NULL, &owned, error);
    source->scheme = scheme_after_rule();
    refine_kernel late = scheme_kernel(space, &source->scheme);
    if (status == BAT_OK)
        status = prepare_source(&now, &source->scheme, &late, plan, source, error);
    free(owned);
    return status;
}

bat_status refine_source_run(const refine_source *source, size_t levels, size_t edge, size_t begin, size_t count,
                             int threads, double *fine, bat_error *error)
{
    ptrdiff_t first = refine_source_index(source, levels, edge) + (ptrdiff_t)begin;
    if (levels < source->base)
    {
        // A rule keeps its points: those of an earlier level are among those of the last one.
        size_t dim = source->space->point_dim, step = dim << (source->base - levels);
        for (size_t i = 0; i < count; i++)
            memcpy(fine + i * dim, source->rows + ((size_t)first + i) * step, dim * sizeof *fine);
        return BAT_OK;
    }
    cascade task = source->task;
    task.levels = levels - source->base;
    task.result = (index_range){first, first + (ptrdiff_t)count};
    task.threads = threads;
    return cascade_run(&task, source->rows, fine, error);
}

void refine_source_free(refine_source *source)
{
    free(source->buffer);
    *source = (refine_source){0};
}

static bat_status refine_channels(const bat_curve *coarse, const refine_plan *plan, bat_progress progress, double *fine,
                                  bat_error *error)
{
    bat_space space = bat_euclidean(coarse->channel_count);
    bat_curve_scheme scheme = scheme_of_channels(&plan->options.scheme);
    refine_kernel kernel = scheme_kernel(&space, &scheme);
    refine_input all = {&space, coarse->channels, coarse->count, coarse->closed, plan->options.levels, 0};
    return refine_rows(&all, &scheme, &kernel, plan, progress, fine, error);
}

/// Points and channels as rows of one space, for the scheme that interpolates channels at the parameters of the points.
static bat_status refine_joined(const bat_curve *coarse, const refine_plan *plan, double *points, double *channels,
                                bat_error *error)
{
    size_t point_dim = coarse->space->point_dim, channel_count = coarse->channel_count, dim = point_dim + channel_count;
    row_space rows;
    memory_pool pool = {0};
    double *joined = memory_pool_array(&pool, coarse->count, dim * sizeof *joined),
           *fine = memory_pool_array(&pool, plan->count, dim * sizeof *fine);
    bat_status status = row_space_make(coarse->space, channel_count, &rows, error);
    if (status == BAT_OK)
        status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        const bat_curve_scheme *scheme = &plan->options.scheme;
        refine_kernel kernel = kernel_four_point(coarse->space, channel_count, scheme);
        refine_input all = {&rows.space, joined, coarse->count, coarse->closed, plan->options.levels, 0};
        rows_join(coarse, channel_count, joined);
        status = refine_rows(&all, scheme, &kernel, plan, plan->options.progress, fine, error);
    }
    if (status == BAT_OK)
        rows_split(fine, plan->count, point_dim, channel_count, points, channels);
    memory_pool_free(&pool);
    return status;
}

bat_status refine_carry_out(const bat_curve *coarse, const refine_plan *plan, bat_progress progress, double *points,
                            double *channels, bat_error *error)
{
    bool has_channels = coarse->channel_count > 0 && channels != NULL;
    const bat_curve_scheme *scheme = &plan->options.scheme;
    if (!scheme_goes_by_levels(scheme))
        return spline_refine(((const scheme_row *)(const void *)scheme->spline)->form, coarse, plan, points,
                             has_channels ? channels : NULL, error);
    if (scheme_kind_of(scheme)->beside_channels && has_channels)
        return refine_joined(coarse, plan, points, channels, error);
    double point_dim = (double)coarse->space->point_dim;
    double share = has_channels ? point_dim / (point_dim + (double)coarse->channel_count) : 1;
    progress_part parts[2] = {{progress, 0, share}, {progress, share, 1 - share}};
    bat_status status = refine_points(coarse, plan, progress_of_part(&parts[0]), points, error);
    if (status == BAT_OK && has_channels)
        status = refine_channels(coarse, plan, progress_of_part(&parts[1]), channels, error);
    return status;
}
