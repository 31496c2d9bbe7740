#include "batten/motion_hermite.h"

#include "base/error.h"

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
    const char *name, *settings, *summary;
    void (*apply)(const settings *, bat_hermite_options *);
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
    {"hermite", "order=1", "by points and tangents, order 1 through the points; any space; --rate samples it in time",
     apply_hermite},
    {"hermite-merrien", "lambda=-0.125,mu=-0.5,base=vertex",
     "Merrien's scheme by parallel transport, through the points, evenly spaced; any space", apply_merrien},
    {"hermite-de-rham", "base=vertex", "its de Rham transform by parallel transport, C2, near the points; any space",
     apply_de_rham},
};
enum
{
    ENTRY_COUNT = sizeof ENTRIES / sizeof ENTRIES[0]
};

bool bat_hermite_list(size_t index, const char **name, const char **setting_list, const char **summary)
{
    if (index >= ENTRY_COUNT)
        return false;
    *name = ENTRIES[index].name;
    *setting_list = ENTRIES[index].settings;
    *summary = ENTRIES[index].summary;
    return true;
}

/// Whether the entry's settings text begins one of its items with `key=`.
static bool takes(const entry *e, const char *key, size_t length)
{
    for (const char *item = e->settings; item != NULL; item = strchr(item, ','))
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
                             "the scheme %s has no setting '%.*s'; it takes: %s", e->name, (int)key_length, text,
                             e->settings);
        const char *value = text + key_length + 1;
        size_t length = strcspn(value, ",");
        if (!read_setting(text, key_length, value, length, s))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "'%.*s' of the scheme %s has no such value: '%.*s'", (int)key_length, text, e->name,
                             (int)length, value);
        more = value[length] == ',';
        text = value + length + more;
    }
    if (!(s->order >= 1 && s->order <= BAT_HERMITE_MAX_ORDER && s->order == floor(s->order)))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the order must be a whole number from 1 to %d, not %g", BAT_HERMITE_MAX_ORDER, s->order);
    return BAT_OK;
}

bat_status bat_hermite_by_name(const char *name, bat_hermite_options *options, bat_error *error)
{
    size_t length = strcspn(name, ":");
    const char *text = name[length] == ':' ? name + length + 1 : name + length;
    for (size_t i = 0; i < ENTRY_COUNT; i++)
    {
        settings s = DEFAULTS;
        if (!is_word(name, length, ENTRIES[i].name))
            continue;
        bat_status status = read_settings(&ENTRIES[i], text, &s, error);
        if (status == BAT_OK)
            ENTRIES[i].apply(&s, options);
        return status;
    }
    return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                     "there is no scheme '%.*s'; `batten list schemes` names them", (int)length, name);
}
