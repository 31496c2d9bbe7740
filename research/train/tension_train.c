#include "research/train/tension_train.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/network/tension_network.h"
#include "research/train/tension_validate.h"
#include "research/train/train.h"
#include "research/train/train_files.h"
#include "research/train/train_model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    BATCH = 8,
    CHECK_EVERY = 10,
    SAVE_EVERY = 5,
    NAME_SIZE = 256
};

/// What is recorded of every batch.
enum
{
    CHAMFER,
    SMOOTHNESS,
    BENDING,
    CONSISTENCY,
    FIGURE_COUNT
};
static const char *const FIGURES[FIGURE_COUNT] = {"chamfer", "smoothness", "bending", "consistency"};

static const char *const CHECKS[] = {"mean_nn",  "mean_nn_plane", "mean_nn_sphere", "mean_nn_disk",
                                     "g1_plane", "g1_sphere",     "g1_disk"};
enum
{
    CHECK_COUNT = sizeof CHECKS / sizeof *CHECKS
};

typedef struct training
{
    const bat_tension_data *data;
    const bat_tension_train_options *options;
    learn_parameters parameters;
    size_t sample_count;
    size_t *order; ///< of the samples in this epoch
} training;

bat_tension_train_options bat_tension_train_defaults(void)
{
    return (bat_tension_train_options){
        .seed = 1,
        .epochs = 300,
        .smoothness = {[BAT_TENSION_PLANE] = 0.05, [BAT_TENSION_SPHERE] = 0.15, [BAT_TENSION_DISK] = 0.05},
        .bending = 1e-4,
        .consistency = 0.1,
    };
}

static bool is_weight(double x)
{
    return isfinite(x) && x >= 0;
}

static bat_status check_options(const bat_tension_train_options *options, bat_error *error)
{
    if (options->epochs == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "training needs at least 1 epoch");
    if ((int)options->embedding < 0 || options->embedding > BAT_TENSION_EMBEDDING_NONE)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there is no embedding of number %d",
                         (int)options->embedding);
    bool weights = is_weight(options->bending) && is_weight(options->consistency);
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        weights = weights && is_weight(options->smoothness[space]);
    if (!weights)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the weight of a loss is negative or not finite");
    return BAT_OK;
}

// What learn_train() asks for

static bat_status shuffle(void *context, uint64_t epoch, bat_random *random, bat_error *error)
{
    (void)epoch;
    (void)error;
    training *t = context;
    for (size_t i = 0; i < t->sample_count; i++)
    {
        size_t j = (size_t)(bat_random_uniform(random) * (double)(i + 1));
        t->order[i] = t->order[j];
        t->order[j] = i;
    }
    return BAT_OK;
}

static tension_sample sample_at(const training *t, size_t index)
{
    size_t space = 0;
    while (index >= t->data->train[space].count)
        index -= t->data->train[space++].count;
    return tension_sample_of(&t->data->train[space], (bat_tension_space)space, index);
}

/// One sample of a batch, with its share of the batch's mean.
static bat_status train_sample(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *figures,
                               bat_error *error)
{
    (void)error;
    const training *t = context;
    size_t first = (size_t)piece->step * BATCH, left = t->sample_count - first;
    size_t count = left < BATCH ? left : BATCH;
    if (piece->index >= count)
        return BAT_OK;
    tension_sample sample = sample_at(t, t->order[first + piece->index]);
    tension_loss made = tension_sample_loss(tape, &sample, t->options, &piece->random);
    double share = 1 / (double)count;
    *loss = learn_scale(tape, made.total, (real)share);
    if (tape->status != BAT_OK)
        return BAT_OK; // learn_train() asks the tape
    figures[CHAMFER] = share * (double)*made.chamfer->value;
    figures[SMOOTHNESS] = share * (double)*made.smoothness->value;
    figures[BENDING] = share * (double)*made.bending->value;
    figures[CONSISTENCY] = made.consistency != NULL ? share * (double)*made.consistency->value : NAN;
    return BAT_OK;
}

static bat_status check(void *context, uint64_t epoch, double *figures, bat_error *error)
{
    (void)epoch;
    const training *t = context;
    bat_tension_score scores[BAT_TENSION_SPACE_COUNT];
    bat_status status =
        tension_validate(&t->parameters, t->options->embedding, t->data->validation, t->options->threads, scores, error);
    if (status != BAT_OK)
        return status;
    figures[0] = tension_cross_mean(scores);
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        figures[1 + space] = scores[space].mean_nn;
        figures[1 + BAT_TENSION_SPACE_COUNT + space] = scores[space].g1;
    }
    return BAT_OK;
}

/// Everything but the seed that makes one training another, as the name by which a checkpoint is known.
static void write_name(const bat_tension_train_options *options, char name[NAME_SIZE])
{
    static const char *const embeddings[] = {"learned", "one-hot", "none"};
    (void)snprintf(name, NAME_SIZE,
                   "tension published, %llu epochs, embedding %s, smoothness %.9g %.9g %.9g, bending %.9g, "
                   "consistency %.9g",
                   (unsigned long long)options->epochs, embeddings[options->embedding], options->smoothness[0],
                   options->smoothness[1], options->smoothness[2], options->bending, options->consistency);
}

// All of it

static bat_status training_make(const bat_tension_data *data, const bat_tension_train_options *options, training *t,
                                bat_error *error)
{
    *t = (training){.data = data, .options = options};
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        t->sample_count += data->train[space].count;
    bat_status status = tension_predictor_make(options->embedding, &t->parameters, error);
    if (status != BAT_OK)
        return status;
    tension_network_start(&t->parameters, options->seed);
    t->order = memory_array(t->sample_count, sizeof *t->order);
    return t->order != NULL ? BAT_OK : error_memory(error, t->sample_count * sizeof *t->order);
}

static void training_free(training *t)
{
    learn_parameters_free(&t->parameters);
    free(t->order);
}

/// Sections 6.2 to 6.4.
static learn_options published_options(const bat_tension_train_options *given, const char *name, const train_files *files)
{
    learn_options options = learn_options_defaults();
    options.epochs = given->epochs;
    options.optimizer =
        (learn_optimizer_options){.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.95, .epsilon = 1e-8, .decay = 1e-4};
    options.schedule = (learn_schedule){.kind = LEARN_COSINE, .rate = 1e-3, .warmup = 5, .epochs = given->epochs};
    options.watch = (learn_watch_options){
        .least_gain = 1e-5, .reduce_patience = 10, .reduce_factor = 0.5, .least_rate = 1e-6, .stop_patience = 25};
    options.clip = 0.5;
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
        .steps = (t->sample_count + BATCH - 1) / BATCH,
        .pieces = BATCH,
        .figures = FIGURES,
        .figure_count = FIGURE_COUNT,
        .checks = CHECKS,
        .check_count = CHECK_COUNT,
        .epoch = shuffle,
        .piece = train_sample,
        .check = check,
    };
    return learn_train(&job, options, made, error);
}

static bat_status fill_report(const training *t, const learn_report *made, bat_tension_train_report *report,
                              bat_error *error)
{
    bat_tension_train_report filled = {
        .epochs = made->epochs, .best_epoch = made->best_epoch + 1, .stopped = made->stopped, .mean_nn = made->best};
    bat_status status = tension_validate(&t->parameters, t->options->embedding, t->data->validation, t->options->threads,
                                         filled.scores, error);
    if (status == BAT_OK)
        *report = filled;
    return status;
}

bat_status tension_train_on(const bat_tension_data *data, const bat_tension_train_options *options,
                            bat_tension_train_report *report, bat_error *error)
{
    training t = {0};
    train_files files;
    learn_report made;
    char name[NAME_SIZE];
    bat_status status = check_options(options, error);
    if (status == BAT_OK)
        status = train_files_make(options->folder, &files, error);
    if (status == BAT_OK)
        status = training_make(data, options, &t, error);
    if (status == BAT_OK)
    {
        write_name(options, name);
        learn_options learning = published_options(options, name, &files);
        status = run(&t, &learning, &made, error);
    }
    if (status == BAT_OK && options->folder != NULL)
        status = train_model_write(files.model, &t.parameters, name, options->seed, &made, "validation_mean_nn", error);
    if (status == BAT_OK && report != NULL)
        status = fill_report(&t, &made, report, error);
    training_free(&t);
    return status;
}

bat_status bat_tension_train(const bat_tension_train_options *options, bat_tension_train_report *report, bat_error *error)
{
    bat_tension_train_options defaults = bat_tension_train_defaults();
    bat_tension_data data;
    bat_status status = bat_tension_data_make(&data, error);
    if (status != BAT_OK)
        return status;
    status = tension_train_on(&data, options != NULL ? options : &defaults, report, error);
    bat_tension_data_free(&data);
    return status;
}
