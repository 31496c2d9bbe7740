#include "base/error.h"
#include "base/option.h"
#include "curve/scheme_kind.h"
#include "space/builtin.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static bat_mask mask_of(const scheme_row *row, const scheme_settings *s)
{
    return row->mask != NULL ? row->mask(s->w)
           : s->order > 0    ? bat_mask_lane_riesenfeld((size_t)s->order)
           : s->r > 0        ? bat_mask_corner_cutting(s->r, s->s)
                             : (bat_mask){0};
}

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
        made.mask = mask_of(row, s);
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
