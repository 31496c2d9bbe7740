#include "batten/research/surface_train.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "research/train/run.h"
#include "research/train/surface_network_tape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    VALIDATION_CLOUDS = 100,
    MIN_POINTS = 4
};

/// What is recorded of every step: the residual, which is not the whole loss of every network.
static const char *const METRICS[] = {"error"};
/// Of the validation clouds: the mean error, its excess over the error with the true parameters, and the median error.
static const char *const VALIDATION[] = {"validation_error", "validation_excess", "validation_median"};

typedef struct training
{
    train_context base;
    const bat_surface_train_options *options;
    const surface_network_tape *network;
    surface_sample *samples; ///< of the current step, one per piece
    surface_sample validation[VALIDATION_CLOUDS];
    double floor; ///< the mean error of the validation clouds with the true parameters
} training;

// Options

bat_surface_train_options bat_surface_train_defaults(bat_recipe recipe)
{
    bool batten = recipe == BAT_RECIPE_BATTEN;
    return (bat_surface_train_options){
        .run = {.seed = 1, .epochs = batten ? 60 : 100},
        .recipe = recipe,
        .steps = batten ? 500 : 1000,
        .batch = batten ? 32 : 1,
        .min_points = batten ? 50 : 1000,
        .max_points = batten ? 2000 : 1000,
        .min_degree = 2,
        .max_degree = batten ? 5 : 2,
        .noise = batten ? 0.05 : 0,
        .clean = batten ? 0.5 : 0,
        .rate = batten ? 1e-3 : 0.1,
        .adam = batten,
    };
}

static bat_status check(const void *context, bat_error *error)
{
    const bat_surface_train_options *o = ((const training *)context)->options;
    const train_range ranges[] = {
        {"steps", (double)o->steps, 1, BAT_SURFACE_TRAIN_MAX_STEPS, false, false},
        {"batch", (double)o->batch, 1, BAT_SURFACE_TRAIN_MAX_BATCH, false, false},
        {"min_points", (double)o->min_points, MIN_POINTS, BAT_SURFACE_TRAIN_MAX_POINTS, false, false},
        {"max_points", (double)o->max_points, (double)o->min_points, BAT_SURFACE_TRAIN_MAX_POINTS, false, false},
        {"min_degree", o->min_degree, 1, BAT_SURFACE_TRAIN_MAX_DEGREE, false, false},
        {"max_degree", o->max_degree, o->min_degree, BAT_SURFACE_TRAIN_MAX_DEGREE, false, false},
        {"noise", o->noise, 0, INFINITY, false, false},
        {"clean", o->clean, 0, 1, false, true},
        {"rate", o->rate, 0, INFINITY, true, false},
    };
    if (o->uninformed && o->recipe != BAT_RECIPE_PUBLISHED)
        return error_option(error, "uninformed", "must be false: only the published recipe has it");
    return train_check_ranges(ranges, sizeof ranges / sizeof *ranges, error);
}

static surface_sample_range range_of(const bat_surface_train_options *options)
{
    return (surface_sample_range){.min_points = options->min_points,
                                  .max_points = options->max_points,
                                  .min_degree = options->min_degree,
                                  .max_degree = options->max_degree,
                                  .noise = options->noise,
                                  .clean = options->clean};
}

/// A model's file is recognized by the beginning of this text.
static void describe(const void *context, char text[TRAIN_TEXT_SIZE])
{
    const training *t = context;
    const bat_surface_train_options *o = t->options;
    (void)snprintf(text, TRAIN_TEXT_SIZE,
                   "%s, %llu epochs of %zu steps, batch %zu, %zu to %zu points, bidegree %d to %d, noise %.9g "
                   "(a share of %.9g without), %s, rate %.9g",
                   t->network->kind->recipe, (unsigned long long)o->run.epochs, o->steps, o->batch, o->min_points,
                   o->max_points, o->min_degree, o->max_degree, o->noise, o->clean, o->adam ? "Adam" : "gradient descent",
                   o->rate);
}

// Training

/// The seed of the validation clouds is that of no training.
static bat_status make_validation(training *t, bat_error *error)
{
    bat_random random = bat_random_seed(~t->options->run.seed);
    surface_sample_range range = range_of(t->options);
    bat_status status = BAT_OK;
    for (size_t k = 0; k < VALIDATION_CLOUDS && status == BAT_OK; k++)
    {
        double left = 0;
        status = surface_sample_draw(&range, &random, &t->validation[k], error);
        if (status == BAT_OK)
            status = surface_sample_floor(&t->validation[k], &left, error);
        t->floor += left / VALIDATION_CLOUDS;
    }
    return status;
}

static bat_status make(void *context, bat_error *error)
{
    training *t = context;
    t->samples = calloc(t->options->batch, sizeof *t->samples);
    if (t->samples == NULL)
        return error_memory(error, t->options->batch * sizeof *t->samples);
    bat_status status = t->network->kind->make(NULL, &t->base.parameters, error);
    if (status != BAT_OK)
        return status;
    t->network->start(&t->base.parameters, t->options->run.seed);
    return make_validation(t, error);
}

static void training_free(training *t)
{
    for (size_t i = 0; t->samples != NULL && i < t->options->batch; i++)
        surface_sample_free(&t->samples[i]);
    for (size_t k = 0; k < VALIDATION_CLOUDS; k++)
        surface_sample_free(&t->validation[k]);
    free(t->samples);
    learn_parameters_free(&t->base.parameters);
}

/// Gradient descent is that of section 4.4.
static void configure(const void *context, learn_job *job, learn_options *options)
{
    const bat_surface_train_options *o = ((const training *)context)->options;
    job->steps = o->steps;
    job->pieces = o->batch;
    options->schedule.rate = o->rate;
    if (o->adam)
    {
        options->optimizer =
            (learn_optimizer_options){.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.99, .epsilon = 1e-8, .decay = 0.01};
        options->schedule.kind = LEARN_COSINE;
        options->schedule.warmup = o->run.epochs > 20 ? 1 : 0;
        return;
    }
    options->optimizer = (learn_optimizer_options){.rule = LEARN_SGD};
    options->schedule.kind = LEARN_CONSTANT;
    options->plateau.reduce_patience = 5;
}

/// One cloud of a batch, with its share of the batch's mean.
static bat_status piece_loss(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *metrics,
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
    learn_array *interior = t->network->predict(tape, &sample->cloud, sample->parameters);
    learn_array *left = surface_sample_residual(tape, sample, interior);
    learn_array *own = t->network->loss != NULL ? t->network->loss(tape, sample, interior) : left;
    *loss = learn_scale(tape, own, (real)share);
    status = learn_tape_status(tape, error);
    if (status == BAT_OK)
        metrics[0] = share * (double)*left->value;
    return status;
}

static bat_status measure_cloud(const training *t, size_t k, learn_tape *tape, double *left, bat_error *error)
{
    const surface_sample *sample = &t->validation[k];
    learn_tape_begin(tape, &t->base.parameters, NULL);
    learn_array *interior = t->network->predict(tape, &sample->cloud, sample->parameters);
    const learn_array *made = surface_sample_residual(tape, sample, interior);
    bat_status status = learn_tape_status(tape, error);
    *left = status == BAT_OK ? (double)*made->value : NAN;
    return status;
}

static bat_status validate(void *context, double *metrics, bat_error *error)
{
    const training *t = context;
    const bat_group *group = t->options->run.group;
    group_items own_clouds = group_items_of(group, VALIDATION_CLOUDS);
    shared_work work = shared_work_make(VALIDATION_CLOUDS, (bat_progress){0});
    double left[VALIDATION_CLOUDS], sum = 0;
#pragma omp parallel num_threads(threads_for(t->options->run.threads, VALIDATION_CLOUDS))
    {
        learn_tape tape = learn_tape_make();
#pragma omp for schedule(dynamic, 1)
        for (size_t k = own_clouds.begin; k < own_clouds.end; k++)
        {
            bat_error own;
            left[k] = NAN;
            if (!shared_work_wants(&work, k))
                continue;
            bat_status status = measure_cloud(t, k, &tape, &left[k], &own);
            shared_work_finish(&work, k, status, &own);
        }
        learn_tape_free(&tape);
    }
    bat_status made = group_collect(group, left, sizeof *left, VALIDATION_CLOUDS, shared_work_end(&work, error), error);
    for (size_t k = 0; k < VALIDATION_CLOUDS; k++)
        sum += left[k];
    metrics[0] = sum / VALIDATION_CLOUDS;
    metrics[1] = metrics[0] - t->floor;
    qsort(left, VALIDATION_CLOUDS, sizeof *left, ascending);
    metrics[2] = 0.5 * (left[VALIDATION_CLOUDS / 2 - 1] + left[VALIDATION_CLOUDS / 2]);
    return made;
}

// The recipes have different networks, and losses that belong to these.
static const train_recipe RECIPE = {
    .columns = {METRICS, 1, VALIDATION, sizeof VALIDATION / sizeof *VALIDATION},
    .best_note = "validation_error",
    .plateau = {.reduce_factor = 0.5},
    .clip = HUGE_VAL,
    .validate_every = 1,
    .checkpoint_every = 1,
    .check = check,
    .make = make,
    .configure = configure,
    .describe = describe,
    .piece_loss = piece_loss,
    .validate = validate,
};
static const train_recipe *const RECIPES[TRAIN_RECIPES] = {&RECIPE, &RECIPE};

bat_status bat_surface_train(const bat_surface_train_options *options, bat_surface_train_report *report, bat_error *error)
{
    const bat_surface_train_options defaults = bat_surface_train_defaults(BAT_RECIPE_PUBLISHED);
    options = options != NULL ? options : &defaults;
    training t = {.base.options = &options->run, .options = options, .network = &surface_tape_published};
    if (options->recipe == BAT_RECIPE_BATTEN)
        t.network = &surface_tape_batten;
    else if (options->uninformed)
        t.network = &surface_tape_uninformed;
    bat_status status = train_run(RECIPES, options->recipe, &t, report != NULL ? &report->run : NULL, error);
    training_free(&t);
    return status;
}
