#include "batten/research/surface_train.h"
#include "base/ascending.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "learn/blas.h"
#include "research/train/surface_sample.h"
#include "research/train/train.h"
#include "research/train/train_files.h"
#include "research/train/train_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    KEPT = 100, ///< clouds kept aside
    NAME_SIZE = 256,
    LEAST_POINTS = 4,
    MOST_POINTS = 100000,
    MOST_DEGREE = 15
};

/// What is recorded of every step: the residual, which with some networks is not all of the loss.
static const char *const FIGURES[] = {"error"};
/// Over the clouds kept aside: the mean error, what of it the true parameters do not leave, and the median error.
static const char *const CHECKS[] = {"kept_error", "kept_excess", "kept_median"};
enum
{
    FIGURE_COUNT = sizeof FIGURES / sizeof *FIGURES,
    CHECK_COUNT = sizeof CHECKS / sizeof *CHECKS
};

typedef struct training
{
    const bat_surface_train_options *options;
    const surface_network_training *kind;
    learn_parameters parameters;
    surface_sample *samples; ///< of the step under way, one a piece
    surface_sample kept[KEPT];
    double floor; ///< the mean error that the true parameters leave on them
} training;

bat_surface_train_options bat_surface_train_defaults(void)
{
    return (bat_surface_train_options){
        .seed = 1,
        .network = BAT_SURFACE_PUBLISHED,
        .epochs = 100,
        .steps = 1000,
        .batch = 1,
        .least_points = 1000,
        .most_points = 1000,
        .least_degree = 2,
        .most_degree = 2,
        .rate = 0.1,
    };
}

bat_surface_train_options bat_surface_train_batten(void)
{
    bat_surface_train_options options = bat_surface_train_defaults();
    options.network = BAT_SURFACE_BATTEN;
    options.least_points = 50;
    options.most_points = 2000;
    options.most_degree = 5;
    options.noise = 0.05;
    options.clean = 0.5;
    options.batch = 32;
    options.epochs = 60;
    options.steps = 500;
    options.rate = 1e-3;
    options.adam = true;
    return options;
}

static bat_status check_options(const bat_surface_train_options *options, bat_error *error)
{
    if (options->epochs == 0 || options->steps == 0 || options->batch == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "training needs at least 1 epoch, 1 step an epoch and 1 cloud a step");
    if (options->least_points < LEAST_POINTS || options->most_points < options->least_points ||
        options->most_points > MOST_POINTS)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "clouds of %zu to %zu points: there must be %d to %d",
                         options->least_points, options->most_points, LEAST_POINTS, MOST_POINTS);
    if (options->least_degree < 1 || options->most_degree < options->least_degree || options->most_degree > MOST_DEGREE)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "bidegrees of %d to %d: they must be 1 to %d",
                         options->least_degree, options->most_degree, MOST_DEGREE);
    if (!(options->noise >= 0) || !isfinite(options->noise))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the noise %g is below 0", options->noise);
    if (!(options->clean >= 0 && options->clean < 1))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the share %g of clouds without noise is not from 0 to below 1", options->clean);
    if (!(options->rate > 0) || !isfinite(options->rate))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the learning rate %g is not above 0", options->rate);
    if (surface_network_training_of(options->network, options->uninformed) == NULL)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "there is no such network for surfaces");
    return BAT_OK;
}

static surface_sample_range range_of(const bat_surface_train_options *options)
{
    return (surface_sample_range){.least_points = options->least_points,
                                  .most_points = options->most_points,
                                  .least_degree = options->least_degree,
                                  .most_degree = options->most_degree,
                                  .noise = options->noise,
                                  .clean = options->clean};
}

// What learn_train() asks for

static learn_array *loss_of(const surface_network_training *kind, learn_tape *tape, const surface_sample *sample,
                            learn_array **error_left)
{
    learn_array *interior = kind->predict(tape, &sample->cloud, sample->parameters);
    *error_left = surface_sample_residual(tape, sample, interior);
    return kind->loss != NULL ? kind->loss(tape, sample, interior) : *error_left;
}

/// One cloud of a batch, with its share of the batch's mean.
static bat_status train_cloud(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *figures,
                              bat_error *error)
{
    training *t = context;
    surface_sample *sample = &t->samples[piece->index];
    surface_sample_range range = range_of(t->options);
    double share = 1 / (double)t->options->batch;
    surface_sample_free(sample);
    bat_status status = surface_sample_draw(&range, &piece->random, sample, error);
    if (status != BAT_OK)
        return status;
    learn_array *left;
    learn_array *own = loss_of(t->kind, tape, sample, &left);
    *loss = learn_scale(tape, own, (real)share);
    if (learn_tape_status(tape, error) == BAT_OK)
        figures[0] = share * (double)*left->value;
    return learn_tape_status(tape, error);
}

static bat_status measure_cloud(const training *t, size_t k, learn_tape *tape, double *left, bat_error *error)
{
    const surface_sample *sample = &t->kept[k];
    learn_tape_begin(tape, &t->parameters, NULL);
    learn_array *interior = t->kind->predict(tape, &sample->cloud, sample->parameters);
    const learn_array *made = surface_sample_residual(tape, sample, interior);
    bat_status status = learn_tape_status(tape, error);
    *left = status == BAT_OK ? (double)*made->value : NAN;
    return status;
}

static bat_status check(void *context, uint64_t epoch, double *figures, bat_error *error)
{
    (void)epoch;
    const training *t = context;
    double left[KEPT], sum = 0;
    bat_status status = BAT_OK;
#pragma omp parallel num_threads(threads_for(t->options->threads, KEPT))
    {
        learn_tape tape = learn_tape_make();
#pragma omp for schedule(dynamic, 1)
        for (size_t k = 0; k < KEPT; k++)
        {
            bat_error own;
            bat_status own_status = measure_cloud(t, k, &tape, &left[k], &own);
            if (own_status != BAT_OK)
#pragma omp critical(surface_train_check)
            {
                status = own_status;
                if (error != NULL)
                    *error = own;
            }
        }
        learn_tape_free(&tape);
    }
    for (size_t k = 0; k < KEPT; k++)
        sum += left[k];
    figures[0] = sum / KEPT;
    figures[1] = figures[0] - t->floor;
    qsort(left, KEPT, sizeof *left, ascending);
    figures[2] = 0.5 * (left[KEPT / 2 - 1] + left[KEPT / 2]);
    return status;
}

// All of it

/// Everything but the seed that makes one training another, as the name by which a checkpoint is known. It begins with what
/// a model's file is known by.
static void write_name(const training *t, char name[NAME_SIZE])
{
    const bat_surface_train_options *o = t->options;
    (void)snprintf(name, NAME_SIZE,
                   "surface %s, %llu epochs of %zu steps, batch %zu, %zu to %zu points, bidegree %d to %d, noise %.9g but "
                   "for %.9g, %s, rate "
                   "%.9g",
                   t->kind->kind->name, (unsigned long long)o->epochs, o->steps, o->batch, o->least_points, o->most_points,
                   o->least_degree, o->most_degree, o->noise, o->clean, o->adam ? "Adam" : "gradient descent", o->rate);
}

/// Clouds kept aside have a seed that no training has, and are the same whatever is trained.
static bat_status keep_clouds(training *t, bat_error *error)
{
    bat_random random = bat_random_seed(~t->options->seed);
    surface_sample_range range = range_of(t->options);
    bat_status status = BAT_OK;
    for (size_t k = 0; k < KEPT && status == BAT_OK; k++)
    {
        double left = 0;
        status = surface_sample_draw(&range, &random, &t->kept[k], error);
        if (status == BAT_OK)
            status = surface_sample_floor(&t->kept[k], &left, error);
        t->floor += left / KEPT;
    }
    return status;
}

static bat_status training_make(const bat_surface_train_options *options, training *t, bat_error *error)
{
    *t = (training){.options = options, .kind = surface_network_training_of(options->network, options->uninformed)};
    t->samples = calloc(options->batch, sizeof *t->samples);
    if (t->samples == NULL)
        return error_memory(error, options->batch * sizeof *t->samples);
    bat_status status = t->kind->kind->make(&t->parameters, error);
    if (status != BAT_OK)
        return status;
    t->kind->start(&t->parameters, options->seed);
    return keep_clouds(t, error);
}

static void training_free(training *t)
{
    for (size_t i = 0; t->samples != NULL && i < t->options->batch; i++)
        surface_sample_free(&t->samples[i]);
    for (size_t k = 0; k < KEPT; k++)
        surface_sample_free(&t->kept[k]);
    free(t->samples);
    learn_parameters_free(&t->parameters);
}

/// Section 4.4, or AdamW with a rate that falls along half a wave.
static learn_options learning_of(const bat_surface_train_options *given, const char *name, const train_files *files)
{
    learn_options options = learn_options_defaults();
    options.epochs = given->epochs;
    if (given->adam)
    {
        options.optimizer =
            (learn_optimizer_options){.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.99, .epsilon = 1e-8, .decay = 0.01};
        options.schedule = (learn_schedule){
            .kind = LEARN_COSINE, .rate = given->rate, .warmup = given->epochs > 20 ? 1 : 0, .epochs = given->epochs};
    }
    else
    {
        options.optimizer = (learn_optimizer_options){.rule = LEARN_SGD};
        options.schedule = (learn_schedule){.kind = LEARN_CONSTANT, .rate = given->rate};
        options.watch = (learn_watch_options){.reduce_patience = 5, .reduce_factor = 0.5};
    }
    options.seed = given->seed;
    options.threads = given->threads;
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
        .steps = t->options->steps,
        .pieces = t->options->batch,
        .figures = FIGURES,
        .figure_count = FIGURE_COUNT,
        .checks = CHECKS,
        .check_count = CHECK_COUNT,
        .piece = train_cloud,
        .check = check,
    };
    return learn_train(&job, options, made, error);
}

bat_status bat_surface_train(const bat_surface_train_options *options, bat_surface_train_report *report, bat_error *error)
{
    bat_surface_train_options defaults = bat_surface_train_defaults();
    if (options == NULL)
        options = &defaults;
    training t = {.options = options};
    train_files files;
    learn_report made;
    char name[NAME_SIZE];
    bat_status status = check_options(options, error);
    if (status == BAT_OK)
        status = train_files_make(options->folder, &files, error);
    if (status == BAT_OK)
        status = training_make(options, &t, error);
    if (status == BAT_OK)
    {
        write_name(&t, name);
        learn_options learning = learning_of(options, name, &files);
        status = run(&t, &learning, &made, error);
    }
    if (status == BAT_OK && options->folder != NULL)
        status = train_model_write(files.model, &t.parameters, name, options->seed, &made, "kept_error", error);
    if (status == BAT_OK && report != NULL)
        *report = (bat_surface_train_report){
            .epochs = made.epochs, .best_epoch = made.best_epoch + 1, .loss = made.loss, .error = made.best};
    training_free(&t);
    return status;
}
