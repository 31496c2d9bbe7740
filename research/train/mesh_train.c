#include "batten/research/mesh_train.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "research/train/mesh_sample.h"
#include "research/train/train.h"
#include "research/train/train_files.h"
#include "research/train/train_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    LEVELS = BAT_MESH_TRAIN_LEVELS,
    KEPT = 5, ///< pairs of each shape that are kept aside
    CHECK_EVERY = 5,
    SAVE_EVERY = 5,
    NAME_SIZE = 512
};
static const size_t MOST_PAIRS = 10000000;

/// What is recorded of every step: the loss of each level.
static const char *const FIGURES[LEVELS + 1] = {"level_0", "level_1", "level_2"};
/// The loss on what is kept aside, and its root at each level.
static const char *const CHECKS[] = {"kept_loss", "kept_error_0", "kept_error_1", "kept_error_2"};
enum
{
    CHECK_COUNT = sizeof CHECKS / sizeof *CHECKS
};

typedef struct training
{
    const bat_mesh_train_options *options;
    learn_parameters parameters;
    mesh_pairs pairs, kept;
    size_t *order; ///< of the pairs in this epoch
} training;

bat_mesh_train_options bat_mesh_train_defaults(void)
{
    return (bat_mesh_train_options){
        .seed = 1,
        .epochs = 700,
        .pairs = 200,
        .batch = 1,
        .least_vertices = 150,
        .most_vertices = 300,
        .least_normal = 0.2,
        .least_quality = 0.2,
        .rate = 2e-3,
    };
}

bat_mesh_train_options bat_mesh_train_batten(void)
{
    bat_mesh_train_options options = bat_mesh_train_defaults();
    options.epochs = 400;
    options.pairs = 16;
    options.fresh = 24;
    options.batch = 2;
    options.most_vertices = 500;
    options.falling = true;
    options.relative = true;
    options.surface = true;
    return options;
}

static bat_status check_options(size_t shape_count, const bat_mesh_train_options *options, bat_error *error)
{
    if (shape_count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "training needs at least 1 shape");
    if (options->epochs == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "training needs at least 1 epoch");
    if (options->pairs == 0 || options->pairs > MOST_PAIRS / shape_count)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "%zu pairs of each of %zu shapes: there must be 1 to %zu in all", options->pairs, shape_count,
                         MOST_PAIRS);
    if (options->batch == 0 || options->batch > options->pairs * shape_count)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a batch of %zu meshes of %zu", options->batch,
                         options->pairs * shape_count);
    if (options->least_vertices < 4 || options->most_vertices < options->least_vertices)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "coarse meshes of %zu to %zu vertices: there must be 4 or more", options->least_vertices,
                         options->most_vertices);
    if (!(options->rate > 0) || !isfinite(options->rate))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the learning rate %g is not above 0", options->rate);
    return BAT_OK;
}

static mesh_network_form network_form(const bat_mesh_train_options *options)
{
    return (mesh_network_form){
        .fixed_frames = options->fixed_frames, .no_differences = options->no_differences, .relative = options->relative};
}

static mesh_sample_loss_form loss_form(const bat_mesh_train_options *options)
{
    return (mesh_sample_loss_form){
        .last_level = options->last_level, .chamfer = options->chamfer, .surface = options->surface};
}

// What learn_train() asks for

static void shuffle(training *t, bat_random *random)
{
    for (size_t i = 0; i < t->pairs.count; i++)
    {
        size_t j = (size_t)(bat_random_uniform(random) * (double)(i + 1));
        t->order[i] = t->order[j];
        t->order[j] = i;
    }
}

/// Forwards the wish to stop, and no share: that is of the training as a whole.
static bool report_begin(void *context, double fraction)
{
    (void)fraction;
    const bat_progress *progress = context;
    return progress->report(progress->context, 0);
}

/// Pairs, fresh ones too. Before the first step of a run there is nothing that a stop could lose; later the next step asks.
static bat_status begin_epoch(void *context, uint64_t epoch, bat_random *random, bat_error *error)
{
    training *t = context;
    bat_progress given = t->options->progress, progress = {0};
    if (t->pairs.made_for[0] == 0 && given.report != NULL)
        progress = (bat_progress){report_begin, &given};
    shuffle(t, random);
    bat_status status = mesh_pairs_renew(&t->kept, 0, t->options->threads, progress, error);
    return status == BAT_OK ? mesh_pairs_renew(&t->pairs, epoch, t->options->threads, progress, error) : status;
}

/// One mesh of a batch, with its share of the batch's mean.
static bat_status train_mesh(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *figures,
                             bat_error *error)
{
    (void)error;
    const training *t = context;
    size_t batch = t->options->batch, first = (size_t)piece->step * batch, left = t->pairs.count - first;
    size_t count = left < batch ? left : batch;
    if (piece->index >= count)
        return BAT_OK;
    double share = 1 / (double)count, errors[LEVELS + 1] = {0};
    const mesh_pair *pair = &t->pairs.pair[t->order[first + piece->index]];
    *loss = mesh_sample_loss(tape, network_form(t->options), loss_form(t->options), pair, errors);
    *loss = learn_scale(tape, *loss, (real)share);
    for (size_t level = 0; level <= LEVELS; level++)
        figures[level] = share * errors[level];
    return BAT_OK;
}

/// The mean loss on what is kept aside, and that of each level.
static bat_status measure(training *t, double *loss, double *errors, bat_error *error)
{
    learn_tape tape = learn_tape_make();
    bat_status status = mesh_pairs_renew(&t->kept, 0, t->options->threads, (bat_progress){0}, error);
    *loss = 0;
    memset(errors, 0, (LEVELS + 1) * sizeof *errors);
    for (size_t p = 0; p < t->kept.count && status == BAT_OK; p++)
    {
        double own[LEVELS + 1] = {0}, share = 1 / (double)t->kept.count;
        learn_tape_begin(&tape, &t->parameters, NULL);
        const learn_array *made =
            mesh_sample_loss(&tape, network_form(t->options), loss_form(t->options), &t->kept.pair[p], own);
        status = learn_tape_status(&tape, error);
        if (status != BAT_OK)
            break;
        *loss += share * (double)*made->value;
        for (size_t level = 0; level <= LEVELS; level++)
            errors[level] += share * own[level];
    }
    learn_tape_free(&tape);
    return status;
}

static bat_status check(void *context, uint64_t epoch, double *figures, bat_error *error)
{
    (void)epoch;
    bat_status status = measure(context, &figures[0], &figures[1], error);
    for (size_t level = 0; level <= LEVELS; level++)
        figures[1 + level] = sqrt(figures[1 + level]);
    return status;
}

// All of it

/// Everything but the seed that makes one training another, as the name by which a checkpoint is known.
static void write_name(const bat_mesh *shapes, size_t shape_count, const bat_mesh_train_options *options,
                       char name[NAME_SIZE])
{
    uint64_t hash = HASH_BEGIN;
    for (size_t s = 0; s < shape_count; s++)
    {
        hash = hash_bytes(hash, shapes[s].positions, shapes[s].vertex_count * 3 * sizeof *shapes[s].positions);
        hash = hash_bytes(hash, shapes[s].faces, shapes[s].face_count * 3 * sizeof *shapes[s].faces);
    }
    (void)snprintf(
        name, NAME_SIZE,
        "mesh published, %llu epochs, %zu pairs of each of %zu shapes (%016llx), %zu fresh, batch %zu, %zu to %zu "
        "vertices, normal %.9g, quality %.9g, rate %.9g%s%s%s%s%s%s%s%s",
        (unsigned long long)options->epochs, options->pairs, shape_count, (unsigned long long)hash, options->fresh,
        options->batch, options->least_vertices, options->most_vertices, options->least_normal, options->least_quality,
        options->rate, options->falling ? " falling" : "", options->fixed_frames ? MESH_NETWORK_FIXED : "",
        options->no_differences ? ", no differential coordinates" : "", options->relative ? MESH_NETWORK_RELATIVE : "",
        options->last_level ? ", last level" : "", options->chamfer ? ", Chamfer" : "",
        options->surface ? ", off the surface" : "", options->learn_loop ? ", Loop" : "");
}

static bat_status training_make(const bat_mesh *shapes, size_t shape_count, const bat_mesh_train_options *options,
                                training *t, bat_error *error)
{
    *t = (training){.options = options};
    mesh_pair_plan plan = {.levels = LEVELS,
                           .least_vertices = options->least_vertices,
                           .most_vertices = options->most_vertices,
                           .least_normal = options->least_normal,
                           .least_quality = options->least_quality,
                           .loop = options->learn_loop};
    size_t count = options->pairs * shape_count;
    bat_status status = mesh_network_make(network_form(options), &t->parameters, error);
    if (status != BAT_OK)
        return status;
    mesh_network_start(&t->parameters, options->seed);
    // Seeds of neighbouring numbers are unrelated; what is kept aside has one that no training has.
    status = mesh_pairs_begin(shapes, shape_count, count, &plan, options->seed, options->fresh, &t->pairs, error);
    if (status == BAT_OK)
        status = mesh_pairs_begin(shapes, shape_count, KEPT * shape_count, &plan, ~options->seed, 0, &t->kept, error);
    t->order = memory_array(count, sizeof *t->order);
    if (status == BAT_OK && t->order == NULL)
        status = error_memory(error, count * sizeof *t->order);
    return status;
}

static void training_free(training *t)
{
    learn_parameters_free(&t->parameters);
    mesh_pairs_free(&t->pairs);
    mesh_pairs_free(&t->kept);
    free(t->order);
}

/// Appendix F.
static learn_options learning_of(const bat_mesh_train_options *given, const char *name, const train_files *files)
{
    learn_options options = learn_options_defaults();
    options.epochs = given->epochs;
    options.optimizer =
        (learn_optimizer_options){.rule = LEARN_ADAM, .momentum = 0.9, .second = 0.999, .epsilon = 1e-8, .decay = 0};
    options.schedule = (learn_schedule){
        .kind = given->falling ? LEARN_COSINE : LEARN_CONSTANT, .rate = given->rate, .epochs = given->epochs};
    options.seed = given->seed;
    options.threads = given->threads;
    options.check_every = CHECK_EVERY;
    options.checkpoint_every = SAVE_EVERY;
    options.name = name;
    options.resume = given->resume;
    options.progress = given->progress;
    train_files_use(files, &options);
    return options;
}

static bat_status run(training *t, const learn_options *options, learn_report *made, bat_error *error)
{
    learn_job job = {
        .context = t,
        .parameters = &t->parameters,
        .steps = (t->pairs.count + t->options->batch - 1) / t->options->batch,
        .pieces = t->options->batch,
        .figures = FIGURES,
        .figure_count = LEVELS + 1,
        .checks = CHECKS,
        .check_count = CHECK_COUNT,
        .epoch = begin_epoch,
        .piece = train_mesh,
        .check = check,
    };
    return learn_train(&job, options, made, error);
}

static bat_status fill_report(training *t, const learn_report *made, bat_mesh_train_report *report, bat_error *error)
{
    bat_mesh_train_report filled = {.epochs = made->epochs, .best_epoch = made->best_epoch + 1, .loss = made->loss};
    double loss;
    bat_status status = measure(t, &loss, filled.errors, error);
    for (size_t level = 0; level <= LEVELS; level++)
        filled.errors[level] = sqrt(filled.errors[level]);
    if (status == BAT_OK)
        *report = filled;
    return status;
}

bat_status bat_mesh_train(const bat_mesh *shapes, size_t shape_count, const bat_mesh_train_options *options,
                          bat_mesh_train_report *report, bat_error *error)
{
    bat_mesh_train_options defaults = bat_mesh_train_defaults();
    if (options == NULL)
        options = &defaults;
    training t = {0};
    train_files files;
    learn_report made;
    char name[NAME_SIZE];
    bat_status status = check_options(shape_count, options, error);
    if (status == BAT_OK)
        status = train_files_make(options->folder, &files, error);
    if (status == BAT_OK)
        status = training_make(shapes, shape_count, options, &t, error);
    if (status == BAT_OK)
    {
        write_name(shapes, shape_count, options, name);
        learn_options learning = learning_of(options, name, &files);
        status = run(&t, &learning, &made, error);
    }
    if (status == BAT_OK && options->folder != NULL)
        status = train_model_write(files.model, &t.parameters, name, options->seed, &made, "kept_loss", error);
    if (status == BAT_OK && report != NULL)
        status = fill_report(&t, &made, report, error);
    training_free(&t);
    return status;
}
