#include "reproduce.h"

#include "arguments.h"
#include "report.h"
#include "verbs.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/// When a result comes with pictures.
typedef enum pictures
{
    NEVER,
    WITH_FOLDER, ///< when a folder is given
    ALWAYS
} pictures;

static const struct
{
    const char *name;
    int (*run)(const reproduce_job *job);
    pictures drawn;
    bool learned; ///< whether a model can be compared
    bool sets;    ///< whether there are other curves than the published ones
    const char *summary;
} RESULTS[] = {
    {"curve-figures", reproduce_curve_figures, ALWAYS, false, false,
     "the figures of the curve-scheme study: ten shapes at levels 0, 1, 2, 10, 20"},
    {"tension-table1", reproduce_tension_table1, NEVER, true, true,
     "table 1 of the tension paper: 240 validation curves, or 900 test curves, all schemes, both signs"},
    {"tension-iss", reproduce_tension_iss, WITH_FOLDER, true, false, "table 5 of the tension paper: the ISS ground track"},
};
enum
{
    RESULT_COUNT = sizeof RESULTS / sizeof RESULTS[0]
};

bool reproduce_row(size_t index, const char **name, const char **summary)
{
    if (index >= RESULT_COUNT)
        return false;
    *name = RESULTS[index].name;
    *summary = RESULTS[index].summary;
    return true;
}

static const option_spec OPTIONS[] = {
    {"output", 'o', "FOLDER", "where pictures go; default: out for curve-figures, no picture for tension-iss"},
    {"model", 0, "FILE", "tension-table1, tension-iss: a learned tension, for a row \"learned-published\""},
    {"set", 0, "NAME", "tension-table1: published (default), fresh or unseen curves"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten reproduce NAME [-o FOLDER] [--model FILE] [--set NAME] [--json]",
    .summary = "A published table or figure, computed anew and shown beside the published figures; `batten list results` "
               "names them.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = 1,
};

/// The curves that a name stands for; the published ones where none is given. False for an unknown name.
static bool curves_by_name(const char *name, bat_tension_set_kind *curves)
{
    static const char *const NAMES[] = {
        [BAT_TENSION_PUBLISHED] = "published", [BAT_TENSION_FRESH] = "fresh", [BAT_TENSION_UNSEEN] = "unseen"};
    *curves = BAT_TENSION_PUBLISHED;
    for (size_t i = 0; name != NULL && i < sizeof NAMES / sizeof NAMES[0]; i++)
        if (strcmp(name, NAMES[i]) == 0)
        {
            *curves = (bat_tension_set_kind)i;
            return true;
        }
    return name == NULL;
}

int verb_reproduce(int argc, char **argv)
{
    arguments given;
    int code;
    bat_tension_set_kind curves;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!curves_by_name(argument(&given, "set"), &curves))
        return usage_error(&given, "--set is one of published, fresh, unseen, not '%s'", argument(&given, "set"));
    for (size_t i = 0; i < RESULT_COUNT; i++)
    {
        if (strcmp(given.positional[0], RESULTS[i].name) != 0)
            continue;
        const char *folder = argument(&given, "output");
        if (folder != NULL && RESULTS[i].drawn == NEVER)
            return usage_error(&given, "%s has no pictures to put into a folder", RESULTS[i].name);
        if (argument(&given, "model") != NULL && !RESULTS[i].learned)
            return usage_error(&given, "%s has no row for a model", RESULTS[i].name);
        if (argument(&given, "set") != NULL && !RESULTS[i].sets)
            return usage_error(&given, "%s has no other curves than its own", RESULTS[i].name);
        if (folder == NULL && RESULTS[i].drawn == ALWAYS)
            folder = "out";
        if (folder != NULL && mkdir(folder, 0777) != 0 && errno != EEXIST)
        {
            bat_error error = {0};
            (void)snprintf(error.text, sizeof error.text, "the folder cannot be made: %s", strerror(errno));
            return report_failure(folder, &error);
        }
        reproduce_job job = {folder, argument(&given, "model"), curves, argument_flag(&given, "json")};
        return RESULTS[i].run(&job);
    }
    return usage_error(&given, "there is no result '%s'; `batten list results` names them", given.positional[0]);
}
