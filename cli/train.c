#include "train.h"

#include "arguments.h"
#include "report.h"
#include "terminal.h"
#include "verbs.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The trainings differ in their options and in their reports; the rest is shared.

static const char *const RECIPES[] = {"published", "batten", NULL};
static const char *const SPACES[BAT_TENSION_SPACE_COUNT] = {"plane", "sphere", "disk"};

enum
{
    MAX_SEED = 1000000000,
    MAX_EPOCHS = 1000000,
    PATHS = 2 ///< by recipe
};

/// The processes of the call.
static const bat_group *group;
static int default_threads;

// Reading options

/// The options that all trainings have. False after a message.
static bool read_run(const arguments *given, const char *folder, bat_train_options *run)
{
    long seed, epochs, threads, slots;
    if (!argument_whole(given, "seed", 0, MAX_SEED, (long)run->seed, &seed) ||
        !argument_whole(given, "epochs", 1, MAX_EPOCHS, (long)run->epochs, &epochs) ||
        !argument_whole(given, "threads", 1, BAT_TRAIN_MAX_THREADS, default_threads, &threads) ||
        !argument_whole(given, "slots", 1, BAT_TRAIN_MAX_SLOTS, 0, &slots))
        return false;
    run->seed = (uint64_t)seed;
    run->epochs = (uint64_t)epochs;
    run->threads = (int)threads;
    run->slots = (size_t)slots;
    run->group = group;
    run->resume = argument_flag(given, "resume");
    run->folder = argument(given, "output") != NULL ? argument(given, "output") : folder;
    return true;
}

/// A whole number from `low` on; unchanged when the option was not given. False after a message.
static bool read_count(const arguments *given, const char *name, long low, long high, size_t *count)
{
    long value;
    if (!argument_whole(given, name, low, high, (long)*count, &value))
        return false;
    *count = (size_t)value;
    return true;
}

/// "A-B", or also "A" for both; false when it is neither.
static bool parse_range(const char *text, bool one_is_both, long *low, long *high)
{
    char *end;
    *low = *high = strtol(text, &end, 10);
    bool two = *end == '-';
    if (two)
        *high = strtol(end + 1, &end, 10);
    return end != text && *end == '\0' && (two || one_is_both);
}

/// True when the option was given and its range is good; false after a message, too.
static bool read_range(const arguments *given, const char *name, long max, long *low, long *high, bool *failed)
{
    const char *text = argument(given, name);
    if (text == NULL)
        return false;
    *failed = !parse_range(text, true, low, high) || *low < 1 || *high < *low || *high > max;
    if (*failed)
        (void)usage_error(given, "--%s is a number, or two like 2-5, of 1 to %ld, not '%s'", name, max, text);
    return !*failed;
}

// Reports

static json_t *run_json(bat_recipe recipe, const bat_train_options *run, const bat_train_report *report)
{
    return json_pack("{s:s, s:I, s:I, s:I, s:b, s:o, s:s}", "recipe", bat_recipe_name(recipe), "seed", (json_int_t)run->seed,
                     "epochs", (json_int_t)report->epochs, "best_epoch", (json_int_t)report->best_epoch, "stopped_early",
                     (int)report->stopped, "loss", report_number(report->loss), "folder", run->folder);
}

static void print_epochs(const bat_train_report *report)
{
    (void)printf("%llu epochs%s; the best weights are those after epoch %llu", (unsigned long long)report->epochs,
                 report->stopped ? ", stopped early" : "", (unsigned long long)report->best_epoch);
}

// Curves

static const char *const EMBEDDINGS[] = {"learned", "one-hot", "none", NULL};
static const char *const TERMS[] = {"consistency", "bending", "smoothness", NULL};
enum
{
    TERM_CONSISTENCY,
    TERM_BENDING,
    TERM_SMOOTHNESS
};

static const option_spec CURVE_OPTIONS[] = {
    {"recipe", 0, "NAME",
     "published: the network, data, loss and stopping rules of Ugail and Howard (2026); batten: the scheme that comes with "
     "the library; default published"},
    {"seed", 0, "N", "of the initial weights and of all other randomness; default 1"},
    {"epochs", 0, "E", "at most; the learning rate decays to 0 over as many; default 300"},
    {"output", 'o', "FOLDER", "for model, checkpoint, log and its picture; default out/tension, for batten out/fairing"},
    {"resume", 0, NULL, "resume from the folder's checkpoint, if there is one"},
    {"threads", 0, "N", "default: all processors; the result does not depend on it"},
    {"slots", 0, "N", "at most so many threads work at a step, of all processes; changes roundings; default 8"},
    {"embedding", 0, "KIND", "published: how the network encodes the space: learned (default), one-hot, none"},
    {"without", 0, "TERM", "published: leave a term out of the loss: consistency, bending, smoothness"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

/// Table 1, the learned predictor.
static const bat_curve_train_score PUBLISHED[BAT_TENSION_SPACE_COUNT] = {
    {0.01636, 20.9, 0.237}, {0.04905, 13.8, 0.231}, {0.00435, 17403.9, 0.160}};

static const double FAIRNESS[BAT_CURVE_TRAIN_FAIRNESSES] = {0, 0.5, 1};

/// False after a message.
static bool read_curve(const arguments *given, bat_curve_train_options *options)
{
    int embedding, without;
    if (options->recipe == BAT_RECIPE_BATTEN && (argument(given, "embedding") != NULL || argument(given, "without") != NULL))
    {
        (void)usage_error(given, "only the published recipe has --embedding and --without");
        return false;
    }
    if (!argument_word(given, "embedding", EMBEDDINGS, 0, &embedding) ||
        !argument_word(given, "without", TERMS, -1, &without))
        return false;
    options->embedding = (bat_tension_embedding)embedding;
    if (without == TERM_CONSISTENCY)
        options->consistency = 0;
    if (without == TERM_BENDING)
        options->bending = 0;
    if (without == TERM_SMOOTHNESS)
        memset(options->smoothness, 0, sizeof options->smoothness);
    return true;
}

static json_t *published_scores(const bat_curve_train_report *report)
{
    json_t *scores = json_array();
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        const bat_curve_train_score *ours = &report->scores[0][space], *published = &PUBLISHED[space];
        (void)json_array_append_new(scores, json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "space", SPACES[space],
                                                      "mean_nn", report_number(ours->mean_nn), "bending",
                                                      report_number(ours->bending), "g1", report_number(ours->g1),
                                                      "published_mean_nn", report_number(published->mean_nn),
                                                      "published_bending", report_number(published->bending), "published_g1",
                                                      report_number(published->g1)));
    }
    return scores;
}

static json_t *batten_scores(const bat_curve_train_report *report)
{
    json_t *scores = json_array();
    for (int i = 0; i < BAT_CURVE_TRAIN_FAIRNESSES; i++)
        for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        {
            const bat_curve_train_score *score = &report->scores[i][space];
            (void)json_array_append_new(scores, json_pack("{s:f, s:s, s:o, s:o, s:o}", "fairness", FAIRNESS[i], "space",
                                                          SPACES[space], "mean_nn", report_number(score->mean_nn), "bending",
                                                          report_number(score->bending), "g1", report_number(score->g1)));
        }
    return scores;
}

static void print_published(const bat_curve_train_report *report)
{
    print_epochs(&report->run);
    (void)printf(", with a mean-NN of %.5f over the spaces\n"
                 "(published: 0.02325 after epoch 200). Validation curves, five learned levels; published values in "
                 "brackets:\n\n",
                 report->run.best);
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        const bat_curve_train_score *ours = &report->scores[0][space], *published = &PUBLISHED[space];
        (void)printf("%-7s mean-NN %.5f (%.5f)   bending %8.4g (%8.4g)   G1 %.3f (%.3f)\n", SPACES[space], ours->mean_nn,
                     published->mean_nn, ours->bending, published->bending, ours->g1, published->g1);
    }
    (void)putchar('\n');
}

static void print_batten(const bat_curve_train_report *report)
{
    (void)printf("%llu epochs. Validation curves, drawn from the trained families, five levels:\n\n",
                 (unsigned long long)report->run.epochs);
    for (int i = 0; i < BAT_CURVE_TRAIN_FAIRNESSES; i++)
        for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        {
            const bat_curve_train_score *score = &report->scores[i][space];
            (void)printf("fairness %.1f %-7s mean-NN %.5f   bending %8.4g   G1 %.3f\n", FAIRNESS[i], SPACES[space],
                         score->mean_nn, score->bending, score->g1);
        }
    (void)putchar('\n');
}

static int train_curve(const arguments *given, bat_recipe recipe, const char *folder)
{
    bat_curve_train_options options = bat_curve_train_defaults(recipe);
    bat_curve_train_report report;
    bat_error error;
    bool published = recipe == BAT_RECIPE_PUBLISHED;
    if (!read_curve(given, &options) || !read_run(given, folder, &options.run))
        return EXIT_BAD_USAGE;
    options.run.progress = report_progress("training");
    bat_status status = bat_curve_train(&options, &report, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    if (argument_flag(given, "json"))
    {
        json_t *object = run_json(recipe, &options.run, &report.run);
        (void)json_object_set_new(object, "mean_nn", report_number(report.run.best));
        (void)json_object_set_new(object, "scores", published ? published_scores(&report) : batten_scores(&report));
        return report_json(object);
    }
    (published ? print_published : print_batten)(&report);
    terminal_print(stdout, "%s/model.safetensors\n", options.run.folder);
    return EXIT_DONE;
}

// Meshes

static const char *const PARTS[] = {"frames", "differences", "levels", "correspondence", NULL};
enum
{
    PART_FRAMES,
    PART_DIFFERENCES,
    PART_LEVELS,
    PART_CORRESPONDENCE
};

static const option_spec MESH_OPTIONS[] = {
    {"recipe", 0, "NAME",
     "published: the network, data and loss of Liu et al., \"Neural Subdivision\" (2020); the default. batten: that of the "
     "shipped weights, on SHAPE... and on generated shapes"},
    {"seed", 0, "N", "of the initial weights and of all other randomness; default 1"},
    {"epochs", 0, "E", "default 700; batten: 200"},
    {"pairs", 0, "N", "coarse meshes per shape; default 200; batten: 16"},
    {"resampled", 0, "N", "pairs that each epoch replaces by new ones; default 0; batten: 64"},
    {"batch", 0, "N", "meshes per step, shared by as many threads; default 1; batten: 4"},
    {"cosine", 0, NULL, "cosine decay of the learning rate to 0; else it is constant"},
    {"rate", 0, "R", "the learning rate; default 0.002"},
    {"begin", 0, "FILE", "batten: begin with these weights, and count the worst meshes and the largest distances more"},
    {"vertices", 0, "A-B", "of the coarse meshes, drawn from A to B; default 150-300; batten: 100-500"},
    {"output", 'o', "FOLDER", "for model, checkpoint, log and its picture; default out/mesh"},
    {"resume", 0, NULL, "resume from the folder's checkpoint, if there is one"},
    {"threads", 0, "N", "default: all processors; the result does not depend on it"},
    {"slots", 0, "N", "at most so many threads work at a step, of all processes; changes roundings; default 8"},
    {"without", 0, "PART",
     "leave out: frames, differences (differential coordinates), levels (all but the last one's loss), correspondence "
     "(Chamfer distance instead)"},
    {"relative", 0, NULL, "lengths are relative to each half-flap's own, so that scale does not matter, as in the paper"},
    {"surface", 0, NULL, "the loss counts distances from the shape in full, and distances along it by a tenth"},
    {"learn-loop", 0, NULL, "the targets are Loop's refinement of the coarse meshes"},
    {"repair", 0, NULL, "cut shapes where they are not manifold"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

/// False after a message.
static bool read_vertices(const arguments *given, bat_mesh_train_options *options)
{
    const char *text = argument(given, "vertices");
    long low, high;
    if (text == NULL)
        return true;
    if (!parse_range(text, false, &low, &high) || low < 4 || high < low || high > BAT_MESH_TRAIN_MAX_VERTICES)
    {
        (void)usage_error(given, "--vertices is two numbers like 150-300, of 4 or more, not '%s'", text);
        return false;
    }
    options->min_vertices = (size_t)low;
    options->max_vertices = (size_t)high;
    return true;
}

/// False after a message.
static bool read_mesh(const arguments *given, bat_mesh_train_options *options)
{
    int without;
    if (!read_count(given, "pairs", 1, 1000000, &options->pairs) ||
        !read_count(given, "resampled", 0, 1000000, &options->resampled) ||
        !read_count(given, "batch", 1, 1000, &options->batch) || !argument_word(given, "without", PARTS, -1, &without) ||
        !read_vertices(given, options) || !argument_number(given, "rate", options->rate, &options->rate))
        return false;
    options->begin = argument(given, "begin");
    options->cosine_decay |= argument_flag(given, "cosine");
    options->relative |= argument_flag(given, "relative");
    options->surface |= argument_flag(given, "surface");
    options->learn_loop = argument_flag(given, "learn-loop");
    options->fixed_frames = without == PART_FRAMES;
    options->no_differences = without == PART_DIFFERENCES;
    options->last_level = without == PART_LEVELS;
    options->chamfer = without == PART_CORRESPONDENCE;
    return true;
}

/// A shape that half-edges can represent, repaired if that is asked for. It is checked here, where its file's name is known.
static bat_status read_shape(const char *path, bool repair, bat_mesh *shape, bat_error *error)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    bat_mesh_connectivity connectivity;
    options.triangulate = true;
    options.repair = repair;
    bat_mesh mesh;
    bat_status status = bat_mesh_read(path, &options, &mesh, error);
    if (status != BAT_OK)
        return status;
    status = bat_mesh_connect(&mesh, &connectivity, error);
    if (status != BAT_OK)
    {
        bat_mesh_free(&mesh);
        return status;
    }
    bat_mesh_connectivity_free(&connectivity);
    *shape = mesh;
    return BAT_OK;
}

static int report_mesh(const arguments *given, const bat_mesh_train_options *options, const bat_mesh_train_report *report)
{
    if (argument_flag(given, "json"))
    {
        json_t *object = run_json(options->recipe, &options->run, &report->run), *errors = json_array();
        for (size_t level = 0; level <= BAT_MESH_TRAIN_LEVELS; level++)
            (void)json_array_append_new(errors, report_number(report->errors[level]));
        (void)json_object_set_new(object, "errors", errors);
        return report_json(object);
    }
    if (options->recipe == BAT_RECIPE_BATTEN)
    {
        (void)printf(
            "%llu epochs, the last weights. Mean distance of validation meshes over the best classical scheme's: %.3f\n"
            "at best.\n\n",
            (unsigned long long)report->run.epochs, report->run.best);
        terminal_print(stdout, "%s/model.safetensors\n", options->run.folder);
        return EXIT_DONE;
    }
    print_epochs(&report->run);
    (void)printf(". %s\nat levels 0, 1, 2: %.5f, %.5f, %.5f\n\n",
                 options->surface || options->chamfer
                     ? "Roots of the losses of validation meshes,"
                     : "Errors of validation meshes, root mean squares in units of the longest side,",
                 report->errors[0], report->errors[1], report->errors[2]);
    terminal_print(stdout, "%s/model.safetensors\n", options->run.folder);
    return EXIT_DONE;
}

/// Read the shapes and train.
static int train_shapes(const arguments *given, bat_mesh_train_options *options, bat_mesh *shapes)
{
    bat_mesh_train_report report;
    bat_error error;
    size_t count = given->positional_count - 1;
    for (size_t s = 0; s < count; s++)
    {
        bat_status status = read_shape(given->positional[s + 1], argument_flag(given, "repair"), &shapes[s], &error);
        if (bat_group_agree(group, status, &error) != BAT_OK)
            return report_failure(given->positional[s + 1], &error);
    }
    options->run.progress = report_progress("training");
    bat_status status = bat_mesh_train(shapes, count, options, &report, &error);
    report_progress_end();
    return status == BAT_OK ? report_mesh(given, options, &report) : report_failure(NULL, &error);
}

static int train_mesh(const arguments *given, bat_recipe recipe, const char *folder)
{
    bat_mesh_train_options options = bat_mesh_train_defaults(recipe);
    bat_mesh shapes[MAX_POSITIONAL] = {0};
    if (!read_mesh(given, &options) || !read_run(given, folder, &options.run))
        return EXIT_BAD_USAGE;
    if (given->positional_count < 2 && recipe != BAT_RECIPE_BATTEN)
        return usage_error(given, "train mesh needs a SHAPE");
    int code = train_shapes(given, &options, shapes);
    for (size_t s = 0; s < MAX_POSITIONAL; s++)
        bat_mesh_free(&shapes[s]);
    return code;
}

// Surfaces

static const option_spec SURFACE_OPTIONS[] = {
    {"recipe", 0, "NAME",
     "published: the network, clouds and loss of Giannelli et al., \"BIDGCN\" (2023); the default. batten: that of the "
     "shipped weights"},
    {"uninformed", 0, NULL,
     "published: boundary points are treated as interior ones, without their parameters (section 6.1)"},
    {"seed", 0, "N", "of the initial weights and of all clouds; default 1"},
    {"epochs", 0, "E", "default 100; batten: 60"},
    {"steps", 0, "N", "per epoch; default 1000; batten: 500"},
    {"batch", 0, "N", "clouds per step, shared by as many threads; default 1; batten: 32"},
    {"points", 0, "A-B", "interior points of a cloud, drawn uniformly in the logarithm; default 1000; batten: 50-2000"},
    {"degree", 0, "A-B", "bidegree of a cloud, drawn uniformly; default 2; batten: 2-5"},
    {"noise", 0, "D", "standard deviations are drawn from 0 to D; default 0; batten: 0.05"},
    {"rate", 0, "R", "the highest learning rate; default 0.1; with --adam and for batten 0.001"},
    {"adam", 0, NULL,
     "AdamW and cosine decay of the rate; else gradient descent, with the rate halved where the validation error no longer "
     "falls"},
    {"output", 'o', "FOLDER", "for model, checkpoint, log and its picture; default out/surface"},
    {"resume", 0, NULL, "resume from the folder's checkpoint, if there is one"},
    {"threads", 0, "N", "default: all processors; the result does not depend on it"},
    {"slots", 0, "N", "at most so many threads work at a step, of all processes; changes roundings; default 8"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

/// False after a message.
static bool read_clouds(const arguments *given, bat_surface_train_options *options)
{
    long low, high;
    bool failed = false;
    if (read_range(given, "points", BAT_SURFACE_TRAIN_MAX_POINTS, &low, &high, &failed))
    {
        options->min_points = (size_t)low;
        options->max_points = (size_t)high;
    }
    if (!failed && read_range(given, "degree", BAT_SURFACE_TRAIN_MAX_DEGREE, &low, &high, &failed))
    {
        options->min_degree = (int)low;
        options->max_degree = (int)high;
    }
    return !failed && argument_number(given, "noise", options->noise, &options->noise);
}

/// False after a message.
static bool read_surface(const arguments *given, bat_surface_train_options *options)
{
    options->uninformed = argument_flag(given, "uninformed");
    if (options->uninformed && options->recipe == BAT_RECIPE_BATTEN)
    {
        (void)usage_error(given, "only the published recipe has --uninformed");
        return false;
    }
    if (argument_flag(given, "adam"))
    {
        options->adam = true;
        options->rate = 1e-3;
    }
    return read_count(given, "steps", 1, 1000000, &options->steps) && read_count(given, "batch", 1, 1000, &options->batch) &&
           read_clouds(given, options) && argument_number(given, "rate", options->rate, &options->rate);
}

static int train_surface(const arguments *given, bat_recipe recipe, const char *folder)
{
    bat_surface_train_options options = bat_surface_train_defaults(recipe);
    bat_surface_train_report report;
    bat_error error;
    if (!read_surface(given, &options) || !read_run(given, folder, &options.run))
        return EXIT_BAD_USAGE;
    options.run.progress = report_progress("training");
    bat_status status = bat_surface_train(&options, &report, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    if (argument_flag(given, "json"))
    {
        json_t *object = run_json(recipe, &options.run, &report.run);
        (void)json_object_set_new(object, "uninformed", json_boolean(options.uninformed));
        (void)json_object_set_new(object, "error", report_number(report.run.best));
        return report_json(object);
    }
    print_epochs(&report.run);
    (void)printf(". Validation clouds, fitted with their bidegree: mean squared error %.4g, in units of the longest "
                 "side\n\n%s/model.safetensors\n",
                 report.run.best, options.run.folder);
    return EXIT_DONE;
}

// The verb

#define SUMMARY_END " Ctrl-C writes a checkpoint and stops; with --resume the same command continues to the same result."

/// What can be trained.
static const struct
{
    const char *name;
    verb_spec spec;
    const char *folders[PATHS];
    int (*train)(const arguments *given, bat_recipe recipe, const char *folder);
} KINDS[] = {
    {"curve",
     {.usage = "batten train curve [--recipe published|batten] [--seed N] [--epochs E] [-o FOLDER] [--resume] [options]",
      .summary = "Train the learned curve scheme." SUMMARY_END
                 " `batten train mesh --help` is about meshes, `batten train surface --help` about scattered points.",
      .options = CURVE_OPTIONS,
      .min_positional = 1,
      .max_positional = 1},
     {"out/tension", "out/fairing"},
     train_curve},
    {"mesh",
     {.usage = "batten train mesh SHAPE... [--recipe published|batten] [--pairs N] [--epochs E] [-o FOLDER] [--resume] "
               "[options]",
      .summary = "Train a learned subdivision of meshes on shapes (OBJ, PLY, OFF, STL)." SUMMARY_END,
      .options = MESH_OPTIONS,
      .min_positional = 1,
      .max_positional = MAX_POSITIONAL},
     {"out/mesh", "out/mesh"},
     train_mesh},
    {"surface",
     {.usage = "batten train surface [--recipe published|batten] [--epochs E] [-o FOLDER] [--resume] [options]",
      .summary = "Train learned parameters of scattered points on random Bézier clouds, made on the fly." SUMMARY_END,
      .options = SURFACE_OPTIONS,
      .min_positional = 1,
      .max_positional = 1},
     {"out/surface", "out/surface"},
     train_surface},
};
enum
{
    KIND_COUNT = sizeof KINDS / sizeof *KINDS
};

/// The kind of a name; the first where there is none.
static size_t find_kind(const char *name)
{
    for (size_t k = 0; k < KIND_COUNT; k++)
        if (strcmp(name, KINDS[k].name) == 0)
            return k;
    return 0;
}

int train_in_group(int argc, char **argv, const bat_group *processes, int threads)
{
    arguments given;
    group = processes;
    default_threads = threads;
    int code, recipe;
    size_t kind = argc > 1 ? find_kind(argv[1]) : 0;
    if (!arguments_read(&KINDS[kind].spec, argc, argv, &given, &code))
        return code;
    const char *name = given.positional[0];
    if (strcmp(name, KINDS[kind].name) != 0)
        return usage_error(&given, "there is no model '%s' to train; there are curve, mesh and surface", name);
    if (!argument_word(&given, "recipe", RECIPES, BAT_RECIPE_PUBLISHED, &recipe))
        return EXIT_BAD_USAGE;
    return KINDS[kind].train(&given, (bat_recipe)recipe, KINDS[kind].folders[recipe]);
}

int verb_train(int argc, char **argv)
{
    return train_in_group(argc, argv, NULL, 0);
}
