#include "batten/motion.h"

#include "base/choice.h"
#include "base/error.h"
#include "base/option.h"

#include <string.h>

/// The values of the settings of a name.
typedef struct settings
{
    double order;
} settings;

typedef struct entry
{
    bat_choice choice;
    bat_motion_method method;
} entry;

static const entry ENTRIES[] = {
    {{.name = "spline", .summary = "a motion in time through its keys, with continuous velocity and acceleration"},
     BAT_MOTION_METHOD_SPLINE},
    {CHOICE_SET("hermite", "order=1", "by points and tangents, order 1 through the points; any space"),
     BAT_MOTION_METHOD_HERMITE},
};
const bat_family bat_motion_scheme_family = FAMILY("scheme", ENTRIES);

bat_status bat_motion_scheme_by_name(const char *name, bat_motion_curves_options *options, bat_error *error)
{
    static const setting SETTINGS[] = {
        {"order", SETTING_NUMBER, offsetof(settings, order), NULL},
    };
    static const option_field ORDER[] = {OPTION_FIELD(settings, order, OPTION_NUMBER, 1, BAT_HERMITE_MAX_ORDER)};
    size_t length = strcspn(name, ":");
    const char *text = name[length] == ':' ? name + length + 1 : name + length;
    const entry *e = (const entry *)(const void *)choice_find(&bat_motion_scheme_family, name, length);
    if (e == NULL)
        return ERROR_ARGUMENT(error, "there is no scheme '%.*s'; `batten list schemes` names them", (int)length, name);
    settings s = {.order = 1};
    bat_status status = settings_read(&e->choice, text, SETTINGS, sizeof SETTINGS / sizeof *SETTINGS, &s, error);
    if (status == BAT_OK && s.order != floor(s.order))
        status = error_option(error, "order", "is %.10g, but must be a whole number", s.order);
    if (status == BAT_OK)
        status = OPTIONS_CHECK(&s, ORDER, error);
    if (status == BAT_OK && e->method == BAT_MOTION_METHOD_HERMITE)
        options->scheme.order = (size_t)s.order;
    if (status == BAT_OK)
        options->method = e->method;
    return status;
}
