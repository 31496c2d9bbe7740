#include "research/train/mesh_batten.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "batten/research/mesh_shapes.h"
#include "research/train/mesh_pairs.h"
#include "research/train/mesh_task.h"
#include "research/train/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    OWN_SHAPES = BAT_MESH_TRAINING_SHAPES,
    SHAPE_VERTICES = 10000,
    SAMPLES = 1200, ///< of both surfaces, in a step
    VALIDATION_SAMPLES = 4000,
    VALIDATION_VERTICES = 300
};

/// In the second half the hinge grows: first the network learns the mean, then to be behind nowhere.
static const mesh_task_weights WEIGHTS[3] = {
    {.hinge = 1, .rms = 0.3, .rough = {0.04, 16}, .volume = {4, 20}},
    {.hinge = 2, .rms = 0.3, .rough = {0.04, 16}, .volume = {4, 20}},
    // Of a training that begins with trained weights: the worst meshes and the largest distances count more.
    {.hinge = 4, .margin = 0.05, .rms = 0.3, .peak = 0.15, .rough = {0.04, 16}, .volume = {4, 20}},
};
/// The fairness of four samples in ten is the default; that of the others is uniform.
static const double DEFAULT_SHARE = 0.4, DEFAULT_FAIRNESS = 0.25;
/// Shares of the ways to make coarse meshes, cumulative.
static const double KIND_SHARE[COARSE_KINDS] = {
    [COARSE_QUADRIC] = 0.25, [COARSE_KEPT] = 0.45, [COARSE_MEMORYLESS] = 0.73, [COARSE_MIDDLE] = 0.8, [COARSE_REMESHED] = 1};

/// Shapes of the validation.
static const struct
{
    const char *name;
    uint64_t seed;
} HELD[] = {{"creature", 101}, {"bust", 101},  {"bracket", 101}, {"lathe", 101},
            {"casting", 101},  {"stone", 101}, {"gear", 101},    {"cactus", 101}};

enum
{
    HELD_SHAPES = sizeof HELD / sizeof *HELD,
    VALIDATION_TASKS = HELD_SHAPES * COARSE_KINDS
};

/// What is recorded of every step.
static const char *const METRICS[] = {"distance", "roughness", "volume"};
/// Of the validation at the default fairness: the geometric mean of the distance over the best classical one, that of each
/// kind, the worst, the roughness over Loop's, the error of the volume; and the latter two at fairness 1.
static const char *const VALIDATION[] = {"distance", "quadric", "kept",   "memoryless", "middle",  "remeshed",
                                         "worst",    "rough",   "volume", "distance_1", "rough_1", "volume_1"};

typedef struct training
{
    train_context base;
    const bat_mesh_train_options *options;
    const bat_mesh *given;
    size_t given_count;
    mesh_target *targets; ///< of the given shapes, then our own
    size_t target_count;
    mesh_target held[HELD_SHAPES];
    mesh_task validation[VALIDATION_TASKS];
    mesh_task *tasks;
    uint64_t *made_for; ///< of each task, the epoch that made it, plus 1; 0: not made
    size_t task_count;
    size_t *order; ///< of the tasks in this epoch
    bool *own;     ///< of each task, whether this process needs it in this epoch
    bool prepared; ///< whether an epoch was
} training;

// Data

static bat_status make_targets(training *t, bat_error *error)
{
    size_t count = t->given_count + OWN_SHAPES;
    int threads = t->options->run.threads;
    bat_mesh own[OWN_SHAPES] = {0}, copy;
    t->targets = calloc(count, sizeof *t->targets);
    if (t->targets == NULL)
        return error_memory(error, count * sizeof *t->targets);
    bat_progress progress = t->options->run.progress;
    bat_status status = bat_mesh_training_shapes(own, threads, train_progress_before(&progress), error);
    for (size_t s = 0; s < count && status == BAT_OK; s++)
    {
        bool given = s < t->given_count;
        copy = given ? (bat_mesh){0} : own[s - t->given_count];
        if (given)
            status = bat_mesh_copy(&t->given[s], &copy, error);
        else
            own[s - t->given_count] = (bat_mesh){0};
        if (status == BAT_OK)
            status = mesh_target_make(&copy, s, &t->targets[s], error);
        bat_mesh_free(&copy);
        t->target_count += status == BAT_OK;
    }
    for (size_t s = 0; s < OWN_SHAPES; s++)
        bat_mesh_free(&own[s]);
    for (size_t s = 0; s < HELD_SHAPES && status == BAT_OK; s++)
    {
        status = bat_mesh_shape(HELD[s].name, SHAPE_VERTICES, HELD[s].seed, &copy, error);
        if (status == BAT_OK)
            status = mesh_target_make(&copy, s, &t->held[s], error);
    }
    return status;
}

/// Make a task by random numbers that depend on its seed alone.
static bat_status draw_task(const training *t, size_t p, uint64_t epoch, mesh_task *task, bat_error *error)
{
    const bat_mesh_train_options *o = t->options;
    bat_random random = bat_random_seed(mesh_pair_seed(o->run.seed, p, epoch));
    const mesh_target *target = &t->targets[p % t->target_count];
    double share = bat_random_uniform(&random);
    coarse_kind kind = 0;
    while (kind + 1 < COARSE_KINDS && share >= KIND_SHARE[kind])
        kind++;
    if (!target->closed)
        kind = COARSE_QUADRIC;
    // Logarithmically uniform.
    double low = log((double)o->min_vertices), high = log((double)o->max_vertices);
    size_t vertices = (size_t)exp(low + (high - low) * bat_random_uniform(&random));
    return mesh_task_make(target, kind, vertices, &random, task, error);
}

/// Every process makes the tasks that it will measure.
static bat_status make_validation(training *t, bat_error *error)
{
    group_items tasks = group_items_of(t->options->run.group, VALIDATION_TASKS);
    shared_work work = shared_work_make(VALIDATION_TASKS, (bat_progress){0});
#pragma omp parallel for schedule(dynamic) num_threads(threads_for(t->options->run.threads, VALIDATION_TASKS))
    for (size_t i = tasks.begin; i < tasks.end; i++)
    {
        bat_error own;
        if (!shared_work_wants(&work, i))
            continue;
        bat_random random = bat_random_seed(i);
        bat_status status = mesh_task_make(&t->held[i / COARSE_KINDS], (coarse_kind)(i % COARSE_KINDS), VALIDATION_VERTICES,
                                           &random, &t->validation[i], &own);
        shared_work_finish(&work, i, status, &own);
    }
    return shared_work_end(&work, error);
}

static bat_status make(void *context, bat_error *error)
{
    training *t = context;
    const bat_mesh_train_options *o = t->options;
    bat_status status = make_targets(t, error);
    if (status == BAT_OK)
        status = make_validation(t, error);
    if (status == BAT_OK)
        status = mesh_learned_make(&t->base.parameters, error);
    if (status != BAT_OK)
        return status;
    mesh_learned_start(&t->base.parameters, o->run.seed);
    if (o->begin != NULL)
        status = train_begin(&t->base, o->begin, error);
    if (status != BAT_OK)
        return status;
    t->task_count = o->pairs * t->target_count;
    t->tasks = calloc(t->task_count, sizeof *t->tasks);
    t->made_for = calloc(t->task_count, sizeof *t->made_for);
    t->order = memory_array(t->task_count, sizeof *t->order);
    t->own = memory_array(t->task_count, sizeof *t->own);
    if (t->tasks == NULL || t->made_for == NULL || t->order == NULL || t->own == NULL)
        return error_memory(error, t->task_count * sizeof *t->tasks);
    return BAT_OK;
}

static void training_free(training *t)
{
    for (size_t p = 0; p < t->task_count && t->tasks != NULL; p++)
        mesh_task_free(&t->tasks[p]);
    for (size_t i = 0; i < VALIDATION_TASKS; i++)
        mesh_task_free(&t->validation[i]);
    for (size_t s = 0; s < t->target_count; s++)
        mesh_target_free(&t->targets[s]);
    for (size_t s = 0; s < HELD_SHAPES; s++)
        mesh_target_free(&t->held[s]);
    free(t->tasks);
    free(t->made_for);
    free(t->targets);
    free(t->order);
    free(t->own);
    learn_parameters_free(&t->base.parameters);
}

// Recipe

static bat_status check(const void *context, bat_error *error)
{
    const training *t = context;
    const bat_mesh_train_options *o = t->options;
    size_t shapes = t->given_count + OWN_SHAPES;
    if (o->fixed_frames || o->no_differences || o->last_level || o->chamfer || o->learn_loop || o->relative || o->surface)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the ablations are of the published network: recipe published");
    size_t most = BAT_MESH_TRAIN_MAX_PAIRS / shapes;
    const train_range ranges[] = {
        {"pairs", (double)o->pairs, 1, (double)most, false, false},
        {"resampled", (double)o->resampled, 0, BAT_MESH_TRAIN_MAX_PAIRS, false, false},
        {"batch", (double)o->batch, 1, (double)(o->pairs * shapes), false, false},
        {"min_vertices", (double)o->min_vertices, 20, BAT_MESH_TRAIN_MAX_VERTICES, false, false},
        {"max_vertices", (double)o->max_vertices, (double)o->min_vertices, BAT_MESH_TRAIN_MAX_VERTICES, false, false},
        {"rate", o->rate, 0, INFINITY, true, false},
    };
    return train_check_ranges(ranges, sizeof ranges / sizeof *ranges, error);
}

static void configure(const void *context, learn_job *job, learn_options *options)
{
    const training *t = context;
    job->steps = (t->task_count + t->options->batch - 1) / t->options->batch;
    job->pieces = t->options->batch;
    options->schedule.kind = t->options->cosine_decay ? LEARN_COSINE : LEARN_CONSTANT;
    options->schedule.rate = t->options->rate;
    options->keep_last = true;
}

static void describe(const void *context, char text[TRAIN_TEXT_SIZE])
{
    const training *t = context;
    const bat_mesh_train_options *o = t->options;
    uint64_t hash = HASH_BEGIN;
    for (size_t s = 0; s < t->target_count; s++)
    {
        const bat_mesh *shape = &t->targets[s].shape;
        hash = hash_bytes(hash, shape->positions, shape->vertex_count * 3 * sizeof *shape->positions);
        hash = hash_bytes(hash, shape->faces, shape->face_count * 3 * sizeof *shape->faces);
    }
    (void)snprintf(text, TRAIN_TEXT_SIZE,
                   "mesh batten, %llu epochs, %zu coarse meshes of each of %zu shapes (%016llx), %zu resampled, batch %zu, "
                   "%zu to %zu vertices, rate %.9g%s",
                   (unsigned long long)o->run.epochs, o->pairs, t->target_count, (unsigned long long)hash, o->resampled,
                   o->batch, o->min_vertices, o->max_vertices, o->rate, o->cosine_decay ? " with cosine decay" : "");
    train_describe_begin(&t->base, text);
}

static bat_status prepare_epoch(void *context, uint64_t epoch, bat_random *random, bat_error *error)
{
    training *t = context;
    size_t resampled = t->options->resampled < t->task_count ? t->options->resampled : t->task_count;
    train_shuffle(t->order, t->task_count, random);
    train_own_samples(&t->options->run, t->order, t->task_count, t->options->batch, t->own);
    // Before the first step of a run nothing is lost by a stop; later the next step reports.
    bat_progress given = t->options->run.progress, none = {0};
    shared_work work = shared_work_make(t->task_count, t->prepared ? none : train_progress_before(&given));
    t->prepared = true;
#pragma omp parallel for schedule(dynamic) num_threads(threads_for(t->options->run.threads, t->task_count))
    for (size_t p = 0; p < t->task_count; p++)
    {
        bat_error own;
        bat_status status = BAT_OK;
        uint64_t from = mesh_pair_epoch(t->task_count, resampled, p, epoch);
        if (!shared_work_wants(&work, p))
            continue;
        if (t->own[p] && t->made_for[p] != from + 1)
        {
            mesh_task made;
            status = draw_task(t, p, from, &made, &own);
            if (status == BAT_OK)
            {
                mesh_task_free(&t->tasks[p]);
                t->tasks[p] = made;
                t->made_for[p] = from + 1;
            }
        }
        shared_work_finish(&work, p, status, &own);
    }
    return shared_work_end(&work, error);
}

/// One mesh of a batch, with its share of the batch's mean.
static bat_status piece_loss(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *metrics,
                             bat_error *error)
{
    (void)error;
    const training *t = context;
    size_t batch = t->options->batch, first = (size_t)piece->step * batch, left = t->task_count - first;
    size_t count = left < batch ? left : batch;
    if (piece->index >= count)
        return BAT_OK;
    const mesh_task *task = &t->tasks[t->order[first + piece->index]];
    double share = 1 / (double)count, drawn = bat_random_uniform(&piece->random),
           uniform = bat_random_uniform(&piece->random);
    const mesh_task_weights *weights = &WEIGHTS[t->options->begin != NULL                    ? 2
                                                : 2 * piece->epoch >= t->options->run.epochs ? 1
                                                                                             : 0];
    mesh_fit fit = {0};
    *loss = mesh_task_loss(tape, task, drawn < DEFAULT_SHARE ? DEFAULT_FAIRNESS : uniform, weights, SAMPLES, &piece->random,
                           &fit);
    *loss = learn_scale(tape, *loss, (real)share);
    metrics[0] = share * mesh_task_ratio(task, &fit);
    metrics[1] = share * fit.roughness / (task->best.roughness + 1e-3);
    metrics[2] = share * fabs(fit.volume);
    return BAT_OK;
}

/// A validation task: the logarithm of mesh_task_ratio(), and the measures.
typedef struct measured
{
    double ratio, roughness, best_roughness, volume;
} measured;

/// Measure the validation tasks at one fairness.
static bat_status measure(training *t, double fairness, measured *all, bat_error *error)
{
    group_items tasks = group_items_of(t->options->run.group, VALIDATION_TASKS);
    shared_work work = shared_work_make(VALIDATION_TASKS, (bat_progress){0});
#pragma omp parallel for schedule(dynamic) num_threads(threads_for(t->options->run.threads, VALIDATION_TASKS))
    for (size_t i = tasks.begin; i < tasks.end; i++)
    {
        bat_error own;
        mesh_fit fit = {0};
        const mesh_task *task = &t->validation[i];
        if (!shared_work_wants(&work, i))
            continue;
        learn_tape tape = learn_tape_make();
        bat_random random = bat_random_seed(i);
        learn_tape_begin(&tape, &t->base.parameters, NULL);
        (void)mesh_task_loss(&tape, task, fairness, &WEIGHTS[0], VALIDATION_SAMPLES, &random, &fit);
        bat_status status = learn_tape_status(&tape, &own);
        learn_tape_free(&tape);
        all[i] = (measured){log(mesh_task_ratio(task, &fit)), fit.roughness, task->best.roughness, fit.volume};
        shared_work_finish(&work, i, status, &own);
    }
    return group_collect(t->options->run.group, all, sizeof *all, VALIDATION_TASKS, shared_work_end(&work, error), error);
}

static bat_status validate(void *context, double *metrics, bat_error *error)
{
    training *t = context;
    measured all[VALIDATION_TASKS];
    double *distance = metrics, *kinds = metrics + 1, *worst = kinds + COARSE_KINDS;
    memset(metrics, 0, sizeof VALIDATION / sizeof *VALIDATION * sizeof *metrics);
    for (int fair = 0; fair < 2; fair++)
    {
        bat_status status = measure(t, fair ? 1 : DEFAULT_FAIRNESS, all, error);
        if (status != BAT_OK)
            return status;
        double *rough = fair ? worst + 4 : worst + 1, *mean = fair ? worst + 3 : distance;
        for (size_t i = 0; i < VALIDATION_TASKS; i++)
        {
            double ratio = all[i].ratio, share = 1.0 / VALIDATION_TASKS;
            *mean += share * ratio;
            rough[0] += share * all[i].roughness / all[i].best_roughness;
            rough[1] += share * fabs(all[i].volume);
            if (fair)
                continue;
            kinds[i % COARSE_KINDS] += ratio / HELD_SHAPES;
            *worst = fmax(*worst, exp(ratio));
        }
        *mean = exp(*mean);
    }
    for (size_t k = 0; k < COARSE_KINDS; k++)
        kinds[k] = exp(kinds[k]);
    return BAT_OK;
}

static const train_recipe RECIPE = {
    .columns = {METRICS, sizeof METRICS / sizeof *METRICS, VALIDATION, sizeof VALIDATION / sizeof *VALIDATION},
    .optimizer = {.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.99, .epsilon = 1e-8, .decay = 1e-3},
    .plateau = {.reduce_factor = 0.5},
    .clip = 1,
    .validate_every = 4,
    .checkpoint_every = 4,
    .check = check,
    .make = make,
    .configure = configure,
    .describe = describe,
    .prepare_epoch = prepare_epoch,
    .piece_loss = piece_loss,
    .validate = validate,
};
static const train_recipe *const RECIPES[TRAIN_RECIPES] = {[BAT_RECIPE_BATTEN] = &RECIPE};

bat_status mesh_batten_train(const bat_mesh *shapes, size_t shape_count, const bat_mesh_train_options *options,
                             bat_mesh_train_report *report, bat_error *error)
{
    training t = {.base.options = &options->run, .options = options, .given = shapes, .given_count = shape_count};
    bat_mesh_train_report made = {0};
    for (size_t level = 0; level <= BAT_MESH_TRAIN_LEVELS; level++)
        made.errors[level] = NAN;
    bat_status status = train_run(RECIPES, BAT_RECIPE_BATTEN, &t, &made.run, error);
    if (status == BAT_OK && report != NULL)
        *report = made;
    training_free(&t);
    return status;
}
