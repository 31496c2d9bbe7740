#include "batten/research/mesh_train.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "batten/research/mesh_shapes.h"
#include "research/train/mesh_batten.h"
#include "research/train/mesh_sample.h"
#include "research/train/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    LEVELS = BAT_MESH_TRAIN_LEVELS,
    VALIDATION_PAIRS = 5, ///< of each shape
    OWN_SHAPES = BAT_MESH_TRAINING_SHAPES,
    SHAPE_VERTICES = 10000
};

/// What is recorded of every step: the loss of each level.
static const char *const METRICS[LEVELS + 1] = {"level_0", "level_1", "level_2"};
/// The loss of the validation pairs, and its root at each level.
static const char *const VALIDATION[] = {"validation_loss", "validation_error_0", "validation_error_1",
                                         "validation_error_2"};

typedef struct training
{
    train_context base;
    const bat_mesh_train_options *options;
    const bat_mesh *given; ///< the caller's shapes
    size_t given_count;
    bat_mesh *shapes; ///< the given ones, not copied, then our own
    size_t shape_count;
    mesh_pairs pairs, validation;
    size_t *order; ///< of the pairs in this epoch
    /// Of each pair, whether this process needs it in this epoch; of each validation pair, whether it measures it.
    bool *own, *own_validation;
    bool prepared; ///< whether an epoch was
} training;

// Shapes

/// About as many machined shapes, with flat faces and sharp edges, as organic ones.
static const struct
{
    const char *name;
    uint64_t seed;
} SHAPES[OWN_SHAPES] = {{"creature", 1}, {"creature", 2}, {"creature", 3}, {"creature", 4}, {"figure", 1},  {"figure", 2},
                        {"bust", 1},     {"bust", 2},     {"bust", 3},     {"mask", 1},     {"mask", 2},    {"cactus", 1},
                        {"cactus", 2},   {"coral", 1},    {"pretzel", 1},  {"stone", 1},    {"stone", 2},   {"stone", 3},
                        {"bracket", 1},  {"bracket", 2},  {"bracket", 3},  {"bracket", 4},  {"gear", 1},    {"gear", 2},
                        {"lathe", 1},    {"lathe", 2},    {"lathe", 3},    {"casting", 1},  {"casting", 2}, {"casting", 3},
                        {"casting", 4},  {"casting", 5},  {"bracket", 5},  {"lathe", 4},    {"gem", 1},     {"gem", 2},
                        {"cam", 1},      {"cam", 2},      {"block", 1},    {"block", 2},    {"knot", 1},    {"knot", 2},
                        {"relief", 1},   {"shell", 1}};

bat_status bat_mesh_training_shapes(bat_mesh *shapes, int threads, bat_progress progress, bat_error *error)
{
    shared_work work = shared_work_make(OWN_SHAPES, progress);
    for (size_t i = 0; i < OWN_SHAPES; i++)
        shapes[i] = (bat_mesh){0};
#pragma omp parallel for schedule(dynamic) num_threads(threads_for(threads, OWN_SHAPES))
    for (size_t i = 0; i < OWN_SHAPES; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error own;
        bat_status status = bat_mesh_shape(SHAPES[i].name, SHAPE_VERTICES, SHAPES[i].seed, &shapes[i], &own);
        shared_work_finish(&work, i, status, &own);
    }
    bat_status status = shared_work_end(&work, error);
    for (size_t i = 0; i < OWN_SHAPES && status != BAT_OK; i++)
        bat_mesh_free(&shapes[i]);
    return status;
}

// Options

bat_mesh_train_options bat_mesh_train_defaults(bat_recipe recipe)
{
    bool batten = recipe == BAT_RECIPE_BATTEN;
    return (bat_mesh_train_options){
        .run = {.seed = 1, .epochs = batten ? 200 : 700},
        .recipe = recipe,
        .pairs = batten ? 16 : 200,
        .resampled = batten ? 64 : 0,
        .batch = batten ? 4 : 1,
        .min_vertices = batten ? 100 : 150,
        .max_vertices = batten ? 500 : 300,
        .min_normal = 0.2,
        .min_quality = 0.2,
        .rate = 2e-3,
        .cosine_decay = batten,
    };
}

static size_t count_shapes(const training *t)
{
    return t->given_count;
}

static bat_status check(const void *context, bat_error *error)
{
    const training *t = context;
    const bat_mesh_train_options *o = t->options;
    size_t shapes = count_shapes(t);
    if (o->begin != NULL)
        return error_option(error, "begin", "is of the recipe batten");
    if (shapes == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "training needs at least 1 shape");
    size_t whole = BAT_MESH_TRAIN_MAX_PAIRS / shapes;
    double max_pairs = (double)whole;
    const train_range ranges[] = {
        {"pairs", (double)o->pairs, 1, max_pairs, false, false},
        {"resampled", (double)o->resampled, 0, BAT_MESH_TRAIN_MAX_PAIRS, false, false},
        {"batch", (double)o->batch, 1, (double)(o->pairs * shapes), false, false},
        {"min_vertices", (double)o->min_vertices, 4, BAT_MESH_TRAIN_MAX_VERTICES, false, false},
        {"max_vertices", (double)o->max_vertices, (double)o->min_vertices, BAT_MESH_TRAIN_MAX_VERTICES, false, false},
        {"min_normal", o->min_normal, -1, 1, false, false},
        {"min_quality", o->min_quality, 0, 1, false, false},
        {"rate", o->rate, 0, INFINITY, true, false},
    };
    return train_check_ranges(ranges, sizeof ranges / sizeof *ranges, error);
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

static void describe(const void *context, char text[TRAIN_TEXT_SIZE])
{
    const training *t = context;
    const bat_mesh_train_options *o = t->options;
    uint64_t hash = HASH_BEGIN;
    for (size_t s = 0; s < t->shape_count; s++)
    {
        const bat_mesh *shape = &t->shapes[s];
        hash = hash_bytes(hash, shape->positions, shape->vertex_count * 3 * sizeof *shape->positions);
        hash = hash_bytes(hash, shape->faces, shape->face_count * 3 * sizeof *shape->faces);
    }
    (void)snprintf(text, TRAIN_TEXT_SIZE,
                   "mesh %s, %llu epochs, %zu pairs of each of %zu shapes (%016llx), %zu resampled, batch %zu, %zu to %zu "
                   "vertices, normal %.9g, quality %.9g, rate %.9g%s%s%s%s%s%s%s%s",
                   bat_recipe_name(o->recipe), (unsigned long long)o->run.epochs, o->pairs, t->shape_count,
                   (unsigned long long)hash, o->resampled, o->batch, o->min_vertices, o->max_vertices, o->min_normal,
                   o->min_quality, o->rate, o->cosine_decay ? " with cosine decay" : "",
                   o->fixed_frames ? MESH_NETWORK_FIXED : "", o->no_differences ? ", no differential coordinates" : "",
                   o->relative ? MESH_NETWORK_RELATIVE : "", o->last_level ? ", last level" : "",
                   o->chamfer ? ", Chamfer" : "", o->surface ? ", off the surface" : "", o->learn_loop ? ", Loop" : "");
}

// Training

static bat_status make_shapes(training *t, bat_error *error)
{
    t->shapes = calloc(t->given_count, sizeof *t->shapes);
    if (t->shapes == NULL)
        return error_memory(error, t->given_count * sizeof *t->shapes);
    for (size_t s = 0; s < t->given_count; s++)
        t->shapes[s] = t->given[s];
    t->shape_count = t->given_count;
    return BAT_OK;
}

static bat_status make(void *context, bat_error *error)
{
    training *t = context;
    const bat_mesh_train_options *o = t->options;
    bat_status status = make_shapes(t, error);
    if (status == BAT_OK)
        status = mesh_network_make(network_form(o), &t->base.parameters, error);
    if (status != BAT_OK)
        return status;
    mesh_network_start(&t->base.parameters, o->run.seed);
    const mesh_pair_plan plan = {.levels = LEVELS,
                                 .min_vertices = o->min_vertices,
                                 .max_vertices = o->max_vertices,
                                 .min_normal = o->min_normal,
                                 .min_quality = o->min_quality,
                                 .loop = o->learn_loop};
    size_t count = o->pairs * t->shape_count;
    // Seeds of neighbouring numbers are unrelated. No training has the seed of its validation pairs.
    status = mesh_pairs_begin(t->shapes, t->shape_count, count, &plan, o->run.seed, o->resampled, &t->pairs, error);
    if (status == BAT_OK)
        status = mesh_pairs_begin(t->shapes, t->shape_count, VALIDATION_PAIRS * t->shape_count, &plan, ~o->run.seed, 0,
                                  &t->validation, error);
    t->order = memory_array(count, sizeof *t->order);
    t->own = memory_array(count, sizeof *t->own);
    t->own_validation = calloc(VALIDATION_PAIRS * t->shape_count, sizeof *t->own_validation);
    if (status == BAT_OK && (t->order == NULL || t->own == NULL || t->own_validation == NULL))
        status = error_memory(error, count * sizeof *t->order);
    if (status != BAT_OK)
        return status;
    group_items measured = group_items_of(o->run.group, VALIDATION_PAIRS * t->shape_count);
    for (size_t p = measured.begin; p < measured.end; p++)
        t->own_validation[p] = true;
    return BAT_OK;
}

static void training_free(training *t)
{
    for (size_t s = t->given_count; s < t->shape_count; s++)
        bat_mesh_free(&t->shapes[s]);
    free(t->shapes);
    learn_parameters_free(&t->base.parameters);
    mesh_pairs_free(&t->pairs);
    mesh_pairs_free(&t->validation);
    free(t->order);
    free(t->own);
    free(t->own_validation);
}

static void configure(const void *context, learn_job *job, learn_options *options)
{
    const training *t = context;
    job->steps = (t->pairs.count + t->options->batch - 1) / t->options->batch;
    job->pieces = t->options->batch;
    options->schedule.kind = t->options->cosine_decay ? LEARN_COSINE : LEARN_CONSTANT;
    options->schedule.rate = t->options->rate;
}

/// Make the pairs, resampled ones too. Before the first step of a run nothing is lost by a stop; later the next step
/// reports.
static bat_status prepare_epoch(void *context, uint64_t epoch, bat_random *random, bat_error *error)
{
    training *t = context;
    bat_progress given = t->options->run.progress, progress = {0};
    int threads = t->options->run.threads;
    if (!t->prepared)
        progress = train_progress_before(&given);
    t->prepared = true;
    train_shuffle(t->order, t->pairs.count, random);
    train_own_samples(&t->options->run, t->order, t->pairs.count, t->options->batch, t->own);
    bat_status status = mesh_pairs_renew(&t->validation, 0, t->own_validation, threads, progress, error);
    return status == BAT_OK ? mesh_pairs_renew(&t->pairs, epoch, t->own, threads, progress, error) : status;
}

/// One mesh of a batch, with its share of the batch's mean.
static bat_status piece_loss(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *metrics,
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
        metrics[level] = share * errors[level];
    return BAT_OK;
}

/// The loss of a validation pair, and its errors.
typedef struct measured
{
    double loss, errors[LEVELS + 1];
} measured;

static bat_status measure_pair(const training *t, size_t p, learn_tape *tape, measured *pair, bat_error *error)
{
    *pair = (measured){0};
    learn_tape_begin(tape, &t->base.parameters, NULL);
    const learn_array *made =
        mesh_sample_loss(tape, network_form(t->options), loss_form(t->options), &t->validation.pair[p], pair->errors);
    bat_status status = learn_tape_status(tape, error);
    if (status == BAT_OK)
        pair->loss = (double)*made->value;
    return status;
}

/// The mean loss of the validation pairs, and its root at each level.
static bat_status measure(training *t, double *loss, double *errors, bat_error *error)
{
    size_t count = t->validation.count;
    learn_tape tape = learn_tape_make();
    measured *all = calloc(count, sizeof *all);
    bat_status status = all != NULL ? mesh_pairs_renew(&t->validation, 0, t->own_validation, t->options->run.threads,
                                                       (bat_progress){0}, error)
                                    : error_memory(error, count * sizeof *all);
    for (size_t p = 0; p < count && status == BAT_OK; p++)
        if (t->own_validation[p])
            status = measure_pair(t, p, &tape, &all[p], error);
    status = group_collect(t->options->run.group, all, sizeof *all, count, status, error);
    *loss = 0;
    memset(errors, 0, (LEVELS + 1) * sizeof *errors);
    for (size_t p = 0; p < count && status == BAT_OK; p++)
    {
        double share = 1 / (double)count;
        *loss += share * all[p].loss;
        for (size_t level = 0; level <= LEVELS; level++)
            errors[level] += share * all[p].errors[level];
    }
    learn_tape_free(&tape);
    free(all);
    for (size_t level = 0; level <= LEVELS; level++)
        errors[level] = sqrt(errors[level]);
    return status;
}

static bat_status validate(void *context, double *metrics, bat_error *error)
{
    return measure(context, &metrics[0], &metrics[1], error);
}

// Optimizer and epochs are those of appendix F.
static const train_recipe RECIPE = {
    .columns = {METRICS, LEVELS + 1, VALIDATION, sizeof VALIDATION / sizeof *VALIDATION},
    .best_note = "validation_loss",
    .optimizer = {.rule = LEARN_ADAM, .momentum = 0.9, .second = 0.999, .epsilon = 1e-8},
    .plateau = {.reduce_factor = 0.5},
    .clip = HUGE_VAL,
    .validate_every = 5,
    .checkpoint_every = 5,
    .check = check,
    .make = make,
    .configure = configure,
    .describe = describe,
    .prepare_epoch = prepare_epoch,
    .piece_loss = piece_loss,
    .validate = validate,
};
static const train_recipe *const RECIPES[TRAIN_RECIPES] = {[BAT_RECIPE_PUBLISHED] = &RECIPE};

bat_status bat_mesh_train(const bat_mesh *shapes, size_t shape_count, const bat_mesh_train_options *options,
                          bat_mesh_train_report *report, bat_error *error)
{
    const bat_mesh_train_options defaults = bat_mesh_train_defaults(BAT_RECIPE_PUBLISHED);
    options = options != NULL ? options : &defaults;
    if (options->recipe == BAT_RECIPE_BATTEN)
        return mesh_batten_train(shapes, shape_count, options, report, error);
    training t = {.base.options = &options->run, .options = options, .given = shapes, .given_count = shape_count};
    bat_mesh_train_report made;
    double loss;
    bat_status status = train_run(RECIPES, options->recipe, &t, &made.run, error);
    if (status == BAT_OK && report != NULL)
    {
        status = measure(&t, &loss, made.errors, error);
        if (status == BAT_OK)
            *report = made;
    }
    training_free(&t);
    return status;
}
