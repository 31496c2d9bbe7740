#include "reproduce.h"

#include "arguments.h"
#include "verbs.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const struct
{
    const char *name;
    int (*run)(const char *folder, bool as_json);
    bool needs_folder; ///< its result is pictures
    const char *summary;
} RESULTS[] = {
    {"curve-figures", reproduce_curve_figures, true,
     "the figures of the curve-scheme study: ten shapes at levels 0, 1, 2, 10, 20"},
    {"tension-table1", reproduce_tension_table1, false,
     "table 1 of the tension paper: 240 validation curves, all schemes, both signs"},
    {"tension-iss", reproduce_tension_iss, false, "table 5 of the tension paper: the ISS ground track"},
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
    {"output", 'o', "FOLDER", "where pictures go; default: out for figures, no pictures for tables"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten reproduce NAME [-o FOLDER] [--json]",
    .summary = "A published table or figure, computed anew and shown beside the published figures; `batten list results` "
               "names them.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = 1,
};

int verb_reproduce(int argc, char **argv)
{
    arguments given;
    int code;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    for (size_t i = 0; i < RESULT_COUNT; i++)
    {
        if (strcmp(given.positional[0], RESULTS[i].name) != 0)
            continue;
        const char *folder = argument(&given, "output");
        if (folder == NULL && RESULTS[i].needs_folder)
            folder = "out";
        if (folder != NULL && mkdir(folder, 0777) != 0 && errno != EEXIST)
        {
            (void)fprintf(stderr, "batten: %s: the folder cannot be made (%s)\n", folder, strerror(errno));
            return EXIT_BAD_INPUT;
        }
        return RESULTS[i].run(folder, argument_flag(&given, "json"));
    }
    return usage_error(&given, "there is no result '%s'; `batten list results` names them", given.positional[0]);
}
