#include "curve/plan.h"

#include "base/error.h"
#include "base/option.h"
#include "curve/corner.h"
#include "curve/stop.h"
#include "space/known.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/// A larger tension is a mistake.
#define TENSION_LIMIT 1e6

bat_curve_refine_options bat_curve_refine_defaults(void)
{
    return (bat_curve_refine_options){
        .scheme = {.kind = BAT_CURVE_SCHEME_AUTO},
        .levels = 5,
        .ends = BAT_CURVE_END_REFLECT,
        .max_points = BAT_MAX_POINTS,
        .max_levels = STOP_DEFAULT_LEVELS,
    };
}

refine_kernel kernel_for(const bat_space *space, const bat_curve_scheme *scheme)
{
    switch (scheme->kind)
    {
    case BAT_CURVE_SCHEME_ANGLE:
        return scheme->rule != NULL ? kernel_rule(space, scheme) : kernel_angle(space, scheme);
    case BAT_CURVE_SCHEME_LOG_EXP:
        return kernel_log_exp(space, scheme);
    case BAT_CURVE_SCHEME_GEODESIC:
        return kernel_geodesic(space, scheme);
    case BAT_CURVE_SCHEME_FOUR_POINT:
        return kernel_four_point(space, 0, scheme);
    case BAT_CURVE_SCHEME_CATMULL_ROM:
    case BAT_CURVE_SCHEME_CUBIC:
        return kernel_of_spline(space);
    case BAT_CURVE_SCHEME_LINEAR:
    case BAT_CURVE_SCHEME_AUTO:
    default:
        return kernel_linear(scheme, space->point_dim);
    }
}

/// Whether weights sum to 1 for every new point, as those of a mean do.
static bool is_affine(const bat_mask *mask)
{
    const double tolerance = 1e-9;
    double sums[2] = {0, 0};
    for (size_t k = 0; k < mask->count; k++)
        sums[(mask->first + (int)k) & 1] += mask->coefficients[k];
    return fabs(sums[0] - 1) <= tolerance && fabs(sums[1] - 1) <= tolerance;
}

static bat_status check_mask(const bat_mask *mask, bool affine, bat_error *error)
{
    bat_status status = mask_check(mask, error);
    if (status == BAT_OK)
        status = mask_check_place(mask, error);
    if (status != BAT_OK)
        return status;
    if (mask_trimmed(mask).count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "all coefficients of the mask are zero");
    if (affine && !is_affine(mask))
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "a log-exp scheme needs a mask that sums to 1 over its even indices and over its odd ones");
    return BAT_OK;
}

static bat_status check_geodesic(const bat_mask *mask, bat_error *error)
{
    bat_status status = check_mask(mask, false, error);
    if (status != BAT_OK)
        return status;
    return kernel_has_geodesic(mask) ? BAT_OK
                                     : error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                                                 "a geodesic scheme needs a Lane-Riesenfeld or corner-cutting mask");
}

static bat_status check_rule(const bat_curve_angle_rule *rule, bat_error *error)
{
    if (rule == NULL || (rule->angles != NULL && rule->reach >= 1 && rule->reach <= BAT_CURVE_ANGLE_RULE_REACH &&
                         rule->scratch_size <= SIZE_MAX / 2))
        return BAT_OK;
    return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                     "an angle rule needs a function, a reach from 1 to %d and scratch memory of a size that can be had",
                     BAT_CURVE_ANGLE_RULE_REACH);
}

bat_status bat_curve_scheme_check(const bat_curve_scheme *scheme, bat_error *error)
{
    static const option_field KIND[] = {
        OPTION_FIELD(bat_curve_scheme, kind, OPTION_CHOICE, 0, BAT_CURVE_SCHEME_CUBIC),
    };
    static const option_field ANGLE[] = {
        OPTION_FIELD(bat_curve_scheme, tension, OPTION_NUMBER, -TENSION_LIMIT, TENSION_LIMIT),
        OPTION_FIELD(bat_curve_scheme, sign, OPTION_CHOICE, 0, BAT_CURVE_ANGLE_PRINTED),
        OPTION_FIELD(bat_curve_scheme, fairness, OPTION_NUMBER, 0, 1),
    };
    static const option_field LOG_EXP[] = {
        OPTION_FIELD(bat_curve_scheme, base, OPTION_CHOICE, 0, BAT_CURVE_BASE_MIDPOINT),
    };
    static const option_field FOUR_POINT[] = {
        OPTION_FIELD(bat_curve_scheme, tension, OPTION_NUMBER, -TENSION_LIMIT, TENSION_LIMIT),
        OPTION_FIELD(bat_curve_scheme, base, OPTION_CHOICE, 0, BAT_CURVE_BASE_MIDPOINT),
    };
    static const option_field PARAMETRIC[] = {
        OPTION_FIELD(bat_curve_scheme, parameters, OPTION_CHOICE, 0, BAT_CURVE_PARAMETERS_CHORDAL),
    };
    bat_status status = OPTIONS_CHECK(scheme, KIND, error);
    if (status != BAT_OK)
        return status;
    switch (scheme->kind)
    {
    case BAT_CURVE_SCHEME_LINEAR:
        return check_mask(&scheme->mask, false, error);
    case BAT_CURVE_SCHEME_ANGLE:
        status = OPTIONS_CHECK(scheme, ANGLE, error);
        return status == BAT_OK ? check_rule(scheme->rule, error) : status;
    case BAT_CURVE_SCHEME_LOG_EXP:
        status = OPTIONS_CHECK(scheme, LOG_EXP, error);
        return status == BAT_OK ? check_mask(&scheme->mask, true, error) : status;
    case BAT_CURVE_SCHEME_GEODESIC:
        return check_geodesic(&scheme->mask, error);
    case BAT_CURVE_SCHEME_FOUR_POINT:
        status = OPTIONS_CHECK(scheme, FOUR_POINT, error);
        return status == BAT_OK ? OPTIONS_CHECK(scheme, PARAMETRIC, error) : status;
    case BAT_CURVE_SCHEME_CATMULL_ROM:
    case BAT_CURVE_SCHEME_CUBIC:
        return OPTIONS_CHECK(scheme, PARAMETRIC, error);
    case BAT_CURVE_SCHEME_AUTO:
        break;
    }
    return BAT_OK;
}

bat_status bat_curve_refine_options_check(const bat_curve_refine_options *options, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_curve_refine_options, levels, OPTION_SIZE, 0, CASCADE_MOST_LEVELS),
        OPTION_FIELD(bat_curve_refine_options, ends, OPTION_CHOICE, 0, BAT_CURVE_END_FREE),
        OPTION_FIELD(bat_curve_refine_options, max_points, OPTION_SIZE, 1, INFINITY),
        OPTION_FIELD(bat_curve_refine_options, simple, OPTION_CHOICE, 0, BAT_CURVE_SIMPLE_NEVER),
        OPTION_THREADS(bat_curve_refine_options),
        OPTION_FIELD(bat_curve_refine_options, corner_angle, OPTION_NUMBER, 0, CORNER_ANGLE_LIMIT),
        OPTION_FIELD(bat_curve_refine_options, max_segment, OPTION_NUMBER, 0, INFINITY),
        OPTION_FIELD(bat_curve_refine_options, tolerance, OPTION_NUMBER, 0, INFINITY),
        OPTION_FIELD(bat_curve_refine_options, max_levels, OPTION_SIZE, 0, STOP_MOST_LEVELS),
        OPTION_FIELD(bat_curve_refine_options, first_level, OPTION_SIZE, 0, CASCADE_MOST_LEVELS),
    };
    if (options == NULL)
        return BAT_OK;
    bat_status status = OPTIONS_CHECK(options, FIELDS, error);
    return status == BAT_OK ? bat_curve_scheme_check(&options->scheme, error) : status;
}

/// Whether a rule is made for a space.
static bat_status check_rule_space(const bat_space *space, const bat_curve_angle_rule *rule, bat_error *error)
{
    const char *fault = rule->fault != NULL ? rule->fault(rule, space) : NULL;
    return fault == NULL ? BAT_OK
                         : error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "the rule %s is not made for this %s: %s",
                                     rule->name, space->name, fault);
}

/// Whether a checked scheme has a meaning in a space, with the other options.
static bat_status check_space(const bat_space *space, const bat_curve_refine_options *options, bat_error *error)
{
    const bat_curve_scheme *scheme = &options->scheme;
    int curvature;
    if (options->simple == BAT_CURVE_SIMPLE_ALWAYS && !space_is_surface(space, &curvature))
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "curves cross only in surfaces (plane, sphere in R^3, disk), not in the %s of dimension %zu",
                         space->name, space->dimension);
    if (scheme->kind != BAT_CURVE_SCHEME_LINEAR && (options->snap || options->ends == BAT_CURVE_END_FREE))
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "only linear schemes can %s",
                         options->snap ? "be moved to their limit" : "leave the ends free");
    if (scheme->kind == BAT_CURVE_SCHEME_LINEAR && !space_is_euclidean(space))
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "a linear scheme needs a Euclidean space, not the %s; try angle-4 or log-exp-4, or cut corners by "
                         "chaikin or lane-riesenfeld",
                         space->name);
    if (scheme->kind != BAT_CURVE_SCHEME_ANGLE)
        return BAT_OK;
    if (space->exterior_angle == NULL || space->apex == NULL)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "an angle-based scheme needs an oriented surface (plane, sphere in R^3, disk), not the %s of "
                         "dimension %zu; try log-exp-4",
                         space->name, space->dimension);
    return scheme->rule != NULL ? check_rule_space(space, scheme->rule, error) : BAT_OK;
}

/// A mask has a vertex where its centre is whole: new point i lies at (i - centre) / 2 in units of old indices. `first` and
/// `last` sum to twice the centre.
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
enum
{
    MOST_LEVELS = SIZE_MAX > UINT32_MAX ? CASCADE_MOST_LEVELS : 31
};

bool plan_has_room(const refine_kernel *kernel, size_t count, size_t levels, size_t limit)
{
    size_t support = (size_t)abs(kernel->first) + (size_t)abs(kernel->last);
    size_t most = (size_t)PTRDIFF_MAX / 8 / sizeof(double) / kernel->dim;
    return levels <= MOST_LEVELS && count <= limit >> levels && count <= SIZE_MAX - support &&
           count + support <= most >> levels;
}

static bat_status lay_out(const refine_kernel *kernel, const bat_curve *coarse, refine_plan *plan, bat_error *error)
{
    const bat_curve_refine_options *options = &plan->options;
    size_t count = coarse->count, levels = options->levels;
    if (!plan_has_room(kernel, count, levels, options->max_points))
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0,
                         "%zu points refined %zu times are too many points (limit %zu)", count, levels, options->max_points);
    plan->points = (index_range){0, (ptrdiff_t)(count << levels)};
    if (!coarse->closed && options->ends == BAT_CURVE_END_FREE)
        plan->points = free_range(kernel, &plan->snap, levels, count);
    else if (!coarse->closed)
    {
        plan->points = plan_between_ends(kernel, levels, count);
        plan->ends_added = levels > 0 && (doubled_centre(kernel) & 1) != 0;
    }
    ptrdiff_t length = plan->points.end - plan->points.begin;
    if (length < 1)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "nothing is left of %zu points after %zu levels without a rule for the ends", count, levels);
    plan->count = (size_t)length + (plan->ends_added ? 2 : 0);
    if (plan->count > options->max_points)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the refined curve has %zu points, more than %zu",
                         plan->count, options->max_points);
    return BAT_OK;
}

bat_status refine_plan_make(const bat_curve *coarse, const bat_curve_refine_options *options, refine_plan *plan,
                            bat_error *error)
{
    *plan = (refine_plan){.options = options != NULL ? *options : bat_curve_refine_defaults()};
    bat_status status = bat_curve_refine_options_check(&plan->options, error);
    if (status != BAT_OK)
        return status;
    if (plan->options.scheme.kind == BAT_CURVE_SCHEME_AUTO)
        plan->options.scheme = bat_curve_scheme_for(coarse->space, NULL);
    bat_curve_scheme *scheme = &plan->options.scheme;
    if (scheme->kind == BAT_CURVE_SCHEME_LINEAR && !space_is_euclidean(coarse->space) && kernel_has_geodesic(&scheme->mask))
        scheme->kind = BAT_CURVE_SCHEME_GEODESIC;
    status = check_space(coarse->space, &plan->options, error);
    if (status == BAT_OK)
        status = bat_curve_check(coarse, error);
    if (status == BAT_OK && plan->options.snap)
        status = bat_mask_limit_stencil(&plan->options.scheme.mask, &plan->snap, error);
    if (status != BAT_OK)
        return status;
    refine_kernel kernel = kernel_for(coarse->space, &plan->options.scheme);
    return lay_out(&kernel, coarse, plan, error);
}
