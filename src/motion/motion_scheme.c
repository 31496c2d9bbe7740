#include "batten/motion.h"

#include "base/choice.h"
#include "base/error.h"
#include "base/option.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The values of the settings of a name.
typedef struct settings
{
    double order, lambda, mu;
    bat_curve_base base;
} settings;

/// One name: its settings, and the function that converts them to options.
typedef struct entry
{
    bat_choice choice;
    void (*apply)(const settings *, bat_hermite_options *); ///< null: not a Hermite scheme
    bat_motion_method method;
} entry;

static void apply_hermite(const settings *s, bat_hermite_options *options)
{
    options->kind = BAT_HERMITE_LANE_RIESENFELD;
    options->order = (size_t)s->order;
}

static void apply_merrien(const settings *s, bat_hermite_options *options)
{
    options->kind = BAT_HERMITE_TRANSPORT;
    options->mask = bat_hermite_mask_merrien(s->lambda, s->mu);
    options->base = s->base;
}

static void apply_de_rham(const settings *s, bat_hermite_options *options)
{
    options->kind = BAT_HERMITE_TRANSPORT;
    options->mask = bat_hermite_mask_de_rham();
    options->base = s->base;
}

static const settings DEFAULTS = {.order = 1, .lambda = -0.125, .mu = -0.5, .base = BAT_CURVE_BASE_VERTEX};

static const entry ENTRIES[] = {
    {{.name = "spline", .summary = "a motion in time through its keys, with continuous velocity and acceleration"},
     NULL,
     BAT_MOTION_SPLINE},
    {{.name = "hermite",
      .settings = "order=1",
      .summary = "by points and tangents, order 1 through the points; any space; --rate samples it in time"},
     apply_hermite,
     BAT_MOTION_HERMITE},
    {{.name = "hermite-merrien",
      .settings = "lambda=-0.125,mu=-0.5,base=vertex",
      .summary = "Merrien's scheme by parallel transport, through the points, evenly spaced; any space"},
     apply_merrien,
     BAT_MOTION_HERMITE},
    {{.name = "hermite-de-rham",
      .settings = "base=vertex",
      .summary = "its de Rham transform by parallel transport, C2, near the points; any space"},
     apply_de_rham,
     BAT_MOTION_HERMITE},
};
const bat_family bat_motion_scheme_family = FAMILY("scheme", ENTRIES);

/// Whether the entry's settings text begins one of its items with `key=`.
static bool takes(const entry *e, const char *key, size_t length)
{
    for (const char *item = e->choice.settings; item != NULL; item = strchr(item, ','))
    {
        item += *item == ',';
        if (strncmp(item, key, length) == 0 && item[length] == '=')
            return true;
    }
    return false;
}

static bool is_word(const char *text, size_t length, const char *word)
{
    return strlen(word) == length && strncmp(text, word, length) == 0;
}

static bool read_setting(const char *key, size_t key_length, const char *value, size_t length, settings *s)
{
    if (is_word(key, key_length, "base"))
    {
        s->base = is_word(value, length, "midpoint") ? BAT_CURVE_BASE_MIDPOINT : BAT_CURVE_BASE_VERTEX;
        return is_word(value, length, "midpoint") || is_word(value, length, "vertex");
    }
    double *number = is_word(key, key_length, "order") ? &s->order : is_word(key, key_length, "mu") ? &s->mu : &s->lambda;
    char *end;
    *number = strtod(value, &end);
    return end != value && end == value + length && isfinite(*number);
}

/// "key=value,key=value"
static bat_status read_settings(const entry *e, const char *text, settings *s, bat_error *error)
{
    for (bool more = *text != '\0'; more;)
    {
        size_t key_length = strcspn(text, "=,");
        if (text[key_length] != '=' || !takes(e, text, key_length))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "the scheme %s has no setting '%.*s'; it takes: %s", e->choice.name, (int)key_length, text,
                             e->choice.settings != NULL ? e->choice.settings : "none");
        const char *value = text + key_length + 1;
        size_t length = strcspn(value, ",");
        if (!read_setting(text, key_length, value, length, s))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "'%.*s' of the scheme %s has no such value: '%.*s'", (int)key_length, text, e->choice.name,
                             (int)length, value);
        more = value[length] == ',';
        text = value + length + more;
    }
    static const option_field ORDER[] = {OPTION_FIELD(settings, order, OPTION_NUMBER, 1, BAT_HERMITE_MAX_ORDER)};
    if (s->order != floor(s->order))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "order is %.10g, but must be a whole number",
                         s->order);
    return OPTIONS_CHECK(s, ORDER, error);
}

bat_status bat_motion_scheme_by_name(const char *name, bat_motion_options *options, bat_error *error)
{
    size_t length = strcspn(name, ":");
    const char *text = name[length] == ':' ? name + length + 1 : name + length;
    const entry *e = (const entry *)(const void *)choice_find(&bat_motion_scheme_family, name, length);
    if (e == NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "there is no scheme '%.*s'; `batten list schemes` names them", (int)length, name);
    settings s = DEFAULTS;
    bat_status status = read_settings(e, text, &s, error);
    if (status == BAT_OK && e->apply != NULL)
        e->apply(&s, &options->scheme);
    if (status == BAT_OK)
        options->method = e->method;
    return status;
}
