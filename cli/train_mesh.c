#include "train_mesh.h"
#include "arguments.h"
#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const RECIPES[] = {"published", "batten", NULL};
enum
{
    RECIPE_PUBLISHED,
    RECIPE_BATTEN
};
static const char *const PARTS[] = {"frames", "differences", "levels", "correspondence", NULL};
enum
{
    PART_FRAMES,
    PART_DIFFERENCES,
    PART_LEVELS,
    PART_CORRESPONDENCE
};

enum
{
    MOST_SHAPES = MAX_POSITIONAL - 1 + BAT_MESH_TRAINING_SHAPES
};

static const option_spec OPTIONS[] = {
    {"recipe", 0, "NAME",
     "published: the network, data and loss of Liu et al., \"Neural Subdivision\" (2020); the default. batten: "
     "that of the weights we ship, on SHAPE... and on shapes of our own making"},
    {"seed", 0, "N", "of the weights to begin with and of all other chance; default 1"},
    {"epochs", 0, "E", "default 700; batten: 400"},
    {"pairs", 0, "N", "coarse meshes that are made of each shape; default 200; batten: 16"},
    {"fresh", 0, "N", "of all of them so many are made anew in each epoch; default 0; batten: 24"},
    {"batch", 0, "N", "meshes of a step, which as many threads share; default 1; batten: 2"},
    {"falling-rate", 0, NULL, "the learning rate falls to 0 along half a wave; else it is constant"},
    {"vertices", 0, "A-B", "of the coarse meshes: from A to B, evenly drawn; default 150-300; batten: 150-500"},
    {"out", 'o', "FOLDER", "where model, checkpoint, log and its picture go; default out/mesh"},
    {"resume", 0, NULL, "go on from the folder's checkpoint, if there is one"},
    {"threads", 0, "N", "default: all processors; the result does not depend on it"},
    {"without", 0, "PART",
     "leave out: frames, differences (differential coordinates), levels (all but the last one's loss), correspondence "
     "(Chamfer distance instead)"},
    {"relative", 0, NULL, "half-flaps measure lengths by their own: scale does not matter then, as it does in the paper"},
    {"surface", 0, NULL, "the loss counts what lies off the shape in full, and what has slipped along it a tenth"},
    {"learn-loop", 0, NULL, "the targets are Loop's refinement of the coarse meshes"},
    {"repair", 0, NULL, "cut shapes where they are no manifold"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten train mesh SHAPE... [--recipe published|batten] [--pairs N] [--epochs E] [--out FOLDER] [--resume] "
             "[options]",
    .summary =
        "Train a learned subdivision of meshes on shapes (OBJ, PLY, OFF, STL). Ctrl-C writes a checkpoint and stops; with "
        "--resume the same command goes on to the same result.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = MAX_POSITIONAL,
};

static void leave_out(bat_mesh_train_options *options, int part)
{
    options->fixed_frames = part == PART_FRAMES;
    options->no_differences = part == PART_DIFFERENCES;
    options->last_level = part == PART_LEVELS;
    options->chamfer = part == PART_CORRESPONDENCE;
}

/// False after a message.
static bool read_range(const arguments *given, size_t *least, size_t *most)
{
    const char *text = argument(given, "vertices");
    if (text == NULL)
        return true;
    char *dash, *end;
    long low = strtol(text, &dash, 10), high = *dash == '-' ? strtol(dash + 1, &end, 10) : 0;
    if (*dash != '-' || *end != '\0' || low < 4 || high < low || high > 1000000000)
    {
        (void)usage_error(given, "--vertices is two numbers like 150-300, of 4 or more, not '%s'", text);
        return false;
    }
    *least = (size_t)low;
    *most = (size_t)high;
    return true;
}

/// False after a message.
static bool read_options(const arguments *given, int *recipe, bat_mesh_train_options *options)
{
    long seed, epochs, pairs, fresh, batch, threads;
    int without;
    if (!argument_word(given, "recipe", RECIPES, RECIPE_PUBLISHED, recipe))
        return false;
    *options = *recipe == RECIPE_BATTEN ? bat_mesh_train_batten() : bat_mesh_train_defaults();
    if (!argument_whole(given, "seed", 0, 1000000000, 1, &seed) ||
        !argument_whole(given, "epochs", 1, 1000000, (long)options->epochs, &epochs) ||
        !argument_whole(given, "pairs", 1, 1000000, (long)options->pairs, &pairs) ||
        !argument_whole(given, "fresh", 0, 1000000, (long)options->fresh, &fresh) ||
        !argument_whole(given, "batch", 1, 1000, (long)options->batch, &batch) ||
        !argument_whole(given, "threads", 1, 1024, 0, &threads) || !argument_word(given, "without", PARTS, -1, &without) ||
        !read_range(given, &options->least_vertices, &options->most_vertices))
        return false;
    options->seed = (uint64_t)seed;
    options->epochs = (uint64_t)epochs;
    options->pairs = (size_t)pairs;
    options->fresh = (size_t)fresh;
    options->batch = (size_t)batch;
    options->threads = (int)threads;
    options->falling |= argument_flag(given, "falling-rate");
    options->relative |= argument_flag(given, "relative");
    options->surface |= argument_flag(given, "surface");
    options->learn_loop = argument_flag(given, "learn-loop");
    options->resume = argument_flag(given, "resume");
    options->folder = argument(given, "out") != NULL ? argument(given, "out") : "out/mesh";
    leave_out(options, without);
    return true;
}

/// Whether half-edges can hold a shape: here its file's name is known.
static bat_status check_shape(const bat_mesh *shape, bat_error *error)
{
    bat_mesh_connectivity connectivity;
    bat_status status = bat_mesh_connect(shape, &connectivity, error);
    if (status == BAT_OK)
        bat_mesh_connectivity_free(&connectivity);
    return status;
}

/// A shape, repaired where that is wanted.
static bat_status read_shape(const char *path, bool repair, bat_mesh *shape, bat_error *error)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    options.triangulate = true;
    options.repair = repair;
    bat_mesh mesh;
    bat_status status = bat_mesh_read(path, &options, &mesh, error);
    if (status != BAT_OK)
        return status;
    status = check_shape(&mesh, error);
    if (status == BAT_OK)
        *shape = mesh;
    else
        bat_mesh_free(&mesh);
    return status;
}

static int print_json(const char *recipe, const bat_mesh_train_options *options, const bat_mesh_train_report *report)
{
    json_t *errors = json_array();
    for (size_t level = 0; level <= BAT_MESH_TRAIN_LEVELS; level++)
        (void)json_array_append_new(errors, report_number(report->errors[level]));
    return report_json(json_pack("{s:s, s:I, s:I, s:I, s:o, s:o, s:s}", "recipe", recipe, "seed", (json_int_t)options->seed,
                                 "epochs", (json_int_t)report->epochs, "best_epoch", (json_int_t)report->best_epoch, "loss",
                                 report_number(report->loss), "errors", errors, "folder", options->folder));
}

static int print_text(const bat_mesh_train_options *options, const bat_mesh_train_report *report)
{
    (void)printf("%llu epochs; the best weights are those after epoch %llu. %s\nat levels 0, 1, 2: %.5f, %.5f, %.5f\n\n"
                 "%s/model.safetensors\n",
                 (unsigned long long)report->epochs, (unsigned long long)report->best_epoch,
                 options->surface || options->chamfer
                     ? "Roots of the losses of coarse meshes kept aside,"
                     : "Errors of coarse meshes kept aside, root mean squares in units of the longest side,",
                 report->errors[0], report->errors[1], report->errors[2], options->folder);
    return EXIT_DONE;
}

static int train(const arguments *given, int recipe, const bat_mesh *shapes, size_t count,
                 const bat_mesh_train_options *options)
{
    bat_mesh_train_report report;
    bat_error error;
    bat_status status = bat_mesh_train(shapes, count, options, &report, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    return argument_flag(given, "json") ? print_json(RECIPES[recipe], options, &report) : print_text(options, &report);
}

int train_mesh(int argc, char **argv)
{
    arguments given;
    bat_mesh_train_options options;
    int code, recipe;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!read_options(&given, &recipe, &options))
        return EXIT_BAD_USAGE;
    if (given.positional_count < 2 && recipe != RECIPE_BATTEN)
        return usage_error(&given, "train mesh needs a SHAPE");
    bat_mesh shapes[MOST_SHAPES] = {0};
    size_t count = 0;
    bat_error error;
    bat_status status = BAT_OK;
    for (; count + 1 < given.positional_count && status == BAT_OK; count += status == BAT_OK)
    {
        status = read_shape(given.positional[count + 1], argument_flag(&given, "repair"), &shapes[count], &error);
        if (status != BAT_OK)
            code = report_failure(given.positional[count + 1], &error);
    }
    if (status == BAT_OK && recipe == RECIPE_BATTEN)
    {
        status = bat_mesh_training_shapes(shapes + count, options.threads, (bat_progress){0}, &error);
        if (status == BAT_OK)
            count += BAT_MESH_TRAINING_SHAPES;
        else
            code = report_failure(NULL, &error);
    }
    if (status == BAT_OK)
    {
        options.progress = report_progress("training");
        code = train(&given, recipe, shapes, count, &options);
    }
    for (size_t s = 0; s < count; s++)
        bat_mesh_free(&shapes[s]);
    return code;
}
