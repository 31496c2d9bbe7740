#include "verb.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The trainings differ in their options and in their reports; the rest is shared.

static const char *const RECIPES[] = {"published", "batten", NULL};
static const char *const SPACES[BAT_TENSION_SPACE_COUNT] = {"plane", "sphere", "disk"};

enum
{
    MAX_SEED = 1000000000,
    MAX_EPOCHS = 1000000
};

/// The processes of the call.
static const bat_group *group;
static int default_threads;

/// The job of a training.
typedef struct train_job
{
    verb_call call;
    bat_recipe recipe;
    bat_curve_train_options curve;
    bat_curve_train_report curve_report;
    bat_mesh_train_options mesh;
    bat_mesh_train_report mesh_report;
    bool repair; ///< shapes
    bat_mesh shapes[MAX_POSITIONAL];
    bat_surface_train_options surface;
    bat_surface_train_report surface_report;
} train_job;

// Options

/// Those of all trainings.
static const option_spec RUN_OPTIONS[] = {
    {"epochs", "E", METHOD, COMMON,
     "at most; the learning rate of curves decays to 0 over as many; default: curves 300, meshes 700 (batten: 200), "
     "surfaces 100 (batten: 60)",
     WHOLE(bat_train_options, epochs, 1, MAX_EPOCHS)},
    {"seed", "N", METHOD, COMMON, "of the initial weights and of all other randomness; default 1",
     WHOLE(bat_train_options, seed, 0, MAX_SEED)},
    {"output", "FOLDER", RESULT, COMMON, "for model, checkpoint, log and its picture; default: in out, by model and recipe",
     TEXT(bat_train_options, folder)},
    {"resume", NULL, RESULT, COMMON, "resume from the folder's checkpoint, if there is one",
     FLAG(bat_train_options, resume)},
    {"threads", "N", CALL, COMMON, "default: all processors; the result does not depend on it",
     WHOLE(bat_train_options, threads, 1, BAT_TRAIN_MAX_THREADS)},
    {"slots", "N", CALL, 0, "at most so many threads work at a step, of all processes; changes roundings; default 8",
     WHOLE(bat_train_options, slots, 1, BAT_TRAIN_MAX_SLOTS)},
    END_OF_OPTIONS,
};

/// Set what all trainings have before the options are read. --recipe, which has other defaults, is read here.
static void begin_run(train_job *job, bat_train_options *run, const char *published, const char *batten)
{
    run->threads = default_threads;
    run->group = group;
    run->folder = job->recipe == BAT_RECIPE_PUBLISHED ? published : batten;
}

static bat_recipe recipe_of(const train_job *job)
{
    const char *name = argument(job->call.given, "recipe");
    return name != NULL && strcmp(name, RECIPES[BAT_RECIPE_BATTEN]) == 0 ? BAT_RECIPE_BATTEN : BAT_RECIPE_PUBLISHED;
}

/// Check --recipe and read --without, an index into `parts` or -1. False after a message.
static bool check_run(const train_job *job, const char *const *parts, int *without)
{
    int recipe;
    return argument_word(job->call.given, "recipe", RECIPES, BAT_RECIPE_PUBLISHED, &recipe) &&
           argument_word(job->call.given, "without", parts, -1, without);
}

/// "A-B", or also "A" for both, from `min` to `max`; `range` is untouched where the option was not given. False after a
/// message.
static bool read_range(const arguments *given, const char *name, bool one_is_both, long min, long max, long range[2])
{
    const char *text = argument(given, name);
    char *end;
    if (text == NULL)
        return true;
    range[0] = range[1] = strtol(text, &end, 10);
    bool two = *end == '-';
    if (two)
        range[1] = strtol(end + 1, &end, 10);
    if (end != text && *end == '\0' && (two || one_is_both) && range[0] >= min && range[1] >= range[0] && range[1] <= max)
        return true;
    return one_is_both ? argument_refused(given, name, "a number, or two as in 2-5, from %ld to %ld", min, max)
                       : argument_refused(given, name, "two numbers of %ld or more, as in 150-300", min);
}

// Reports

// What all of them begin with, and the pieces of their texts.

#define RUN_KEYS "recipe:s seed:z epochs:z best_epoch:z stopped_early:b loss:n folder:s "
#define RUN_VALUES(recipe, run, report)                                                                                     \
    bat_recipe_name(recipe), (size_t)(run)->seed, (size_t)(report)->epochs, (size_t)(report)->best_epoch,                   \
        (int)(report)->stopped, (report)->loss, (run)->folder
#define EPOCHS_TEXT "{epochs} epochs[stopped_early?, stopped early]; the best weights are those after epoch {best_epoch}"
#define MODEL_TEXT "{folder}/model.safetensors\n"

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
    {"recipe", "NAME", METHOD, COMMON,
     "published: the network, data, loss and stopping rules of Ugail and Howard (2026); batten: the scheme that comes with "
     "the library; default published",
     NO_FIELD},
    {"embedding", "KIND", METHOD, 0, "published: how the network encodes the space: learned (default), one-hot, none",
     NO_FIELD},
    {"begin", "FILE", METHOD, 0, "batten: begin with these weights instead of random ones", TEXT(train_job, curve.begin)},
    {"without", "TERM", METHOD, 0, "published: leave a term out of the loss: consistency, bending, smoothness", NO_FIELD},
    END_OF_OPTIONS,
};

/// Table 1, the learned predictor.
static const bat_curve_train_score PUBLISHED[BAT_TENSION_SPACE_COUNT] = {
    {0.01636, 20.9, 0.237}, {0.04905, 13.8, 0.231}, {0.00435, 17403.9, 0.160}};

static const double FAIRNESS[BAT_CURVE_TRAIN_FAIRNESSES] = {0, 0.5, 1};

static void begin_curve(void *to)
{
    train_job *job = to;
    job->recipe = recipe_of(job);
    job->curve = bat_curve_train_defaults(job->recipe);
    begin_run(job, &job->curve.run, "out/tension", "out/fairing");
}

static bool check_curve(void *of)
{
    static const char *const published[] = {"embedding", "without", NULL};
    train_job *job = of;
    const arguments *given = job->call.given;
    bat_curve_train_options *options = &job->curve;
    int embedding, without;
    if (!check_run(job, TERMS, &without) || !argument_word(given, "embedding", EMBEDDINGS, 0, &embedding))
        return false;
    if (job->recipe == BAT_RECIPE_BATTEN && argument_first(given, published) != NULL)
        return usage_refused(given, "only the published recipe has --embedding and --without");
    options->embedding = (bat_tension_embedding)embedding;
    if (without == TERM_CONSISTENCY)
        options->consistency = 0;
    if (without == TERM_BENDING)
        options->bending = 0;
    if (without == TERM_SMOOTHNESS)
        memset(options->smoothness, 0, sizeof options->smoothness);
    return true;
}

static int train_curve(void *of)
{
    train_job *job = of;
    job->curve.run.progress = report_progress("training");
    return report_status(job->call.given, NULL, bat_curve_train(&job->curve, &job->curve_report, report_error()));
}

/// Report the scores of a space.
static void report_score(report_table *scores, int space, double fairness, const bat_curve_train_score *ours,
                         const bat_curve_train_score *published)
{
    static const bat_curve_train_score none = {NAN, NAN, NAN};
    const bat_curve_train_score *other = published != NULL ? published : &none;
    report_row(scores,
               "[fairness?fairness {fairness:.1f} ]{space:-7} mean-NN {mean_nn:.5f}[published_mean_nn? "
               "({published_mean_nn:.5f})]   bending {bending:8.4g}[published_bending? ({published_bending:8.4g})]   G1 "
               "{g1:.3f}[published_g1? ({published_g1:.3f})]\n",
               "fairness:n? space:s mean_nn:n bending:n g1:n published_mean_nn:n? published_bending:n? published_g1:n?",
               fairness, SPACES[space], ours->mean_nn, ours->bending, ours->g1, other->mean_nn, other->bending, other->g1);
}

static int report_curve(void *of)
{
    const train_job *job = of;
    const bat_curve_train_report *report = &job->curve_report;
    report_table scores = report_begin(job->call.json);
    bool published = job->recipe == BAT_RECIPE_PUBLISHED;
    if (!job->call.json)
        (void)report_part(
            false,
            published ? EPOCHS_TEXT ", with a mean-NN of {best:.5f} over the spaces\n(published: 0.02325 after epoch 200). "
                                    "Validation curves, five learned levels; published values in brackets:\n\n"
                      : "{epochs} epochs. Validation curves, drawn from the trained families, five levels:\n\n",
            RUN_KEYS "best:n", RUN_VALUES(job->recipe, &job->curve.run, &report->run), report->run.best);
    for (int i = 0; i < (published ? 1 : BAT_CURVE_TRAIN_FAIRNESSES); i++)
        for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
            report_score(&scores, space, published ? NAN : FAIRNESS[i], &report->scores[i][space],
                         published ? &PUBLISHED[space] : NULL);
    return report_print(job->call.json, "\n" MODEL_TEXT, RUN_KEYS "mean_nn:n scores:o",
                        RUN_VALUES(job->recipe, &job->curve.run, &report->run), report->run.best, scores.rows);
}

// Meshes

/// As the fields of check_mesh().
static const char *const PARTS[] = {"frames", "differences", "levels", "correspondence", NULL};

static const option_spec MESH_OPTIONS[] = {
    {"recipe", "NAME", METHOD, COMMON,
     "published: the network, data and loss of Liu et al., \"Neural Subdivision\" (2020); the default. batten: that of the "
     "shipped weights, on SHAPE... and on generated shapes",
     NO_FIELD},
    {"pairs", "N", METHOD, COMMON, "coarse meshes per shape; default 200; batten: 16",
     WHOLE(train_job, mesh.pairs, 1, 1000000)},
    {"resampled", "N", METHOD, 0, "pairs that each epoch replaces by new ones; default 0; batten: 64",
     WHOLE(train_job, mesh.resampled, 0, 1000000)},
    {"batch", "N", METHOD, 0, "meshes per step, shared by as many threads; default 1; batten: 4",
     WHOLE(train_job, mesh.batch, 1, 1000)},
    {"cosine", NULL, METHOD, 0, "cosine decay of the learning rate to 0; else it is constant",
     FLAG(train_job, mesh.cosine_decay)},
    {"rate", "R", METHOD, 0, "the learning rate; default 0.002", NUMBER(train_job, mesh.rate)},
    {"begin", "FILE", METHOD, 0,
     "batten: begin with these weights, and count the worst meshes and the largest distances more",
     TEXT(train_job, mesh.begin)},
    {"vertices", "A-B", METHOD, 0, "of the coarse meshes, drawn from A to B; default 150-300; batten: 100-500", NO_FIELD},
    {"without", "PART", METHOD, 0,
     "leave out: frames, differences (differential coordinates), levels (all but the last one's loss), correspondence "
     "(Chamfer distance instead)",
     NO_FIELD},
    {"relative", NULL, METHOD, 0,
     "lengths are relative to each half-flap's own, so that scale does not matter, as in the paper",
     FLAG(train_job, mesh.relative)},
    {"surface", NULL, METHOD, 0, "the loss counts distances from the shape in full, and distances along it by a tenth",
     FLAG(train_job, mesh.surface)},
    {"learn-loop", NULL, METHOD, 0, "the targets are Loop's refinement of the coarse meshes",
     FLAG(train_job, mesh.learn_loop)},
    {"repair", NULL, INPUT, 0, "cut shapes where they are not manifold", FLAG(train_job, repair)},
    END_OF_OPTIONS,
};

static void begin_mesh(void *to)
{
    train_job *job = to;
    job->recipe = recipe_of(job);
    job->mesh = bat_mesh_train_defaults(job->recipe);
    begin_run(job, &job->mesh.run, "out/mesh", "out/mesh");
}

static bool check_mesh(void *of)
{
    train_job *job = of;
    bat_mesh_train_options *options = &job->mesh;
    int without;
    long range[2] = {(long)options->min_vertices, (long)options->max_vertices};
    if (!check_run(job, PARTS, &without) ||
        !read_range(job->call.given, "vertices", false, 4, BAT_MESH_TRAIN_MAX_VERTICES, range))
        return false;
    options->min_vertices = (size_t)range[0];
    options->max_vertices = (size_t)range[1];
    bool *const left_out[] = {&options->fixed_frames, &options->no_differences, &options->last_level, &options->chamfer};
    if (without >= 0)
        *left_out[without] = true;
    return job->call.given->positional_count > 0 || job->recipe == BAT_RECIPE_BATTEN ||
           usage_refused(job->call.given, "train mesh needs a SHAPE");
}

/// A shape that half-edges can represent, repaired if that is asked for. It is checked here, where its file's name is known.
static bat_status read_shape(const char *path, bool repair, bat_mesh *shape, bat_error *error)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    bat_mesh_connectivity connectivity;
    options.triangulate = true;
    options.repair = repair;
    options.strict = !repair;
    bat_status status = bat_mesh_read(path, &options, shape, error);
    if (status == BAT_OK)
        status = bat_mesh_connect(shape, &connectivity, error);
    if (status == BAT_OK)
        bat_mesh_connectivity_free(&connectivity);
    return status;
}

static int train_mesh(void *of)
{
    train_job *job = of;
    size_t count = job->call.given->positional_count;
    for (size_t s = 0; s < count; s++)
    {
        const char *path = job->call.given->positional[s];
        bat_status status = read_shape(path, job->repair, &job->shapes[s], report_error());
        if (bat_group_agree(group, status, report_error()) != BAT_OK)
            return report_failure(path, report_error());
    }
    job->mesh.run.progress = report_progress("training");
    return report_status(job->call.given, NULL,
                         bat_mesh_train(job->shapes, count, &job->mesh, &job->mesh_report, report_error()));
}

static int report_mesh(void *of)
{
    const train_job *job = of;
    const bat_mesh_train_options *options = &job->mesh;
    const bat_mesh_train_report *report = &job->mesh_report;
    static const char PUBLISHED_TEXT[] =
        EPOCHS_TEXT ". [losses?Roots of the losses of validation meshes,][!losses?Errors of validation meshes, root mean "
                    "squares in units of the longest side,]\nat levels 0, 1, 2: {level0:.5f}, {level1:.5f}, "
                    "{level2:.5f}\n\n" MODEL_TEXT;
    static const char BATTEN_TEXT[] =
        "{epochs} epochs, the last weights. Mean distance of validation meshes over the best classical scheme's: "
        "{best:.3f}\nat best.\n\n" MODEL_TEXT;
    const double *errors = report->errors;
    return report_print(job->call.json, job->recipe == BAT_RECIPE_BATTEN ? BATTEN_TEXT : PUBLISHED_TEXT,
                        RUN_KEYS "errors:o -losses:b -best:n -level0:n -level1:n -level2:n",
                        RUN_VALUES(job->recipe, &options->run, &report->run),
                        report_numbers(errors, BAT_MESH_TRAIN_LEVELS + 1), (int)(options->surface || options->chamfer),
                        report->run.best, errors[0], errors[1], errors[2]);
}

static void end_mesh(void *of)
{
    train_job *job = of;
    for (size_t s = 0; s < MAX_POSITIONAL; s++)
        bat_mesh_free(&job->shapes[s]);
}

// Surfaces

static const option_spec SURFACE_OPTIONS[] = {
    {"recipe", "NAME", METHOD, COMMON,
     "published: the network, clouds and loss of Giannelli et al., \"BIDGCN\" (2023); the default. batten: that of the "
     "shipped weights",
     NO_FIELD},
    {"uninformed", NULL, METHOD, 0,
     "published: boundary points are treated as interior ones, without their parameters (section 6.1)",
     FLAG(train_job, surface.uninformed)},
    {"steps", "N", METHOD, COMMON, "per epoch; default 1000; batten: 500", WHOLE(train_job, surface.steps, 1, 1000000)},
    {"batch", "N", METHOD, 0, "clouds per step, shared by as many threads; default 1; batten: 32",
     WHOLE(train_job, surface.batch, 1, 1000)},
    {"points", "A-B", METHOD, 0,
     "interior points of a cloud, drawn uniformly in the logarithm; default 1000; batten: 50-2000", NO_FIELD},
    {"degree", "A-B", METHOD, 0, "bidegree of a cloud, drawn uniformly; default 2; batten: 2-5", NO_FIELD},
    {"noise", "D", METHOD, 0, "standard deviations are drawn from 0 to D; default 0; batten: 0.05",
     NUMBER(train_job, surface.noise)},
    {"rate", "R", METHOD, 0, "the highest learning rate; default 0.1; with --adam and for batten 0.001",
     NUMBER(train_job, surface.rate)},
    {"adam", NULL, METHOD, 0,
     "AdamW and cosine decay of the rate; else gradient descent, with the rate halved where the validation error no longer "
     "falls",
     FLAG(train_job, surface.adam)},
    END_OF_OPTIONS,
};

static void begin_surface(void *to)
{
    train_job *job = to;
    job->recipe = recipe_of(job);
    job->surface = bat_surface_train_defaults(job->recipe);
    if (argument(job->call.given, "adam") != NULL)
        job->surface.rate = 1e-3;
    begin_run(job, &job->surface.run, "out/surface", "out/surface");
}

static bool check_surface(void *of)
{
    static const char *const none[] = {NULL};
    train_job *job = of;
    const arguments *given = job->call.given;
    bat_surface_train_options *options = &job->surface;
    int without;
    long points[2] = {(long)options->min_points, (long)options->max_points};
    long degree[2] = {options->min_degree, options->max_degree};
    if (options->uninformed && job->recipe == BAT_RECIPE_BATTEN)
        return usage_refused(given, "only the published recipe has --uninformed");
    if (!check_run(job, none, &without) || !read_range(given, "points", true, 1, BAT_SURFACE_TRAIN_MAX_POINTS, points) ||
        !read_range(given, "degree", true, 1, BAT_SURFACE_TRAIN_MAX_DEGREE, degree))
        return false;
    options->min_points = (size_t)points[0];
    options->max_points = (size_t)points[1];
    options->min_degree = (int)degree[0];
    options->max_degree = (int)degree[1];
    return true;
}

static int train_surface(void *of)
{
    train_job *job = of;
    job->surface.run.progress = report_progress("training");
    return report_status(job->call.given, NULL, bat_surface_train(&job->surface, &job->surface_report, report_error()));
}

static int report_surface(void *of)
{
    const train_job *job = of;
    const bat_train_report *report = &job->surface_report.run;
    return report_print(job->call.json,
                        EPOCHS_TEXT ". Validation clouds, fitted with their bidegree: mean squared error {error:.4g}, in "
                                    "units of the longest side\n\n" MODEL_TEXT,
                        RUN_KEYS "uninformed:b error:n", RUN_VALUES(job->recipe, &job->surface.run, report),
                        (int)job->surface.uninformed, report->best);
}

// The verbs

#define ABOUT_END " Ctrl-C writes a checkpoint and stops; with --resume the same command continues to the same result."

const verb VERB_TRAIN_CURVE = {
    .name = "train curve",
    .arguments = "[--recipe published|batten] [--epochs E] [-o FOLDER] [--resume] [options]",
    .summary = "train the learned curve scheme",
    .about = "Train the learned curve scheme." ABOUT_END
             " `batten train mesh --help` is about meshes, `batten train surface --help` about scattered points.",
    .example = "batten train curve --recipe batten -o out/fairing",
    .options = {{CURVE_OPTIONS, 0}, {RUN_OPTIONS, offsetof(train_job, curve.run)}, {JSON_OPTION, 0}},
    .job_size = sizeof(train_job),
    .calls = {begin_curve, check_curve, train_curve, NULL, report_curve, NULL},
};

const verb VERB_TRAIN_MESH = {
    .name = "train mesh",
    .arguments = "SHAPE... [--recipe published|batten] [--pairs N] [--epochs E] [-o FOLDER] [options]",
    .summary = "train a learned subdivision of meshes",
    .about = "Train a learned subdivision of meshes on shapes (see `batten list formats`)." ABOUT_END,
    .example = "batten train mesh bunny.obj horse.ply -o out/mesh",
    .options = {{MESH_OPTIONS, 0}, {RUN_OPTIONS, offsetof(train_job, mesh.run)}, {JSON_OPTION, 0}},
    .positional = {0, MAX_POSITIONAL},
    .job_size = sizeof(train_job),
    .calls = {begin_mesh, check_mesh, train_mesh, NULL, report_mesh, end_mesh},
};

const verb VERB_TRAIN_SURFACE = {
    .name = "train surface",
    .arguments = "[--recipe published|batten] [--epochs E] [-o FOLDER] [--resume] [options]",
    .summary = "train learned parameters of scattered points",
    .about = "Train learned parameters of scattered points on random Bézier clouds, made on the fly." ABOUT_END,
    .example = "batten train surface --recipe batten -o out/surface",
    .options = {{SURFACE_OPTIONS, 0}, {RUN_OPTIONS, offsetof(train_job, surface.run)}, {JSON_OPTION, 0}},
    .job_size = sizeof(train_job),
    .calls = {begin_surface, check_surface, train_surface, NULL, report_surface, NULL},
};

int train_in_group(int argc, char **argv, const bat_group *processes, int threads)
{
    static const verb *const KINDS[] = {&VERB_TRAIN_CURVE, &VERB_TRAIN_MESH, &VERB_TRAIN_SURFACE};
    const char *name = argc > 1 ? argv[1] : "";
    group = processes;
    default_threads = threads;
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0)
        return verb_run(KINDS[0], argc, argv);
    for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++)
        if (strcmp(name, KINDS[k]->name + strlen("train ")) == 0)
            return verb_run(KINDS[k], argc - 1, argv + 1);
    report_text(stderr, "batten: there is no model '%s' to train; there are curve, mesh and surface\n", name);
    (void)fputs("usage: batten train curve|mesh|surface [options]\n", stderr);
    return EXIT_BAD_USAGE;
}
