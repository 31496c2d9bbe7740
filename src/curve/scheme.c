#include "curve/scheme_kind.h"

#include "base/error.h"
#include "base/option.h"
#include "space/builtin.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

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

static bat_status check_angle(const bat_curve_scheme *scheme, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_curve_scheme, tension, OPTION_NUMBER, -TENSION_LIMIT, TENSION_LIMIT),
        OPTION_FAMILY(bat_curve_scheme, sign, bat_curve_angle_sign_family),
        OPTION_FIELD(bat_curve_scheme, fairness, OPTION_NUMBER, 0, 1),
    };
    const bat_curve_angle_rule *rule = scheme->rule;
    bat_status status = OPTIONS_CHECK(scheme, FIELDS, error);
    if (status != BAT_OK || rule == NULL ||
        (rule->angles != NULL && rule->reach >= 1 && rule->reach <= BAT_CURVE_ANGLE_RULE_REACH &&
         rule->scratch_size <= SIZE_MAX / 2))
        return status;
    return ERROR_ARGUMENT(
        error, "an angle rule needs a function, a reach from 1 to %d and scratch memory of a size that can be had",
        BAT_CURVE_ANGLE_RULE_REACH);
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

// Schemes by name

static bat_curve_scheme make(const scheme_row *row, const scheme_settings *s)
{
    bat_curve_scheme made = {.kind = row->kind,
                             .tension = s->mu,
                             .sign = s->sign,
                             .adaptive = s->adaptive,
                             .turns = s->turns,
                             .base = s->base,
                             .parameters = s->parameters,
                             .spline = row->form != NULL ? &row->choice : NULL};
    if (row->kind == BAT_CURVE_SCHEME_KIND_AUTO)
        return bat_curve_scheme_learned(s->fairness);
    if (row->form == NULL && s->parameters != BAT_CURVE_PARAMETERS_UNIFORM)
    {
        made.kind = BAT_CURVE_SCHEME_KIND_FOUR_POINT;
        made.tension = s->w;
    }
    else
        made.mask = row->mask != NULL ? row->mask(s->w)
                    : s->order > 0    ? bat_mask_lane_riesenfeld((size_t)s->order)
                    : s->r > 0        ? bat_mask_corner_cutting(s->r, s->s)
                                      : (bat_mask){0};
    return made;
}

static bat_status check_cuts(const scheme_settings *s, bat_error *error)
{
    if (0 < s->r && s->r < s->s && s->s < 1)
        return BAT_OK;
    return ERROR_ARGUMENT(error, "corner cutting needs 0 < r < s < 1, not r = %g, s = %g", s->r, s->s);
}

static bat_status check_order(const scheme_settings *s, bat_error *error)
{
    static const option_field ORDER[] = {OPTION_FIELD(scheme_settings, order, OPTION_NUMBER, 1, BAT_MASK_MAX - 2)};
    if (s->order != floor(s->order))
        return error_option(error, "order", "is %.10g, but must be a whole number", s->order);
    return OPTIONS_CHECK(s, ORDER, error);
}

static const scheme_row ROWS[] = {
    {.choice = {.name = "chaikin",
                .summary = "corner cutting at 1/4 and 3/4, the quadratic B-spline; any space, by geodesics"},
     .defaults = {.r = 0.25, .s = 0.75},
     .kind = BAT_CURVE_SCHEME_KIND_LINEAR},
    {.choice = CHOICE_SET("corner-cutting", "r=0.25,s=0.75", "corner cutting at r and s; any space, by geodesics"),
     .defaults = {.r = 0.25, .s = 0.75},
     .check = check_cuts,
     .kind = BAT_CURVE_SCHEME_KIND_LINEAR},
    {.choice = CHOICE_SET("four-point", "w=0.0625,parameters=uniform", "interpolates, C1, reproduces cubics; R^n"),
     .defaults = {.w = BAT_MASK_FOUR_POINT_WEIGHT},
     .kind = BAT_CURVE_SCHEME_KIND_LINEAR,
     .mask = bat_mask_four_point},
    {.choice = CHOICE_SET("six-point", "w=0.01171875", "interpolates, C2, reproduces quintics; R^n"),
     .defaults = {.w = BAT_MASK_SIX_POINT_WEIGHT},
     .kind = BAT_CURVE_SCHEME_KIND_LINEAR,
     .mask = bat_mask_six_point},
    {.choice = CHOICE_SET("lane-riesenfeld", "order=3", "the B-spline of degree `order`; any space, by geodesics"),
     .defaults = {.order = 3},
     .check = check_order,
     .kind = BAT_CURVE_SCHEME_KIND_LINEAR},
    {.choice = CHOICE_SET("mask", "a,b,c,…@first", "any mask, coefficients as numbers or fractions; R^n")},
    {.choice = CHOICE_SET("angle-4", "sign=outward,adaptive=0,turns=0",
                          "interpolates by exterior angles, tension 0; plane, sphere, disk"),
     .kind = BAT_CURVE_SCHEME_KIND_ANGLE},
    {.choice = CHOICE_SET("angle-6", "sign=outward,adaptive=0,turns=0",
                          "interpolates by exterior angles, tension -1/4; plane, sphere, disk"),
     .defaults = {.mu = BAT_CURVE_TENSION_SIX_POINT},
     .kind = BAT_CURVE_SCHEME_KIND_ANGLE},
    {.choice = CHOICE_SET("angle", "mu=0,sign=outward,adaptive=0,turns=0",
                          "interpolates by exterior angles, any tension; plane, sphere, disk"),
     .kind = BAT_CURVE_SCHEME_KIND_ANGLE},
    {.choice = CHOICE_SET("log-exp-4", "w=0.0625,base=vertex,parameters=uniform",
                          "the four-point scheme in tangent spaces; any space"),
     .defaults = {.w = BAT_MASK_FOUR_POINT_WEIGHT},
     .kind = BAT_CURVE_SCHEME_KIND_LOG_EXP,
     .mask = bat_mask_four_point},
    {.choice = CHOICE_SET("log-exp-6", "w=0.01171875,base=vertex", "the six-point scheme in tangent spaces; any space"),
     .defaults = {.w = BAT_MASK_SIX_POINT_WEIGHT},
     .kind = BAT_CURVE_SCHEME_KIND_LOG_EXP,
     .mask = bat_mask_six_point},
    {.choice = CHOICE_SET("log-exp-lane-riesenfeld", "order=3,base=vertex",
                          "the B-spline of degree `order` in tangent spaces; any space"),
     .defaults = {.order = 3},
     .check = check_order,
     .kind = BAT_CURVE_SCHEME_KIND_LOG_EXP},
    {.choice = CHOICE_SET("geodesic", "order=3", "Lane-Riesenfeld by midpoints of geodesics; any space"),
     .defaults = {.order = 3},
     .check = check_order,
     .kind = BAT_CURVE_SCHEME_KIND_GEODESIC},
    {.choice = CHOICE_SET("catmull-rom", "parameters=centripetal", "interpolates by a C1 spline of local cubics; any space"),
     .defaults = {.parameters = BAT_CURVE_PARAMETERS_CENTRIPETAL},
     .kind = BAT_CURVE_SCHEME_KIND_SPLINE,
     .form = &spline_catmull_rom},
    {.choice = CHOICE_SET("cubic", "parameters=chordal", "interpolates by the cubic spline, C2 in R^n; any space"),
     .defaults = {.parameters = BAT_CURVE_PARAMETERS_CHORDAL},
     .kind = BAT_CURVE_SCHEME_KIND_SPLINE,
     .form = &spline_cubic},
    {.choice = CHOICE_SET("quintic", "parameters=chordal", "interpolates by a quintic Hermite spline, C2 in R^n; any space"),
     .defaults = {.parameters = BAT_CURVE_PARAMETERS_CHORDAL},
     .kind = BAT_CURVE_SCHEME_KIND_SPLINE,
     .form = &spline_quintic},
    {.choice = CHOICE_SET("learned", "fairness=0.25",
                          "interpolates by a network, from nearest (0) to smoothest (1); plane, sphere, disk"),
     .defaults = {.fairness = 0.25}},
};
const bat_family bat_curve_scheme_family = FAMILY("scheme", ROWS);

/// "1/4,3/4,3/4,1/4@-2"
static bat_status read_mask(const char *text, bat_curve_scheme *scheme, bat_error *error)
{
    bat_mask mask = {.count = 0};
    const char *at = text;
    do
    {
        double value;
        if (mask.count == BAT_MASK_MAX)
            return ERROR_ARGUMENT(error, "a mask has at most %d coefficients", BAT_MASK_MAX);
        if (!settings_number(&at, &value))
            return error_set(error, BAT_INVALID_ARGUMENT, mask.count, 0, "coefficient %zu of the mask '%s' is not a number",
                             mask.count, text);
        mask.coefficients[mask.count++] = value;
    } while (*at == ',' && at++);
    mask.first = -(int)(mask.count / 2);
    if (*at == '@')
    {
        char *end;
        errno = 0;
        long first = strtol(at + 1, &end, 10);
        if (end == at + 1 || *end != '\0' || errno != 0 || labs(first) > BAT_MASK_MAX)
            return ERROR_ARGUMENT(error, "the first index in the mask '%s' is not a whole number within %d of 0", text,
                                  BAT_MASK_MAX);
        mask.first = (int)first;
        at = end;
    }
    if (*at != '\0')
        return ERROR_ARGUMENT(error, "'%s' does not belong in a mask", at);
    bat_status status = mask_check_place(&mask, error);
    if (status != BAT_OK)
        return status;
    *scheme = bat_curve_scheme_linear(mask);
    return BAT_OK;
}

bat_status bat_curve_scheme_by_name(const char *name, bat_curve_scheme *scheme, bat_error *error)
{
#define SETTING(key, kind, family)                                                                                          \
    {                                                                                                                       \
#key, kind, offsetof(scheme_settings, key), family                                                                  \
    }
    static const setting SETTINGS[] = {
        SETTING(w, SETTING_NUMBER, NULL),
        SETTING(r, SETTING_NUMBER, NULL),
        SETTING(s, SETTING_NUMBER, NULL),
        SETTING(mu, SETTING_NUMBER, NULL),
        SETTING(order, SETTING_NUMBER, NULL),
        SETTING(fairness, SETTING_NUMBER, NULL),
        SETTING(adaptive, SETTING_FLAG, NULL),
        SETTING(turns, SETTING_FLAG, NULL),
        SETTING(sign, SETTING_CHOICE, &bat_curve_angle_sign_family),
        SETTING(base, SETTING_CHOICE, &bat_curve_base_family),
        SETTING(parameters, SETTING_CHOICE, &bat_curve_parameters_family),
    };
    size_t length = strcspn(name, ":");
    const char *text = name[length] == ':' ? name + length + 1 : name + length;
    const scheme_row *row = (const scheme_row *)(const void *)choice_find(&bat_curve_scheme_family, name, length);
    if (row == NULL)
        return ERROR_ARGUMENT(error, "there is no scheme '%.*s'; `batten list schemes` names them", (int)length, name);
    if (strcmp(row->choice.name, "mask") == 0)
        return read_mask(text, scheme, error);
    scheme_settings s = row->defaults;
    bat_status status = settings_read(&row->choice, text, SETTINGS, sizeof SETTINGS / sizeof *SETTINGS, &s, error);
    if (status == BAT_OK && row->check != NULL)
        status = row->check(&s, error);
    if (status != BAT_OK)
        return status;
    bat_curve_scheme made = make(row, &s);
    status = bat_curve_scheme_check(&made, error);
    if (status == BAT_OK)
        *scheme = made;
    return status;
}

bat_curve_scheme bat_curve_scheme_for(const bat_space *space, const char **name)
{
    int curvature;
    const char *chosen = space_is_euclidean(space) ? "four-point" : "log-exp-4";
    if (space_is_surface(space, &curvature))
        chosen = "learned";
    else if (space->exterior_angle != NULL && space->apex != NULL)
        chosen = "angle-4";
    bat_curve_scheme scheme = {.kind = BAT_CURVE_SCHEME_KIND_AUTO};
    (void)bat_curve_scheme_by_name(chosen, &scheme, NULL);
    if (name != NULL)
        *name = chosen;
    return scheme;
}

static const bat_choice END_RULES[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "point reflection", BAT_CURVE_END_RULE_AUTO),
    CHOICE("reflect", "point reflection in the end point", BAT_CURVE_END_RULE_REFLECT),
    CHOICE("extrapolate", "the extrapolation that keeps what the scheme reproduces", BAT_CURVE_END_RULE_EXTRAPOLATE),
    CHOICE("free", "none: the curve shrinks; linear schemes", BAT_CURVE_END_RULE_FREE),
};
const bat_family bat_curve_end_rule_family = FAMILY("end rule", END_RULES);

static const bat_choice SIMPLE_CHOICES[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "closed curves", BAT_CURVE_SIMPLE_AUTO),
    CHOICE("rings", "closed curves that are simple when they come in", BAT_CURVE_SIMPLE_RINGS),
    CHOICE("always", "open and closed curves that are simple when they come in", BAT_CURVE_SIMPLE_ALWAYS),
    CHOICE("never", "no test", BAT_CURVE_SIMPLE_NEVER),
};
const bat_family bat_curve_simple_family = FAMILY("choice of simple curves", SIMPLE_CHOICES);
