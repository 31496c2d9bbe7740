#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "curve/plan.h"
#include "motion/hermite_average.h"
#include "space/builtin.h"

#include <string.h>

// Refinement

bat_hermite_refine_options bat_hermite_refine_defaults(void)
{
    return (bat_hermite_refine_options){
        .order = 1,
        .levels = 5,
        .max_points = BAT_MAX_POINTS,
    };
}

/// The plan of a refinement. During the computation a row is a point, its tangent and, where there are times, its time.
typedef struct hermite_plan
{
    const bat_hermite_curve *coarse;
    const bat_hermite_refine_options *options;
    const refine_kernel *linear; ///< null: averages of directions
    size_t point_dim, tangent_dim, dim;
    cascade task;
    bool ends_added;       ///< the coarse ends are put around the rows of the last level
    size_t count;          ///< rows of the result
    size_t before, after;  ///< rows needed beyond the coarse ones
    double *buffer, *rows; ///< coarse rows; row 0 is `rows`
} hermite_plan;

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_hermite_refine_options, order, OPTION_SIZE, 1, BAT_HERMITE_MAX_ORDER),
    OPTION_FIELD(bat_hermite_refine_options, levels, OPTION_SIZE, 0, CASCADE_MOST_LEVELS),
    OPTION_FIELD(bat_hermite_refine_options, max_points, OPTION_SIZE, 1, INFINITY),
    OPTION_THREADS(bat_hermite_refine_options),
};

const bat_options_table bat_hermite_refine_fields = OPTIONS_TABLE(bat_hermite_refine_options, FIELDS, NULL);

static bat_status lay_out(hermite_plan *plan, bat_error *error)
{
    const bat_hermite_curve *coarse = plan->coarse;
    const bat_hermite_refine_options *options = plan->options;
    size_t count = coarse->count, levels = options->levels;
    plan->point_dim = coarse->space->point_dim;
    plan->tangent_dim = coarse->space->tangent_dim;
    plan->dim = plan->point_dim + plan->tangent_dim + (coarse->times != NULL ? 1 : 0);
    refine_kernel kernel_made = plan->linear != NULL
                                    ? *plan->linear
                                    : kernel_lane_riesenfeld(coarse->space, plan->dim, options->order, hermite_row_average);
    plan->task = (cascade){.kernel = kernel_made, .levels = levels, .count = count, .closed = coarse->closed};
    if (!plan_has_room(&plan->task.kernel, count, levels, options->max_points))
        return ERROR_TOO_LARGE(error, "%zu points refined %zu times are too many points (limit %zu)", count, levels,
                               options->max_points);
    const refine_kernel *kernel = &plan->task.kernel;
    bool dual = ((kernel->first + kernel->last) & 1) != 0;
    plan->ends_added = !coarse->closed && levels > 0 && dual;
    plan->task.result =
        coarse->closed ? (index_range){0, (ptrdiff_t)(count << levels)} : plan_between_ends(kernel, levels, count);
    plan->count = (size_t)(plan->task.result.end - plan->task.result.begin) + (plan->ends_added ? 2 : 0);
    if (plan->count > options->max_points)
        return ERROR_TOO_LARGE(error, "the refined curve has %zu points, more than %zu", plan->count, options->max_points);
    plan->task.threads = options->threads;
    index_range support = cascade_support(&plan->task);
    plan->before = support.begin < 0 ? (size_t)-support.begin : 0;
    plan->after = support.end > (ptrdiff_t)count ? (size_t)support.end - count : 0;
    return BAT_OK;
}

/// The rows of the coarse data that the plan needs.
static bat_status load_rows(hermite_plan *plan, bat_error *error)
{
    const bat_hermite_curve *coarse = plan->coarse;
    size_t rows = plan->before + coarse->count + plan->after, row_size = plan->dim * sizeof(double);
    if (array_make(&plan->buffer, rows, row_size, error) != BAT_OK)
        return BAT_NO_MEMORY;
    plan->rows = plan->buffer + plan->before * plan->dim;
    for (size_t i = 0; i < coarse->count; i++)
    {
        double *row = plan->rows + i * plan->dim;
        memcpy(row, coarse->points + i * plan->point_dim, plan->point_dim * sizeof *row);
        memcpy(row + plan->point_dim, coarse->tangents + i * plan->tangent_dim, plan->tangent_dim * sizeof *row);
        if (coarse->times != NULL)
            row[plan->dim - 1] = coarse->times[i];
    }
    return BAT_OK;
}

/// Repeat the rows of a closed curve for `laps` periods.
static void wrap_row(const hermite_plan *plan, ptrdiff_t index)
{
    const bat_hermite_curve *coarse = plan->coarse;
    ptrdiff_t count = (ptrdiff_t)coarse->count, dim = (ptrdiff_t)plan->dim;
    ptrdiff_t from = (index % count + count) % count, laps = (index - from) / count;
    memcpy(plan->rows + index * dim, plan->rows + from * dim, plan->dim * sizeof(double));
    if (coarse->times != NULL)
    {
        double period = coarse->times[count - 1] - coarse->times[0] + coarse->closing_time;
        plan->rows[index * dim + dim - 1] += (double)laps * period;
    }
}

/// The point reflection of a row in the point of another, travelled in the same direction: the derivative of the reflection
/// is minus the transport along the geodesic through both.
static bat_status reflect_row(const hermite_plan *plan, const double *centre, const double *row, double *image)
{
    const bat_space *space = plan->coarse->space;
    size_t n = plan->point_dim;
    double tangent[BAT_SPACE_MAX_DIM];
    bat_status status = space_geodesic(space, centre, row, -1, image);
    if (status == BAT_OK)
        status = space->transport(space, row, centre, row + n, tangent);
    if (status == BAT_OK)
        status = space->transport(space, centre, image, tangent, image + n);
    if (plan->coarse->times != NULL)
        image[plan->dim - 1] = 2 * centre[plan->dim - 1] - row[plan->dim - 1];
    return status;
}

static bat_status reflect_rows(const hermite_plan *plan, bat_error *error)
{
    size_t last_index = plan->coarse->count - 1;
    ptrdiff_t dim = (ptrdiff_t)plan->dim;
    double *first = plan->rows, *last = plan->rows + last_index * plan->dim;
    // Both sides in step: a short curve's far rows on one side are made from new rows on the other.
    for (ptrdiff_t distance = 1; distance <= (ptrdiff_t)plan->before || distance <= (ptrdiff_t)plan->after; distance++)
    {
        bat_status status = BAT_OK;
        size_t at = 0;
        if (distance <= (ptrdiff_t)plan->before)
            status = reflect_row(plan, first, first + distance * dim, first - distance * dim);
        if (status == BAT_OK && distance <= (ptrdiff_t)plan->after)
        {
            at = last_index;
            status = reflect_row(plan, last, last - distance * dim, last + distance * dim);
        }
        if (status != BAT_OK)
            return error_set(error, status, at, 0, "the open curve cannot be continued beyond its end point %zu (%s)", at,
                             bat_status_name(status));
    }
    return BAT_OK;
}

static bat_status extend_rows(const hermite_plan *plan, bat_error *error)
{
    if (!plan->coarse->closed)
        return reflect_rows(plan, error);
    for (size_t i = 0; i < plan->after; i++)
        wrap_row(plan, (ptrdiff_t)(plan->coarse->count + i));
    for (size_t i = 1; i <= plan->before; i++)
        wrap_row(plan, -(ptrdiff_t)i);
    return BAT_OK;
}

/// Separate rows into the arrays of the curve, from its point `index` on.
static void store_rows(const hermite_plan *plan, const double *rows, size_t count, size_t index, bat_hermite_curve *fine)
{
    for (size_t i = 0; i < count; i++)
    {
        const double *row = rows + i * plan->dim;
        memcpy(fine->points + (index + i) * plan->point_dim, row, plan->point_dim * sizeof *row);
        memcpy(fine->tangents + (index + i) * plan->tangent_dim, row + plan->point_dim, plan->tangent_dim * sizeof *row);
        if (fine->times != NULL)
            fine->times[index + i] = row[plan->dim - 1];
    }
}

static bat_status carry_out(const hermite_plan *plan, bat_hermite_curve *fine, bat_error *error)
{
    size_t count = (size_t)(plan->task.result.end - plan->task.result.begin);
    double *made = memory_array(count, plan->dim * sizeof *made);
    if (made == NULL)
        return error_memory(error, count * plan->dim * sizeof *made);
    cascade task = plan->task;
    task.progress = plan->options->progress;
    bat_status status = cascade_run(&task, plan->rows, made, error);
    if (status == BAT_OK)
        store_rows(plan, made, count, plan->ends_added ? 1 : 0, fine);
    if (status == BAT_OK && plan->ends_added)
    {
        size_t ends[2] = {0, plan->coarse->count - 1}, places[2] = {0, plan->count - 1};
        bool derivatives = plan->linear != NULL;
        double factor = derivatives ? ldexp(1, -(int)plan->options->levels) : 1;
        for (int e = 0; e < 2; e++)
        {
            store_rows(plan, plan->rows + ends[e] * plan->dim, 1, places[e], fine);
            for (size_t c = 0; c < plan->tangent_dim; c++)
                fine->tangents[places[e] * plan->tangent_dim + c] *= factor;
        }
    }
    if (status == BAT_OK && fine->closed && plan->coarse->times != NULL)
        fine->closing_time = plan->coarse->times[plan->coarse->count - 1] - plan->coarse->times[0] +
                             plan->coarse->closing_time - (fine->times[fine->count - 1] - fine->times[0]);
    free(made);
    return status;
}

/// The checks that cost as much as a step run only when the step fails, to find the cause.
static bat_status explain(const hermite_plan *plan, bat_status status, bat_error *error)
{
    bool directions = plan->linear == NULL;
    hermite_check_parts parts = {.unit = directions, .edges = true, .admissible = directions};
    if (status != BAT_INVALID_POINT && status != BAT_CUT_LOCUS)
        return status;
    bat_status cause = hermite_check(plan->coarse, parts, plan->options->threads, error);
    return cause == BAT_OK ? status : cause;
}

static bat_status refine(hermite_plan *plan, bat_hermite_curve *fine, bat_error *error)
{
    const bat_hermite_curve *coarse = plan->coarse;
    *fine = (bat_hermite_curve){.space = coarse->space, .count = plan->count, .closed = coarse->closed};
    fine->kind = plan->linear != NULL ? BAT_HERMITE_TANGENTS_INDEX_DERIVATIVES : BAT_HERMITE_TANGENTS_DIRECTIONS;
    bat_status status = hermite_allocate(fine, coarse->times != NULL, error);
    if (status == BAT_OK)
        status = load_rows(plan, error);
    if (status == BAT_OK)
        status = extend_rows(plan, error);
    if (status == BAT_OK)
        status = carry_out(plan, fine, error);
    free(plan->buffer);
    return status;
}

bat_status hermite_refine_by(const bat_hermite_curve *coarse, const bat_hermite_refine_options *options,
                             const refine_kernel *linear, bat_hermite_curve *fine, bat_error *error)
{
    bat_hermite_refine_options defaults = bat_hermite_refine_defaults();
    hermite_plan plan = {.coarse = coarse, .options = options != NULL ? options : &defaults, .linear = linear};
    bool directions = linear == NULL;
    // Without a step, or with one that does not check its edges, every edge is checked here.
    hermite_check_parts parts = {.unit = directions, .edges = !directions || plan.options->levels == 0};
    parts.admissible = directions && parts.edges;
    bat_status status = bat_options_check(&bat_hermite_refine_fields, plan.options, error);
    if (status == BAT_OK)
        status = hermite_check(coarse, parts, plan.options->threads, error);
    if (status == BAT_OK)
        status = lay_out(&plan, error);
    if (status != BAT_OK)
        return status;
    bat_hermite_curve result = {0};
    status = refine(&plan, &result, error);
    if (status == BAT_OK)
        *fine = result;
    else
        bat_hermite_free(&result);
    return status == BAT_OK ? BAT_OK : explain(&plan, status, error);
}

bat_status bat_hermite_refine(const bat_hermite_curve *coarse, const bat_hermite_refine_options *options,
                              bat_hermite_curve *fine, bat_error *error)
{
    return hermite_refine_by(coarse, options, NULL, fine, error);
}
