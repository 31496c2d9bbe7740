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
    ALWAYS,
    TRAINING ///< never, but a folder holds the trainings
} pictures;

static const struct
{
    const char *name;
    int (*run)(const reproduce_job *job);
    pictures drawn;
    bool learned; ///< whether a learned tension is compared
    bool seeded;  ///< whether chance has a part in it
    bool sets;    ///< whether there are other curves than the published ones
    const char *summary;
} RESULTS[] = {
    {"curve-figures", reproduce_curve_figures, ALWAYS, false, false, false,
     "the figures of the curve-scheme study: ten shapes at levels 0, 1, 2, 10, 20"},
    {"tension-table1", reproduce_tension_table1, WITH_FOLDER, true, false, true,
     "table 1 of the tension paper: 240 validation curves, or 900 test curves, all schemes, both signs"},
    {"tension-table2", reproduce_tension_table2, NEVER, true, true, false,
     "table 2 of the tension paper: largest angles where the control points are disturbed"},
    {"tension-table3", reproduce_tension_table3, TRAINING, false, true, false,
     "table 3 of the tension paper: how the network learns of the space; trains for 100 epochs three times"},
    {"tension-table4", reproduce_tension_table4, TRAINING, false, true, false,
     "table 4 of the tension paper: the loss without one term; trains for 100 epochs four times"},
    {"tension-iss", reproduce_tension_iss, WITH_FOLDER, true, false, false,
     "table 5 of the tension paper: the ISS ground track"},
    {"tension-mechanism", reproduce_tension_mechanism, WITH_FOLDER, true, false, false,
     "section 9 of the tension paper: a network's effective tension, and its Lipschitz constant (remark 4)"},
    {"hermite-figures", reproduce_hermite_figures, ALWAYS, false, false, false,
     "figures 1 to 4 of the Hermite paper: tensors, orders 1, 3 and 10, a spiral, rotations, beside parallel transport"},
    {"hermite-order", reproduce_hermite_order, NEVER, false, false, false,
     "the Hermite paper's claims measured in nine spaces: orders, geodesics, proximity, contraction, displacement"},
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
    {"output", 'o', "FOLDER",
     "where pictures go; default: out for curve-figures and hermite-figures, no picture for tension-table1, -iss and "
     "-mechanism. tension-table3 "
     "and "
     "-table4: where the trainings are kept, and gone on with; default out/tension-ablations"},
    {"model", 0, "FILE",
     "tension-table1, -table2, -iss: a learned tension, for a row \"learned-published\"; tension-mechanism: the one to look "
     "into"},
    {"set", 0, "NAME", "tension-table1: published (default), fresh or unseen curves"},
    {"seed", 0, "N", "tension-table2: of the noise; tension-table3, -table4: of the trainings; default 1"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten reproduce NAME [-o FOLDER] [--model FILE] [--set NAME] [--seed N] [--json]",
    .summary = "A published table or figure, computed anew and shown beside the published figures; `batten list results` "
               "names them.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = 1,
};

/// What a result does with the options that were given; EXIT_DONE when all of them fit.
static int check_options(const arguments *given, size_t index)
{
    const char *name = RESULTS[index].name;
    if (argument(given, "output") != NULL && RESULTS[index].drawn == NEVER)
        return usage_error(given, "%s has no pictures to put into a folder", name);
    if (argument(given, "model") != NULL && !RESULTS[index].learned)
        return usage_error(given, "%s has no row for a model", name);
    if (argument(given, "seed") != NULL && !RESULTS[index].seeded)
        return usage_error(given, "%s has no chance in it for a seed", name);
    if (argument(given, "set") != NULL && !RESULTS[index].sets)
        return usage_error(given, "%s has no other curves: --set goes with tension-table1", name);
    return EXIT_DONE;
}

static const char *folder_of(const arguments *given, pictures drawn)
{
    const char *folder = argument(given, "output");
    if (folder != NULL)
        return folder;
    return drawn == ALWAYS ? "out" : drawn == TRAINING ? "out/tension-ablations" : NULL;
}

static int run(const arguments *given, size_t index)
{
    // In the order of bat_tension_set_kind.
    static const char *const SETS[] = {"published", "fresh", "unseen", NULL};
    long seed;
    int set, code = check_options(given, index);
    if (code != EXIT_DONE || !argument_word(given, "set", SETS, BAT_TENSION_PUBLISHED, &set))
        return EXIT_BAD_USAGE;
    if (code != EXIT_DONE || !argument_whole(given, "seed", 0, 1000000000, 1, &seed))
        return EXIT_BAD_USAGE;
    pictures drawn = RESULTS[index].drawn;
    const char *folder = folder_of(given, drawn);
    // Trainings make their folders themselves.
    if (folder != NULL && drawn != TRAINING && mkdir(folder, 0777) != 0 && errno != EEXIST)
    {
        bat_error error = {0};
        (void)snprintf(error.text, sizeof error.text, "the folder cannot be made: %s", strerror(errno));
        return report_failure(folder, &error);
    }
    reproduce_job job = {.folder = folder,
                         .model = argument(given, "model"),
                         .seed = (uint64_t)seed,
                         .curves = (bat_tension_set_kind)set,
                         .json = argument_flag(given, "json")};
    return RESULTS[index].run(&job);
}

int verb_reproduce(int argc, char **argv)
{
    arguments given;
    int code;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    for (size_t i = 0; i < RESULT_COUNT; i++)
        if (strcmp(given.positional[0], RESULTS[i].name) == 0)
            return run(&given, i);
    return usage_error(&given, "there is no result '%s'; `batten list results` names them", given.positional[0]);
}
