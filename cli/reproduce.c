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

/// What a result does with meshes that are given to it.
typedef enum meshes
{
    NO_MESHES,
    SUBDIVIDES, ///< decimates and subdivides them
    LEARNS      ///< trains on them
} meshes;

enum
{
    MOST_SHAPES = MOST_POSITIONAL - 1,
    MOST_NUMBER = 1000000
};

static const struct
{
    const char *name;
    int (*run)(const reproduce_job *job);
    pictures drawn;
    bool learned; ///< whether a learned tension is compared
    bool seeded;  ///< whether chance has a part in it
    bool sets;    ///< whether there are other curves than the published ones
    const char *summary;
    meshes meshes;
    size_t most_meshes;
    const char *folder; ///< the default one of ALWAYS and TRAINING
} RESULTS[] = {
    {"curve-figures", reproduce_curve_figures, ALWAYS, false, false, false,
     "the figures of the curve-scheme study: ten shapes at levels 0, 1, 2, 10, 20", NO_MESHES, 0, "out"},
    {"tension-table1", reproduce_tension_table1, WITH_FOLDER, true, false, true,
     "table 1 of the tension paper: 240 validation curves, or 900 test curves, all schemes, both signs", NO_MESHES, 0, NULL},
    {"tension-table2", reproduce_tension_table2, NEVER, true, true, false,
     "table 2 of the tension paper: largest angles where the control points are disturbed", NO_MESHES, 0, NULL},
    {"tension-table3", reproduce_tension_table3, TRAINING, false, true, false,
     "table 3 of the tension paper: how the network learns of the space; trains for 100 epochs three times", NO_MESHES, 0,
     "out/tension-ablations"},
    {"tension-table4", reproduce_tension_table4, TRAINING, false, true, false,
     "table 4 of the tension paper: the loss without one term; trains for 100 epochs four times", NO_MESHES, 0,
     "out/tension-ablations"},
    {"tension-iss", reproduce_tension_iss, WITH_FOLDER, true, false, false,
     "table 5 of the tension paper: the ISS ground track", NO_MESHES, 0, NULL},
    {"tension-mechanism", reproduce_tension_mechanism, WITH_FOLDER, true, false, false,
     "section 9 of the tension paper: a network's effective tension, and its Lipschitz constant (remark 4)", NO_MESHES, 0,
     NULL},
    {"hermite-figures", reproduce_hermite_figures, ALWAYS, false, false, false,
     "figures 1 to 4 of the Hermite paper: tensors, orders 1, 3 and 10, a spiral, rotations, beside parallel transport",
     NO_MESHES, 0, "out"},
    {"hermite-order", reproduce_hermite_order, NEVER, false, false, false,
     "the Hermite paper's claims measured in nine spaces: orders, geodesics, proximity, contraction, displacement",
     NO_MESHES, 0, NULL},
    {"mesh-table2", reproduce_mesh_table2, WITH_FOLDER, true, false, false,
     "table 2 of Neural Subdivision with shapes of your own: decimated, subdivided twice, measured", SUBDIVIDES, MOST_SHAPES,
     NULL},
    {"mesh-ablations", reproduce_mesh_ablations, TRAINING, false, true, false,
     "section 6, appendices G and H of Neural Subdivision: the network without its parts; trains six times, some minutes",
     LEARNS, MOST_SHAPES, "out/mesh-ablations"},
    {"mesh-style", reproduce_mesh_style, TRAINING, false, true, false,
     "figures 26 and 27 of Neural Subdivision: one cage, a smooth and a sharp teacher; trains twice", LEARNS, 2,
     "out/mesh-style"},
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
     "-table4: where the trainings are kept, and gone on with; default out/tension-ablations. mesh-ablations, mesh-style: "
     "the "
     "same, and the picture of the latter; default out/ and their name"},
    {"model", 0, "FILE",
     "tension-table1, -table2, -iss: a learned tension, for a row \"learned-published\"; tension-mechanism: the one to look "
     "into; mesh-table2: a learned subdivision, for rows \"given\""},
    {"set", 0, "NAME", "tension-table1: published (default), fresh or unseen curves"},
    {"seed", 0, "N",
     "tension-table2: of the noise; tension-table3, -table4, mesh-ablations, mesh-style: of the trainings; default 1"},
    {"data", 0, "FOLDER", "mesh-table2: all shapes of a folder but those that the networks learned from"},
    {"vertices", 0, "N", "mesh-table2: how many vertices the shapes are decimated to; default 400"},
    {"epochs", 0, "E", "mesh-ablations, mesh-style: of each training; default 60"},
    {"pairs", 0, "N", "mesh-ablations, mesh-style: coarse meshes made of each shape; default 50"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten reproduce NAME [SHAPE...] [-o FOLDER] [--model FILE] [--set NAME] [--seed N] [--json] [options]",
    .summary =
        "A published table or figure, computed anew and shown beside the published figures; `batten list results` "
        "names them.\n"
        "mesh-table2 needs SHAPEs (OBJ, PLY, OFF, STL) or --data. mesh-ablations learns from all SHAPEs but the last, "
        "which it tests\n"
        "on; mesh-style from a smooth and a sharp one; without any, both make their own.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = MOST_POSITIONAL,
};

static bool any_given(const arguments *given, const char *const *options)
{
    bool any = false;
    for (; *options != NULL; options++)
        any = any || argument(given, *options) != NULL;
    return any;
}

/// Whether meshes and what to do with them were given to a result that takes them; EXIT_DONE when all fits.
static int check_meshes(const arguments *given, size_t index)
{
    static const char *const FOR_SUBDIVISION[] = {"data", "vertices", NULL}, *const FOR_LEARNING[] = {"epochs", "pairs",
                                                                                                      NULL};
    const char *name = RESULTS[index].name;
    meshes use = RESULTS[index].meshes;
    size_t count = given->positional_count - 1;
    if (count > RESULTS[index].most_meshes)
        return use == NO_MESHES ? usage_error(given, "one argument too many: %s takes no shapes", name)
                                : usage_error(given, "%s takes %zu shapes at most", name, RESULTS[index].most_meshes);
    if (RESULTS[index].most_meshes == 2 && count == 1)
        return usage_error(given, "%s takes two shapes, a smooth and a sharp one, or none", name);
    if (use != SUBDIVIDES && any_given(given, FOR_SUBDIVISION))
        return usage_error(given, "--data and --vertices go with mesh-table2");
    if (use != LEARNS && any_given(given, FOR_LEARNING))
        return usage_error(given, "--epochs and --pairs go with mesh-ablations and mesh-style");
    if (use == SUBDIVIDES && (count > 0) == (argument(given, "data") != NULL))
        return usage_error(given, "%s needs %s: the program comes without any", name,
                           count > 0 ? "either shapes or --data, not both" : "shapes, or a folder of them as --data");
    return EXIT_DONE;
}

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
    return check_meshes(given, index);
}

static const char *folder_of(const arguments *given, size_t index)
{
    const char *folder = argument(given, "output");
    return folder != NULL ? folder : RESULTS[index].folder;
}

static int run(const arguments *given, size_t index)
{
    // In the order of bat_tension_set_kind.
    static const char *const SETS[] = {"published", "fresh", "unseen", NULL};
    long seed, vertices, epochs, pairs;
    int set, code = check_options(given, index);
    if (code != EXIT_DONE || !argument_word(given, "set", SETS, BAT_TENSION_PUBLISHED, &set))
        return EXIT_BAD_USAGE;
    if (code != EXIT_DONE || !argument_whole(given, "seed", 0, 1000000000, 1, &seed))
        return EXIT_BAD_USAGE;
    if (!argument_whole(given, "vertices", 4, MOST_NUMBER, 0, &vertices) ||
        !argument_whole(given, "epochs", 1, MOST_NUMBER, 0, &epochs) ||
        !argument_whole(given, "pairs", 1, MOST_NUMBER, 0, &pairs))
        return EXIT_BAD_USAGE;
    pictures drawn = RESULTS[index].drawn;
    const char *folder = folder_of(given, index);
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
                         .json = argument_flag(given, "json"),
                         .shapes = given->positional + 1,
                         .shape_count = given->positional_count - 1,
                         .data = argument(given, "data"),
                         .vertices = (size_t)vertices,
                         .epochs = (size_t)epochs,
                         .pairs = (size_t)pairs};
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
