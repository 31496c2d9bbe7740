#include "base/error.h"
#include "base/option.h"
#include "curve/corner.h"
#include "curve/pieces.h"
#include "space/builtin.h"

#include <stdlib.h>

bat_curve_refine_options bat_curve_refine_defaults(void)
{
    return (bat_curve_refine_options){
        .scheme = {.kind = BAT_CURVE_SCHEME_KIND_AUTO},
        .levels = 5,
        .ends = BAT_CURVE_END_RULE_REFLECT,
        .max_points = BAT_MAX_POINTS,
        .max_levels = STOP_DEFAULT_LEVELS,
    };
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_curve_refine_options, levels, OPTION_SIZE, 0, CASCADE_MOST_LEVELS),
    OPTION_FAMILY(bat_curve_refine_options, ends, bat_curve_end_rule_family),
    OPTION_FIELD(bat_curve_refine_options, max_points, OPTION_SIZE, 1, INFINITY),
    OPTION_FAMILY(bat_curve_refine_options, simple, bat_curve_simple_family),
    OPTION_THREADS(bat_curve_refine_options),
    OPTION_FIELD(bat_curve_refine_options, corner_angle, OPTION_NUMBER, 0, CORNER_ANGLE_LIMIT),
    OPTION_FIELD(bat_curve_refine_options, max_edge, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_curve_refine_options, tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_curve_refine_options, relative_tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_curve_refine_options, max_levels, OPTION_SIZE, 0, STOP_MOST_LEVELS),
    OPTION_FIELD(bat_curve_refine_options, first_level, OPTION_SIZE, 0, CASCADE_MOST_LEVELS),
    OPTION_FIELD(bat_curve_refine_options, smooth, OPTION_ANGLE, 0, INFINITY),
};

static bat_status curve_refine_options_check(const void *opaque, bat_error *error)
{
    const bat_curve_refine_options *options = opaque;
    return bat_curve_scheme_check(&options->scheme, error);
}

const bat_options_table bat_curve_refine_fields =
    OPTIONS_TABLE(bat_curve_refine_options, FIELDS, curve_refine_options_check);

/// Whether a checked scheme has a meaning in a space, with the other options.
static bat_status check_space(const bat_space *space, const bat_curve_refine_options *options, bat_error *error)
{
    const scheme_kind *kind = scheme_kind_of(&options->scheme);
    int curvature;
    if (options->simple == BAT_CURVE_SIMPLE_ALWAYS && !space_is_surface(space, &curvature))
        return ERROR_UNSUPPORTED(
            error, 0, "curves cross only in surfaces (plane, sphere in R^3, disk), not in the %s of dimension %zu",
            space->name, space->dimension);
    if (!kind->linear && (options->snap || options->ends == BAT_CURVE_END_RULE_FREE))
        return ERROR_UNSUPPORTED(error, 0, "only linear schemes can %s",
                                 options->snap ? "be moved to their limit" : "leave the ends free");
    return kind->suits != NULL ? kind->suits(&options->scheme, space, error) : BAT_OK;
}

/// A mask has a vertex where its centre is whole: new point i lies at (i - centre) / 2. `first` + `last` = 2 centre.
static int doubled_centre(const refine_kernel *kernel)
{
    return kernel->first + kernel->last;
}

/// The points of the last level whose whole stencils lie inside 0 … count - 1, that of the limit included.
static index_range free_range(const refine_kernel *kernel, const bat_mask_stencil *snap, size_t levels, size_t count)
{
    ptrdiff_t low = 0, high = (ptrdiff_t)count - 1;
    for (size_t level = 0; level < levels && low <= high; level++)
    {
        low = 2 * low + kernel->last - 1;
        high = 2 * high + kernel->first + 1;
    }
    if (snap->count > 0)
    {
        low -= snap->first;
        high -= snap->first + (ptrdiff_t)snap->count - 1;
    }
    return (index_range){low, high + 1};
}

/// After k levels point i lies at i / 2^k - centre (1 - 1 / 2^k), so the first is the smallest i >= centre (2^k - 1).
index_range plan_between_ends(const refine_kernel *kernel, size_t levels, size_t count)
{
    ptrdiff_t doubled = doubled_centre(kernel) * (((ptrdiff_t)1 << levels) - 1);
    ptrdiff_t begin = (doubled + (doubled & 1)) / 2;
    ptrdiff_t length = (ptrdiff_t)(count - 1) << levels;
    return (index_range){begin, begin + length + ((doubled & 1) == 0 ? 1 : 0)};
}

/// The most levels: sizes must bear a shift by them.
static const int MAX_LEVELS = SIZE_MAX > UINT32_MAX ? CASCADE_MOST_LEVELS : 31;

bool plan_has_room(const refine_kernel *kernel, size_t count, size_t levels, size_t limit)
{
    size_t support = (size_t)abs(kernel->first) + (size_t)abs(kernel->last);
    size_t most = (size_t)PTRDIFF_MAX / 8 / sizeof(double) / kernel->dim;
    return levels <= MAX_LEVELS && count <= limit >> levels && count <= SIZE_MAX - support &&
           count + support <= most >> levels;
}

static bat_status lay_out(const refine_kernel *kernel, const bat_curve *coarse, refine_plan *plan, bat_error *error)
{
    const bat_curve_refine_options *options = &plan->options;
    size_t count = coarse->count, levels = options->levels;
    if (!plan_has_room(kernel, count, levels, options->max_points))
        return ERROR_TOO_LARGE(error, "%zu points refined %zu times are too many points (limit %zu)", count, levels,
                               options->max_points);
    plan->points = (index_range){0, (ptrdiff_t)(count << levels)};
    if (!coarse->closed && options->ends == BAT_CURVE_END_RULE_FREE)
        plan->points = free_range(kernel, &plan->snap, levels, count);
    else if (!coarse->closed)
    {
        plan->points = plan_between_ends(kernel, levels, count);
        plan->ends_added = levels > 0 && (doubled_centre(kernel) & 1) != 0;
    }
    ptrdiff_t length = plan->points.end - plan->points.begin;
    if (length < 1)
        return ERROR_ARGUMENT(error, "nothing is left of %zu points after %zu levels without a rule for the ends", count,
                              levels);
    plan->count = (size_t)length + (plan->ends_added ? 2 : 0);
    if (plan->count > options->max_points)
        return ERROR_TOO_LARGE(error, "the refined curve has %zu points, more than %zu", plan->count, options->max_points);
    return BAT_OK;
}

bat_status refine_plan_make(const bat_curve *coarse, const bat_curve_refine_options *options, refine_plan *plan,
                            bat_error *error)
{
    *plan = (refine_plan){.options = options != NULL ? *options : bat_curve_refine_defaults()};
    bat_status status = bat_options_check(&bat_curve_refine_fields, &plan->options, error);
    if (status != BAT_OK)
        return status;
    if (plan->options.scheme.kind == BAT_CURVE_SCHEME_KIND_AUTO)
        plan->options.scheme = bat_curve_scheme_for(coarse->space, NULL);
    plan->options.scheme = scheme_in_space(&plan->options.scheme, coarse->space);
    status = check_space(coarse->space, &plan->options, error);
    if (status == BAT_OK)
        status = bat_curve_check(coarse, error);
    if (status == BAT_OK && plan->options.snap)
        status = bat_mask_limit_stencil(&plan->options.scheme.mask, &plan->snap, error);
    if (status != BAT_OK)
        return status;
    refine_kernel kernel = scheme_kernel(coarse->space, &plan->options.scheme);
    return lay_out(&kernel, coarse, plan, error);
}
