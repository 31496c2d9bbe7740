#include "research/train/curve_train.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "batten/curve_measure.h"
#include "batten/research/curve_study.h"
#include "learn/blas.h"
#include "research/networks/tension_network.h"
#include "research/train/geometry_loss.h"
#include "research/train/tension_sample.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The recipe of Ugail and Howard (2026), sections 5 and 6.

enum
{
    SPACES = BAT_TENSION_SPACE_COUNT,
    BATCH = 8,
    FINEST = BAT_TENSION_CONTROL_POINTS << BAT_TENSION_LEVELS
};

/// What is recorded of every batch.
enum
{
    CHAMFER,
    SMOOTHNESS,
    BENDING,
    CONSISTENCY,
    METRIC_COUNT
};
static const char *const METRICS[METRIC_COUNT] = {"chamfer", "smoothness", "bending", "consistency"};

static const char *const VALIDATION[] = {"mean_nn",  "mean_nn_plane", "mean_nn_sphere", "mean_nn_disk",
                                         "g1_plane", "g1_sphere",     "g1_disk"};

// Validation

typedef struct validation
{
    const learn_parameters *parameters;
    bat_tension_embedding embedding;
    const bat_tension_set *sets;
    size_t curves;                 ///< of all sets
    bat_curve_train_score *scores; ///< of the curves, set by set
    group_items own;               ///< curves of this process
    int threads;
} validation;

/// The mean distance of points to the nearest of others.
static double mean_nearest(const geometry_polygon *polygon, const double *truth, size_t truth_count)
{
    size_t dim = geometry_dim(polygon->surface), nearest[FINEST];
    double sum = 0;
    geometry_nearest(polygon->points, polygon->count, truth, truth_count, dim, nearest);
    for (size_t i = 0; i < polygon->count; i++)
    {
        const double *p = polygon->points + i * dim, *q = truth + nearest[i] * dim;
        double square = 0;
        for (size_t k = 0; k < dim; k++)
            square += (p[k] - q[k]) * (p[k] - q[k]);
        sum += sqrt(square);
    }
    return sum / (double)polygon->count;
}

static double largest_angle(const tape_polygon *polygon)
{
    double largest = 0;
    for (size_t j = 0; j < polygon->shape.count; j++)
        largest = fmax(largest, fabs(polygon->profile.angles[j]));
    return largest;
}

static bat_status score_curve(const validation *v, learn_tape *tape, const tension_sample *sample,
                              bat_curve_train_score *score)
{
    learn_tape_begin(tape, v->parameters, NULL);
    tape_polygon *polygon = tape_polygon_given(tape, &sample->control);
    for (int level = 0; level < BAT_TENSION_LEVELS; level++)
        polygon = tension_step(tape, polygon, v->embedding);
    if (tape->status != BAT_OK)
        return tape->status;
    score->mean_nn = mean_nearest(&polygon->shape, sample->truth, sample->truth_count);
    score->bending = geometry_bending(&polygon->shape, polygon->profile, BAT_CURVE_BENDING_OFFSET);
    score->g1 = largest_angle(polygon);
    return BAT_OK;
}

/// Curve `index` of all sets.
static tension_sample sample_at(const validation *v, size_t index)
{
    size_t space = 0;
    while (index >= v->sets[space].count)
        index -= v->sets[space++].count;
    return tension_sample_of(&v->sets[space], (bat_tension_space)space, index);
}

static bat_status score_curves(const validation *v)
{
    bat_status status = BAT_OK;
    blas_single_begin();
#pragma omp parallel num_threads(v->threads) if (v->threads > 1)
    {
        learn_tape tape = learn_tape_make();
#pragma omp for schedule(dynamic, 4)
        for (size_t i = v->own.begin; i < v->own.end; i++)
        {
            tension_sample sample = sample_at(v, i);
            bat_status own = score_curve(v, &tape, &sample, &v->scores[i]);
            if (own != BAT_OK)
            {
#pragma omp atomic write
                status = own;
            }
        }
        learn_tape_free(&tape);
    }
    blas_single_end();
    return status;
}

bat_status curve_published_validate(const learn_parameters *parameters, bat_tension_embedding embedding,
                                    const bat_tension_set sets[SPACES], const bat_group *group, int threads,
                                    bat_curve_train_score scores[SPACES], bat_error *error)
{
    validation v = {.parameters = parameters, .embedding = embedding, .sets = sets};
    for (size_t space = 0; space < SPACES; space++)
        v.curves += sets[space].count;
    v.own = group_items_of(group, v.curves);
    v.threads = threads_for(threads, v.own.end - v.own.begin);
    v.scores = memory_array(v.curves, sizeof *v.scores);
    bat_status status = v.scores != NULL ? score_curves(&v) : BAT_NO_MEMORY;
    if (status != BAT_OK)
        status = error_memory(error, v.curves * sizeof *v.scores);
    status = group_collect(group, v.scores, sizeof *v.scores, v.curves, status, error);
    const bat_curve_train_score *own = v.scores;
    for (size_t space = 0; status == BAT_OK && space < SPACES; space++)
    {
        scores[space] = curve_mean_score(own, sets[space].count);
        own += sets[space].count;
    }
    free(v.scores);
    return status;
}

double curve_published_metric(const bat_curve_train_score scores[SPACES])
{
    double sum = 0, count = 0;
    for (size_t space = 0; space < SPACES; space++)
        if (!isnan(scores[space].mean_nn))
        {
            sum += scores[space].mean_nn;
            count++;
        }
    return sum / count;
}

// Options

static bat_status check(const void *context, bat_error *error)
{
    const bat_curve_train_options *o = ((const curve_training *)context)->options;
    const train_range ranges[] = {
        {"embedding", (double)o->embedding, 0, BAT_TENSION_EMBEDDING_NONE, false, false},
        {"smoothness of the plane", o->smoothness[BAT_TENSION_SPACE_PLANE], 0, INFINITY, false, false},
        {"smoothness of the sphere", o->smoothness[BAT_TENSION_SPACE_SPHERE], 0, INFINITY, false, false},
        {"smoothness of the disk", o->smoothness[BAT_TENSION_SPACE_DISK], 0, INFINITY, false, false},
        {"bending", o->bending, 0, INFINITY, false, false},
        {"consistency", o->consistency, 0, INFINITY, false, false},
    };
    return train_check_ranges(ranges, sizeof ranges / sizeof *ranges, error);
}

static void describe(const void *context, char text[TRAIN_TEXT_SIZE])
{
    static const char *const embeddings[] = {"learned", "one-hot", "none"};
    const bat_curve_train_options *o = ((const curve_training *)context)->options;
    (void)snprintf(text, TRAIN_TEXT_SIZE,
                   "tension published, %llu epochs, embedding %s, smoothness %.9g %.9g %.9g, bending %.9g, "
                   "consistency %.9g",
                   (unsigned long long)o->run.epochs, embeddings[o->embedding], o->smoothness[0], o->smoothness[1],
                   o->smoothness[2], o->bending, o->consistency);
}

// Training

static bat_status make(void *context, bat_error *error)
{
    curve_training *t = context;
    bat_status status = BAT_OK;
    if (t->size.data == NULL)
    {
        status = bat_tension_data_make(&t->own_data, error);
        t->size.data = &t->own_data;
    }
    if (status == BAT_OK)
        status = tension_predictor_make(t->options->embedding, &t->base.parameters, error);
    if (status != BAT_OK)
        return status;
    for (size_t space = 0; space < SPACES; space++)
        t->sample_count += t->size.data->train[space].count;
    tension_network_start(&t->base.parameters, t->options->run.seed);
    t->order = memory_array(t->sample_count, sizeof *t->order);
    return t->order != NULL ? BAT_OK : error_memory(error, t->sample_count * sizeof *t->order);
}

static void configure(const void *context, learn_job *job, learn_options *options)
{
    (void)options;
    job->pieces = BATCH;
    job->steps = (((const curve_training *)context)->sample_count + BATCH - 1) / BATCH;
}

static bat_status prepare_epoch(void *context, uint64_t epoch, bat_random *random, bat_error *error)
{
    (void)epoch;
    (void)error;
    const curve_training *t = context;
    train_shuffle(t->order, t->sample_count, random);
    return BAT_OK;
}

static tension_sample training_sample(const curve_training *t, size_t index)
{
    const bat_tension_set *sets = t->size.data->train;
    size_t space = 0;
    while (index >= sets[space].count)
        index -= sets[space++].count;
    return tension_sample_of(&sets[space], (bat_tension_space)space, index);
}

/// One sample of a batch, with its share of the batch's mean.
static bat_status piece_loss(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *metrics,
                             bat_error *error)
{
    (void)error;
    const curve_training *t = context;
    size_t first = (size_t)piece->step * BATCH, left = t->sample_count - first;
    size_t count = left < BATCH ? left : BATCH;
    if (piece->index >= count)
        return BAT_OK;
    tension_sample sample = training_sample(t, t->order[first + piece->index]);
    tension_loss made = tension_sample_loss(tape, &sample, t->options, &piece->random);
    double share = 1 / (double)count;
    *loss = learn_scale(tape, made.total, (real)share);
    if (tape->status != BAT_OK)
        return BAT_OK; // learn_train() reads the tape's status
    metrics[CHAMFER] = share * (double)*made.chamfer->value;
    metrics[SMOOTHNESS] = share * (double)*made.smoothness->value;
    metrics[BENDING] = share * (double)*made.bending->value;
    metrics[CONSISTENCY] = made.consistency != NULL ? share * (double)*made.consistency->value : NAN;
    return BAT_OK;
}

static bat_status validate(void *context, double *metrics, bat_error *error)
{
    const curve_training *t = context;
    bat_curve_train_score scores[SPACES];
    bat_status status = curve_published_validate(&t->base.parameters, t->options->embedding, t->size.data->validation,
                                                 t->options->run.group, t->options->run.threads, scores, error);
    if (status != BAT_OK)
        return status;
    metrics[0] = curve_published_metric(scores);
    for (size_t space = 0; space < SPACES; space++)
    {
        metrics[1 + space] = scores[space].mean_nn;
        metrics[1 + SPACES + space] = scores[space].g1;
    }
    return BAT_OK;
}

const train_recipe curve_recipe_published = {
    .columns = {METRICS, METRIC_COUNT, VALIDATION, sizeof VALIDATION / sizeof *VALIDATION},
    .best_note = "validation_mean_nn",
    // Sections 6.2 to 6.4.
    .optimizer = {.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.95, .epsilon = 1e-8, .decay = 1e-4},
    .schedule = {.kind = LEARN_COSINE, .rate = 1e-3, .warmup = 5},
    .plateau = {.min_gain = 1e-5, .reduce_patience = 10, .reduce_factor = 0.5, .min_rate = 1e-6, .stop_patience = 25},
    .clip = 0.5,
    .validate_every = 10,
    .checkpoint_every = 5,
    .check = check,
    .make = make,
    .configure = configure,
    .describe = describe,
    .prepare_epoch = prepare_epoch,
    .piece_loss = piece_loss,
    .validate = validate,
};
