#include "batten/curve.h"
#include "batten/curve_scheme.h"

#include "base/choice.h"
#include "base/error.h"
#include "base/option.h"
#include "curve/mask.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The settings that a scheme's name may carry, with their values before the text is read.
typedef struct settings
{
    double w, r, s, mu, order, fairness;
    bool adaptive, turns;
    bat_curve_angle_sign sign;
    bat_curve_base base;
    bat_curve_parameters parameters;
} settings;

static const bat_choice PARAMETERS[] = {
    {.name = "uniform", .summary = "equal increments", .value = BAT_CURVE_PARAMETERS_UNIFORM},
    {.name = "centripetal", .summary = "square roots of lengths", .value = BAT_CURVE_PARAMETERS_CENTRIPETAL},
    {.name = "chordal", .summary = "lengths", .value = BAT_CURVE_PARAMETERS_CHORDAL},
};
const bat_family bat_curve_parameters_family = FAMILY("kind of parameters", PARAMETERS);

/// One name: what it takes, and how the settings become a scheme.
typedef struct entry
{
    bat_choice choice;
    settings defaults;
    bat_curve_scheme (*make)(const settings *);
} entry;

static bat_curve_scheme make_chaikin(const settings *s)
{
    (void)s;
    return bat_curve_scheme_linear(bat_mask_chaikin());
}

static bat_curve_scheme make_corner_cutting(const settings *s)
{
    return bat_curve_scheme_linear(bat_mask_corner_cutting(s->r, s->s));
}

static bat_curve_scheme make_four_point(const settings *s)
{
    return s->parameters == BAT_CURVE_PARAMETERS_UNIFORM ? bat_curve_scheme_linear(bat_mask_four_point(s->w))
                                                         : bat_curve_scheme_four_point(s->parameters, s->w);
}

static bat_curve_scheme make_six_point(const settings *s)
{
    return bat_curve_scheme_linear(bat_mask_six_point(s->w));
}

static bat_curve_scheme make_lane_riesenfeld(const settings *s)
{
    return bat_curve_scheme_linear(bat_mask_lane_riesenfeld((size_t)s->order));
}

static bat_curve_scheme make_angle(const settings *s)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle(s->mu);
    scheme.sign = s->sign;
    scheme.adaptive = s->adaptive;
    scheme.turns = s->turns;
    return scheme;
}

static bat_curve_scheme make_log_exp_4(const settings *s)
{
    bat_curve_scheme scheme = s->parameters == BAT_CURVE_PARAMETERS_UNIFORM
                                  ? bat_curve_scheme_log_exp(bat_mask_four_point(s->w))
                                  : bat_curve_scheme_four_point(s->parameters, s->w);
    scheme.base = s->base;
    return scheme;
}

static bat_curve_scheme make_log_exp_6(const settings *s)
{
    bat_curve_scheme scheme = bat_curve_scheme_log_exp(bat_mask_six_point(s->w));
    scheme.base = s->base;
    return scheme;
}

static bat_curve_scheme make_log_exp_lane_riesenfeld(const settings *s)
{
    bat_curve_scheme scheme = bat_curve_scheme_log_exp(bat_mask_lane_riesenfeld((size_t)s->order));
    scheme.base = s->base;
    return scheme;
}

static bat_curve_scheme make_geodesic(const settings *s)
{
    return bat_curve_scheme_geodesic((size_t)s->order);
}

static bat_curve_scheme make_catmull_rom(const settings *s)
{
    return bat_curve_scheme_catmull_rom(s->parameters);
}

static bat_curve_scheme make_cubic(const settings *s)
{
    return bat_curve_scheme_cubic(s->parameters);
}

static bat_curve_scheme make_learned(const settings *s)
{
    return bat_curve_scheme_learned(s->fairness);
}

static const entry ENTRIES[] = {
    {{.name = "chaikin", .summary = "corner cutting at 1/4 and 3/4, the quadratic B-spline; any space, by geodesics"},
     {.w = 0},
     make_chaikin},
    {{.name = "corner-cutting",
      .settings = "r=0.25,s=0.75",
      .summary = "corner cutting at r and s; any space, by geodesics"},
     {.r = 0.25, .s = 0.75},
     make_corner_cutting},
    {{.name = "four-point",
      .settings = "w=0.0625,parameters=uniform",
      .summary = "interpolates, C1, reproduces cubics; R^n"},
     {.w = BAT_MASK_FOUR_POINT_WEIGHT},
     make_four_point},
    {{.name = "six-point", .settings = "w=0.01171875", .summary = "interpolates, C2, reproduces quintics; R^n"},
     {.w = BAT_MASK_SIX_POINT_WEIGHT},
     make_six_point},
    {{.name = "lane-riesenfeld",
      .settings = "order=3",
      .summary = "the B-spline of degree `order`; any space, by geodesics"},
     {.order = 3},
     make_lane_riesenfeld},
    {{.name = "mask", .settings = "a,b,c,…@first", .summary = "any mask, coefficients as numbers or fractions; R^n"},
     {.w = 0},
     NULL},
    {{.name = "angle-4",
      .settings = "sign=outward,adaptive=0,turns=0",
      .summary = "interpolates by exterior angles, tension 0; plane, sphere, disk"},
     {.mu = 0},
     make_angle},
    {{.name = "angle-6",
      .settings = "sign=outward,adaptive=0,turns=0",
      .summary = "interpolates by exterior angles, tension -1/4; plane, sphere, disk"},
     {.mu = BAT_CURVE_TENSION_SIX_POINT},
     make_angle},
    {{.name = "angle",
      .settings = "mu=0,sign=outward,adaptive=0,turns=0",
      .summary = "interpolates by exterior angles, any tension; plane, sphere, disk"},
     {.mu = 0},
     make_angle},
    {{.name = "log-exp-4",
      .settings = "w=0.0625,base=vertex,parameters=uniform",
      .summary = "the four-point scheme in tangent spaces; any space"},
     {.w = BAT_MASK_FOUR_POINT_WEIGHT},
     make_log_exp_4},
    {{.name = "log-exp-6",
      .settings = "w=0.01171875,base=vertex",
      .summary = "the six-point scheme in tangent spaces; any space"},
     {.w = BAT_MASK_SIX_POINT_WEIGHT},
     make_log_exp_6},
    {{.name = "log-exp-lane-riesenfeld",
      .settings = "order=3,base=vertex",
      .summary = "the B-spline of degree `order` in tangent spaces; any space"},
     {.order = 3},
     make_log_exp_lane_riesenfeld},
    {{.name = "geodesic", .settings = "order=3", .summary = "Lane-Riesenfeld by midpoints of geodesics; any space"},
     {.order = 3},
     make_geodesic},
    {{.name = "catmull-rom",
      .settings = "parameters=centripetal",
      .summary = "interpolates by a C1 spline of local cubics; any space"},
     {.parameters = BAT_CURVE_PARAMETERS_CENTRIPETAL},
     make_catmull_rom},
    {{.name = "cubic",
      .settings = "parameters=chordal",
      .summary = "interpolates by the cubic spline, C2 in R^n; any space"},
     {.parameters = BAT_CURVE_PARAMETERS_CHORDAL},
     make_cubic},
    {{.name = "learned",
      .settings = "fairness=0.5",
      .summary = "interpolates by a network, from nearest (0) to smoothest (1); plane, sphere, disk"},
     {.fairness = 0.5},
     make_learned},
};
const bat_family bat_curve_scheme_family = FAMILY("scheme", ENTRIES);

/// A number or a fraction of two, up to the character after it.
static bool read_number(const char **text, double *value)
{
    char *end;
    double numerator = strtod(*text, &end);
    if (end == *text || !isfinite(numerator))
        return false;
    double denominator = 1;
    if (*end == '/')
    {
        const char *start = end + 1;
        denominator = strtod(start, &end);
        if (end == start || !isfinite(denominator) || denominator == 0)
            return false;
    }
    *text = end;
    *value = numerator / denominator;
    return isfinite(*value);
}

/// "1/4,3/4,3/4,1/4@-2"
static bat_status read_mask(const char *text, bat_curve_scheme *scheme, bat_error *error)
{
    bat_mask mask = {.count = 0};
    const char *at = text;
    do
    {
        double value;
        if (mask.count == BAT_MASK_MAX)
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a mask has at most %d coefficients",
                             BAT_MASK_MAX);
        if (!read_number(&at, &value))
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
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "the first index in the mask '%s' is not a whole number within %d of 0", text, BAT_MASK_MAX);
        mask.first = (int)first;
        at = end;
    }
    if (*at != '\0')
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "'%s' does not belong in a mask", at);
    bat_status status = mask_check_place(&mask, error);
    if (status != BAT_OK)
        return status;
    *scheme = bat_curve_scheme_linear(mask);
    return BAT_OK;
}

/// Whether the entry's settings text begins one of its items with `key=`.
static bool takes(const entry *e, const char *key, size_t length)
{
    for (const char *item = e->choice.settings; item != NULL && *item != '\0'; item = strchr(item, ','))
    {
        item += *item == ',' ? 1 : 0;
        if (strncmp(item, key, length) == 0 && item[length] == '=')
            return true;
    }
    return false;
}

/// Whether `length` characters are the word.
static bool is_word(const char *text, size_t length, const char *word)
{
    return strlen(word) == length && strncmp(text, word, length) == 0;
}

/// One of two words: 0 for the first, 1 for the second, -1 for neither.
static int read_word(const char *text, size_t length, const char *first, const char *second)
{
    return is_word(text, length, first) ? 0 : is_word(text, length, second) ? 1 : -1;
}

/// The value of one item, `length` characters long.
static bool read_setting(const char *key, size_t key_length, const char *value, size_t length, settings *s)
{
    int chosen = -1;
    if (is_word(key, key_length, "sign"))
    {
        chosen = read_word(value, length, "outward", "printed");
        s->sign = chosen == 1 ? BAT_CURVE_ANGLE_PRINTED : BAT_CURVE_ANGLE_OUTWARD;
        return chosen >= 0;
    }
    if (is_word(key, key_length, "base"))
    {
        chosen = read_word(value, length, "vertex", "midpoint");
        s->base = chosen == 1 ? BAT_CURVE_BASE_MIDPOINT : BAT_CURVE_BASE_VERTEX;
        return chosen >= 0;
    }
    if (is_word(key, key_length, "parameters"))
    {
        const bat_choice *found = choice_find(&bat_curve_parameters_family, value, length);
        s->parameters = found != NULL ? (bat_curve_parameters)found->value : BAT_CURVE_PARAMETERS_UNIFORM;
        return found != NULL;
    }
    if (is_word(key, key_length, "adaptive"))
    {
        chosen = read_word(value, length, "0", "1");
        s->adaptive = chosen == 1;
        return chosen >= 0;
    }
    if (is_word(key, key_length, "turns"))
    {
        chosen = read_word(value, length, "0", "1");
        s->turns = chosen == 1;
        return chosen >= 0;
    }
    const struct
    {
        const char *key;
        double *value;
    } numbers[] = {{"w", &s->w},   {"r", &s->r},         {"s", &s->s},
                   {"mu", &s->mu}, {"order", &s->order}, {"fairness", &s->fairness}};
    const char *end = value;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (is_word(key, key_length, numbers[i].key))
            return read_number(&end, numbers[i].value) && end == value + length;
    return false;
}

/// "key=value,key=value"
static bat_status read_settings(const entry *e, const char *text, settings *s, bat_error *error)
{
    bool more = *text != '\0';
    while (more)
    {
        size_t key_length = strcspn(text, "=,");
        const char *key = text;
        if (text[key_length] != '=' || !takes(e, key, key_length))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "the scheme %s has no setting '%.*s'; it takes: %s", e->choice.name, (int)key_length, key,
                             e->choice.settings != NULL ? e->choice.settings : "none");
        const char *value = text + key_length + 1;
        size_t length = strcspn(value, ",");
        if (!read_setting(key, key_length, value, length, s))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "'%.*s' of the scheme %s has no such value: '%.*s'", (int)key_length, key, e->choice.name,
                             (int)length, value);
        more = value[length] == ',';
        text = value + length + 1;
    }
    return BAT_OK;
}

static bat_status check_settings(const entry *e, const settings *s, bat_error *error)
{
    static const option_field ORDER[] = {OPTION_FIELD(settings, order, OPTION_NUMBER, 1, BAT_MASK_MAX - 2)};
    if (e->make == make_corner_cutting && !(0 < s->r && s->r < s->s && s->s < 1))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "corner cutting needs 0 < r < s < 1, not r = %g, s = %g", s->r, s->s);
    bool has_order = e->make == make_lane_riesenfeld || e->make == make_log_exp_lane_riesenfeld || e->make == make_geodesic;
    if (has_order && s->order != floor(s->order))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "order is %.10g, but must be a whole number",
                         s->order);
    return has_order ? OPTIONS_CHECK(s, ORDER, error) : BAT_OK;
}

bat_status bat_curve_scheme_by_name(const char *name, bat_curve_scheme *scheme, bat_error *error)
{
    size_t length = strcspn(name, ":");
    const char *text = name[length] == ':' ? name + length + 1 : name + length;
    const entry *e = (const entry *)(const void *)choice_find(&bat_curve_scheme_family, name, length);
    if (e == NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "there is no scheme '%.*s'; `batten list schemes` names them", (int)length, name);
    if (e->make == NULL)
        return read_mask(text, scheme, error);
    settings s = e->defaults;
    bat_status status = read_settings(e, text, &s, error);
    if (status == BAT_OK)
        status = check_settings(e, &s, error);
    if (status != BAT_OK)
        return status;
    bat_curve_scheme made = e->make(&s);
    status = bat_curve_scheme_check(&made, error);
    if (status == BAT_OK)
        *scheme = made;
    return status;
}
