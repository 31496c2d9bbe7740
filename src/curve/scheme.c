#include "curve/scheme_kind.h"

#include "base/error.h"
#include "base/option.h"
#include "space/builtin.h"

/// @file
/// The kinds of schemes, and schemes of each.

/// A larger tension is a mistake.
#define TENSION_LIMIT 1e6

bat_curve_scheme bat_curve_scheme_linear(bat_mask mask)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_KIND_LINEAR, .mask = mask};
}

bat_curve_scheme bat_curve_scheme_angle(double mu)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_KIND_ANGLE, .tension = mu};
}

bat_curve_scheme bat_curve_scheme_angle_rule(const bat_curve_angle_rule *rule)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_KIND_ANGLE, .rule = rule};
}

bat_curve_scheme bat_curve_scheme_log_exp(bat_mask mask)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_KIND_LOG_EXP, .mask = mask};
}

bat_curve_scheme bat_curve_scheme_geodesic(size_t order)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_KIND_GEODESIC, .mask = bat_mask_lane_riesenfeld(order)};
}

bat_curve_scheme bat_curve_scheme_four_point(bat_curve_parameters parameters, double w)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_KIND_FOUR_POINT, .parameters = parameters, .tension = w};
}

static const bat_choice SIGNS[] = {
    CHOICE("outward", "exact on circles of the plane", BAT_CURVE_ANGLE_SIGN_OUTWARD),
    CHOICE("printed", "inwards, as the paper has it", BAT_CURVE_ANGLE_SIGN_PRINTED),
};
const bat_family bat_curve_angle_sign_family = FAMILY("sign", SIGNS);

static const bat_choice BASES[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "the vertex", BAT_CURVE_BASE_AUTO),
    CHOICE("vertex", "the vertex that begins the edge", BAT_CURVE_BASE_VERTEX),
    CHOICE("midpoint", "the midpoint of the edge", BAT_CURVE_BASE_MIDPOINT),
};
const bat_family bat_curve_base_family = FAMILY("base", BASES);

static const bat_choice PARAMETERS[] = {
    CHOICE("uniform", "equal increments", BAT_CURVE_PARAMETERS_UNIFORM),
    CHOICE("centripetal", "square roots of lengths", BAT_CURVE_PARAMETERS_CENTRIPETAL),
    CHOICE("chordal", "lengths", BAT_CURVE_PARAMETERS_CHORDAL),
};
const bat_family bat_curve_parameters_family = FAMILY("kind of parameters", PARAMETERS);

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
        return ERROR_ARGUMENT(error, "all coefficients of the mask are zero");
    if (affine && !is_affine(mask))
        return ERROR_UNSUPPORTED(error, 0,
                                 "a log-exp scheme needs a mask that sums to 1 over its even indices and over its odd ones");
    return BAT_OK;
}

static bat_status check_linear(const bat_curve_scheme *scheme, bat_error *error)
{
    return check_mask(&scheme->mask, false, error);
}

static bat_status check_geodesic(const bat_curve_scheme *scheme, bat_error *error)
{
    bat_status status = check_linear(scheme, error);
    if (status != BAT_OK)
        return status;
    return kernel_has_geodesic(&scheme->mask)
               ? BAT_OK
               : ERROR_UNSUPPORTED(error, 0, "a geodesic scheme needs a Lane-Riesenfeld or corner-cutting mask");
}

static bat_status check_rule(const bat_curve_angle_rule *rule, bat_error *error)
{
    if (rule == NULL || (rule->angles != NULL && rule->reach >= 1 && rule->reach <= BAT_CURVE_ANGLE_RULE_REACH &&
                         rule->scratch_size <= SIZE_MAX / 2))
        return BAT_OK;
    return ERROR_ARGUMENT(
        error, "an angle rule needs a function, a reach from 1 to %d and scratch memory of a size that can be had",
        BAT_CURVE_ANGLE_RULE_REACH);
}

static bat_status check_angle(const bat_curve_scheme *scheme, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_curve_scheme, tension, OPTION_NUMBER, -TENSION_LIMIT, TENSION_LIMIT),
        OPTION_FAMILY(bat_curve_scheme, sign, bat_curve_angle_sign_family),
        OPTION_FIELD(bat_curve_scheme, fairness, OPTION_NUMBER, 0, 1),
    };
    bat_status status = OPTIONS_CHECK(scheme, FIELDS, error);
    return status == BAT_OK ? check_rule(scheme->rule, error) : status;
}

static bat_status check_log_exp(const bat_curve_scheme *scheme, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FAMILY(bat_curve_scheme, base, bat_curve_base_family),
    };
    bat_status status = OPTIONS_CHECK(scheme, FIELDS, error);
    return status == BAT_OK ? check_mask(&scheme->mask, true, error) : status;
}

static bat_status check_four_point(const bat_curve_scheme *scheme, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_curve_scheme, tension, OPTION_NUMBER, -TENSION_LIMIT, TENSION_LIMIT),
        OPTION_FAMILY(bat_curve_scheme, base, bat_curve_base_family),
        OPTION_FAMILY(bat_curve_scheme, parameters, bat_curve_parameters_family),
    };
    return OPTIONS_CHECK(scheme, FIELDS, error);
}

static bat_status check_spline(const bat_curve_scheme *scheme, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FAMILY(bat_curve_scheme, parameters, bat_curve_parameters_family),
    };
    const scheme_row *row = (const scheme_row *)(const void *)scheme->spline;
    if (row == NULL || row->form == NULL)
        return ERROR_ARGUMENT(error, "spline is no row of a spline: bat_curve_scheme_by_name() sets it");
    return OPTIONS_CHECK(scheme, FIELDS, error);
}

static bat_status suits_linear(const bat_curve_scheme *scheme BAT_UNUSED, const bat_space *space, bat_error *error)
{
    if (space_is_euclidean(space))
        return BAT_OK;
    return ERROR_UNSUPPORTED(
        error, 0,
        "a linear scheme needs a Euclidean space, not the %s; try angle-4 or log-exp-4, or cut corners by "
        "chaikin or lane-riesenfeld",
        space->name);
}

static bat_status suits_angle(const bat_curve_scheme *scheme, const bat_space *space, bat_error *error)
{
    if (space->exterior_angle == NULL || space->apex == NULL)
        return ERROR_UNSUPPORTED(
            error, 0,
            "an angle-based scheme needs an oriented surface (plane, sphere in R^3, disk), not the %s of "
            "dimension %zu; try log-exp-4",
            space->name, space->dimension);
    const bat_curve_angle_rule *rule = scheme->rule;
    const char *fault = rule != NULL && rule->fault != NULL ? rule->fault(rule, space) : NULL;
    if (fault != NULL)
        return ERROR_UNSUPPORTED(error, 0, "the rule %s is not made for this %s: %s", rule->name, space->name, fault);
    return BAT_OK;
}

bool scheme_keeps_points(const bat_curve_scheme *scheme)
{
    return !scheme_kind_of(scheme)->by_mask || mask_is_interpolatory(&scheme->mask);
}

polygon_end scheme_end(const bat_curve_scheme *scheme)
{
    return scheme->kind == BAT_CURVE_SCHEME_KIND_ANGLE ? POLYGON_END_MIRROR
           : mask_is_interpolatory(&scheme->mask)      ? POLYGON_END_CUBIC
                                                       : POLYGON_END_LINE;
}

bat_curve_scheme scheme_of_channels(const bat_curve_scheme *scheme)
{
    return bat_curve_scheme_linear(
        scheme->kind == BAT_CURVE_SCHEME_KIND_ANGLE ? bat_mask_four_point(BAT_MASK_FOUR_POINT_WEIGHT) : scheme->mask);
}

static refine_kernel linear_kernel(const bat_space *space, const bat_curve_scheme *scheme)
{
    return kernel_linear(scheme, space->point_dim);
}

static refine_kernel angle_kernel(const bat_space *space, const bat_curve_scheme *scheme)
{
    return scheme->rule != NULL ? kernel_rule(space, scheme) : kernel_angle(space, scheme);
}

static refine_kernel four_point_kernel(const bat_space *space, const bat_curve_scheme *scheme)
{
    return kernel_four_point(space, 0, scheme);
}

static const scheme_kind KINDS[] = {
    {.choice = CHOICE("auto", "that of the space", BAT_CURVE_SCHEME_KIND_AUTO), .kernel = linear_kernel},
    {.choice = CHOICE("linear", "a mask on coordinates", BAT_CURVE_SCHEME_KIND_LINEAR),
     .linear = true,
     .check = check_linear,
     .suits = suits_linear,
     .by_mask = true,
     .kernel = linear_kernel},
    {.choice = CHOICE("angle", "vertices over edges by exterior angles", BAT_CURVE_SCHEME_KIND_ANGLE),
     .check = check_angle,
     .suits = suits_angle,
     .kernel = angle_kernel},
    {.choice = CHOICE("log-exp", "a mask in tangent spaces", BAT_CURVE_SCHEME_KIND_LOG_EXP),
     .check = check_log_exp,
     .by_mask = true,
     .kernel = kernel_log_exp},
    {.choice = CHOICE("geodesic", "averages along geodesics", BAT_CURVE_SCHEME_KIND_GEODESIC),
     .check = check_geodesic,
     .by_mask = true,
     .kernel = kernel_geodesic},
    {.choice = CHOICE("four-point", "the cubic through four points at their parameters", BAT_CURVE_SCHEME_KIND_FOUR_POINT),
     .beside_channels = true,
     .check = check_four_point,
     .kernel = four_point_kernel},
    {.choice = CHOICE("spline", "a spline through the points", BAT_CURVE_SCHEME_KIND_SPLINE), .check = check_spline},
};
const bat_family bat_curve_scheme_kind_family = FAMILY("kind of schemes", KINDS);

const scheme_kind *scheme_kind_of(const bat_curve_scheme *scheme)
{
    return (const scheme_kind *)(const void *)choice_of_value(&bat_curve_scheme_kind_family, (int)scheme->kind);
}

refine_kernel scheme_kernel(const bat_space *space, const bat_curve_scheme *scheme)
{
    const scheme_kind *kind = scheme_kind_of(scheme);
    return kind->kernel != NULL ? kind->kernel(space, scheme)
                                : (refine_kernel){.space = space, .dim = space->point_dim, .first = -3, .last = 3};
}

size_t scheme_decided_levels(const bat_curve_scheme *scheme)
{
    bool is_rule = scheme->kind == BAT_CURVE_SCHEME_KIND_ANGLE && scheme->rule != NULL;
    return is_rule ? scheme->rule->levels : 0;
}

bool scheme_needs_whole_polygons(const bat_curve_scheme *scheme)
{
    return scheme->kind == BAT_CURVE_SCHEME_KIND_ANGLE &&
           (scheme->rule != NULL ? scheme->rule->wants_mean_length : scheme->adaptive);
}

bat_curve_scheme scheme_in_space(const bat_curve_scheme *scheme, const bat_space *space)
{
    bat_curve_scheme made = *scheme;
    if (made.kind == BAT_CURVE_SCHEME_KIND_LINEAR && !space_is_euclidean(space) && kernel_has_geodesic(&made.mask))
        made.kind = BAT_CURVE_SCHEME_KIND_GEODESIC;
    return made;
}

bat_status bat_curve_scheme_check(const bat_curve_scheme *scheme, bat_error *error)
{
    static const option_field KIND[] = {
        OPTION_FAMILY(bat_curve_scheme, kind, bat_curve_scheme_kind_family),
    };
    bat_status status = OPTIONS_CHECK(scheme, KIND, error);
    bool checked = status != BAT_OK || scheme_kind_of(scheme)->check == NULL;
    return checked ? status : scheme_kind_of(scheme)->check(scheme, error);
}
