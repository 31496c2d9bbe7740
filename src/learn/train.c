#include "learn/train.h"

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "learn/blas.h"
#include "learn/checkpoint.h"
#include "learn/dropout.h"

#include <stdlib.h>
#include <unistd.h>

enum
{
    MAX_SLOTS = 8,    ///< unless more are asked for
    SUM_RUN = 1 << 14 ///< gradients are summed in runs of this many numbers
};

/// The sums in the state; the sums of the job's metrics follow.
enum
{
    SUM_LOSS,
    SUM_NORM,
    OWN_SUMS
};

/// The purposes of the random streams.
enum
{
    STREAM_EPOCH,
    STREAM_PIECE,
    STREAM_DROPOUT
};

/// A gradient. Slot s accumulates those of the pieces from s pieces / slots on, one after the other.
typedef struct train_slot
{
    real *gradient;
    bat_status status;
    bat_error error;
} train_slot;

typedef struct trainer
{
    const learn_job *job;
    const learn_options *options;
    size_t slot_count;
    train_slot *slots;
    int threads;
    learn_tape *tapes;   ///< one per thread, so that its memory stays in the thread's cache
    size_t metric_count; ///< of a piece: its loss and the job's metrics
    double *metrics;     ///< pieces x metric_count
    double *means;       ///< the job's metrics over an epoch
    double *validation;  ///< job->validation_count
    learn_state state;
    double epoch_began; ///< seconds
    double last_loss;
} trainer;

learn_options learn_options_defaults(void)
{
    return (learn_options){
        .epochs = 1,
        .optimizer = {.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.999, .epsilon = 1e-8, .decay = 0.01},
        .schedule = {.kind = LEARN_CONSTANT, .rate = 1e-3},
        .plateau = {.reduce_factor = 0.5},
        .clip = HUGE_VAL,
        .seed = 1,
        .validate_every = 1,
        .name = "",
        .checkpoint_every = 1,
    };
}

/// The key of a random stream, the same in every run with the seed.
static uint64_t place_key(uint64_t seed, uint64_t stream, uint64_t step, uint64_t piece)
{
    return dropout_mix(dropout_mix(dropout_mix(seed, stream), step), piece);
}

// Setting up and tearing down

static bool allocate_slots(trainer *t)
{
    size_t total = t->job->parameters->total;
    t->slots = calloc(t->slot_count, sizeof *t->slots);
    t->tapes = calloc((size_t)t->threads, sizeof *t->tapes);
    for (size_t s = 0; t->slots != NULL && s < t->slot_count; s++)
    {
        t->slots[s].gradient = memory_array(total, sizeof(real));
        if (t->slots[s].gradient == NULL)
            return false;
    }
    return t->slots != NULL && t->tapes != NULL;
}

static bool allocate_numbers(trainer *t)
{
    const learn_job *job = t->job;
    t->state.sum_count = OWN_SUMS + job->metric_count;
    t->metric_count = 1 + job->metric_count;
    t->metrics = calloc(job->pieces, t->metric_count * sizeof *t->metrics);
    t->means = calloc(t->metric_count, sizeof *t->means);
    t->validation = calloc(1 + job->validation_count, sizeof *t->validation);
    t->state.sums = calloc(t->state.sum_count, sizeof *t->state.sums);
    t->state.best = memory_array(job->parameters->total, sizeof(real));
    return t->metrics != NULL && t->means != NULL && t->validation != NULL && t->state.sums != NULL && t->state.best != NULL;
}

static bat_status trainer_make(const learn_job *job, const learn_options *options, trainer *t, bat_error *error)
{
    *t = (trainer){.job = job, .options = options, .last_loss = NAN};
    if (job->steps == 0 || job->pieces == 0 || options->epochs > UINT64_MAX / job->steps)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "training needs at least 1 step per epoch and 1 piece per step, and at most 2^64 steps in all");
    t->slot_count = options->slots > 0 ? options->slots : MAX_SLOTS;
    t->slot_count = t->slot_count < job->pieces ? t->slot_count : job->pieces;
    t->threads = threads_for(options->threads, t->slot_count);
    t->state.seed = options->seed;
    t->state.pieces = job->pieces;
    t->state.slots = t->slot_count;
    t->state.epoch_steps = job->steps;
    t->state.plateau = learn_plateau_begin();
    if (!allocate_slots(t) || !allocate_numbers(t))
        return error_memory(error, t->slot_count * job->parameters->total * sizeof(real));
    return learn_optimizer_make(&options->optimizer, job->parameters->total, &t->state.optimizer, error);
}

static void trainer_free(trainer *t)
{
    for (size_t s = 0; t->slots != NULL && s < t->slot_count; s++)
        free(t->slots[s].gradient);
    for (int i = 0; t->tapes != NULL && i < t->threads; i++)
        learn_tape_free(&t->tapes[i]);
    free(t->slots);
    free(t->tapes);
    free(t->metrics);
    free(t->means);
    free(t->validation);
    free(t->state.sums);
    free(t->state.best);
    learn_optimizer_free(&t->state.optimizer);
}

/// Resume from a checkpoint, if that is asked for and there is one.
static bat_status trainer_start(trainer *t, bat_error *error)
{
    const learn_options *options = t->options;
    const learn_observer *observer = &options->observer;
    bat_status status = BAT_OK;
    if (options->resume && options->checkpoint != NULL && access(options->checkpoint, F_OK) == 0)
        status = learn_checkpoint_read(options->checkpoint, options->name, t->job->parameters, &t->state, error);
    if (status == BAT_OK && observer->begin != NULL)
        status = observer->begin(observer->context, t->state.step, error);
    return status;
}

// A step

/// One piece: its graph, its loss, its gradient added to the slot's.
static bat_status run_piece(trainer *t, train_slot *slot, learn_tape *tape, size_t index)
{
    const learn_job *job = t->job;
    uint64_t step = t->state.step, seed = t->options->seed;
    learn_piece piece = {.epoch = step / job->steps,
                         .step = step % job->steps,
                         .index = index,
                         .random = bat_random_seed(place_key(seed, STREAM_PIECE, step, index))};
    double *metrics = t->metrics + index * t->metric_count;
    learn_array *loss = NULL;
    learn_tape_begin(tape, job->parameters, slot->gradient);
    learn_tape_drop(tape, place_key(seed, STREAM_DROPOUT, step, index));
    memset(metrics, 0, t->metric_count * sizeof *metrics);
    bat_status status = job->piece_loss(job->context, &piece, tape, &loss, metrics + 1, &slot->error);
    if (status == BAT_OK)
        status = learn_tape_status(tape, &slot->error);
    if (status != BAT_OK || loss == NULL)
        return status;
    metrics[0] = (double)*loss->value;
    learn_tape_backward(tape, loss, 1);
    return learn_tape_status(tape, &slot->error);
}

static void run_slot(trainer *t, size_t s, learn_tape *tape)
{
    train_slot *slot = &t->slots[s];
    size_t pieces = t->job->pieces, begin = s * pieces / t->slot_count, end = (s + 1) * pieces / t->slot_count;
    memset(slot->gradient, 0, t->job->parameters->total * sizeof *slot->gradient);
    slot->status = BAT_OK;
    for (size_t index = begin; index < end && slot->status == BAT_OK; index++)
        slot->status = run_piece(t, slot, tape, index);
}

LANES_CLONES
static void add_numbers(size_t count, const real *restrict from, real *restrict to)
{
    for (size_t i = 0; i < count; i++)
        to[i] += from[i];
}

/// Sum the slots' gradients into the first, each number in the order of the slots.
static void sum_gradients(trainer *t)
{
    size_t total = t->job->parameters->total;
#pragma omp parallel for schedule(static) num_threads(t->threads) if (t->threads > 1)
    for (size_t begin = 0; begin < total; begin += SUM_RUN)
    {
        size_t count = total - begin < SUM_RUN ? total - begin : SUM_RUN;
        for (size_t s = 1; s < t->slot_count; s++)
            add_numbers(count, t->slots[s].gradient + begin, t->slots[0].gradient + begin);
    }
}

/// Add the step's metrics to the epoch's sums; returns the step's loss.
static double sum_metrics(trainer *t, double norm)
{
    double loss = 0;
    t->state.sums[SUM_NORM] += norm;
    for (size_t p = 0; p < t->job->pieces; p++)
    {
        const double *metrics = t->metrics + p * t->metric_count;
        loss += metrics[0];
        for (size_t f = 0; f < t->job->metric_count; f++)
            t->state.sums[OWN_SUMS + f] += metrics[1 + f];
    }
    t->state.sums[SUM_LOSS] += loss;
    return loss;
}

static double rate_of(const trainer *t, uint64_t epoch)
{
    return learn_plateau_rate(&t->state.plateau, &t->options->plateau, learn_schedule_rate(&t->options->schedule, epoch));
}

static bat_status run_step(trainer *t, bat_error *error)
{
    learn_state *state = &t->state;
#pragma omp parallel for schedule(dynamic, 1) num_threads(t->threads) if (t->threads > 1)
    for (size_t s = 0; s < t->slot_count; s++)
        run_slot(t, s, &t->tapes[threads_current()]);
    for (size_t s = 0; s < t->slot_count; s++)
        if (t->slots[s].status != BAT_OK)
        {
            if (error != NULL)
                *error = t->slots[s].error;
            return t->slots[s].status;
        }
    sum_gradients(t);
    real *gradient = t->slots[0].gradient;
    double norm = learn_clip_norm(t->job->parameters->total, gradient, t->options->clip);
    double loss = sum_metrics(t, norm);
    if (!isfinite(loss) || !isfinite(norm))
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the loss or its gradient is not finite at step %llu",
                         (unsigned long long)state->step);
    learn_optimizer_step(&state->optimizer, rate_of(t, state->step / t->job->steps), gradient, t->job->parameters->values);
    state->step++;
    return BAT_OK;
}

// An epoch

static bat_status save(const trainer *t, bat_error *error)
{
    const learn_options *options = t->options;
    const learn_observer *observer = &options->observer;
    bat_status status = BAT_OK;
    if (options->checkpoint != NULL)
        status = learn_checkpoint_write(options->checkpoint, options->name, t->job->parameters, &t->state, error);
    if (status == BAT_OK && observer->checkpoint != NULL)
        status = observer->checkpoint(observer->context, error);
    return status;
}

static bool is_due(uint64_t every, uint64_t epoch, uint64_t epochs)
{
    return epoch + 1 == epochs || (every > 0 && (epoch + 1) % every == 0);
}

/// Validate where that is due, and keep the weights when they are the best.
static bat_status validate(trainer *t, uint64_t epoch, bat_error *error)
{
    const learn_job *job = t->job;
    for (size_t i = 0; i < job->validation_count; i++)
        t->validation[i] = NAN;
    if (job->validate == NULL || job->validation_count == 0 ||
        !is_due(t->options->validate_every, epoch, t->options->epochs))
        return BAT_OK;
    bat_status status = job->validate(job->context, t->validation, error);
    if (status != BAT_OK || !learn_plateau_update(&t->state.plateau, &t->options->plateau, epoch, t->validation[0]))
        return status;
    t->state.has_best = true;
    memcpy(t->state.best, job->parameters->values, job->parameters->total * sizeof(real));
    return BAT_OK;
}

/// After the last step of an epoch: validate, tell the observer, and clear the sums.
static bat_status end_epoch(trainer *t, uint64_t epoch, bat_error *error)
{
    const learn_job *job = t->job;
    const learn_observer *observer = &t->options->observer;
    double *sums = t->state.sums, steps = (double)job->steps;
    learn_epoch done = {
        .epoch = epoch,
        .step = t->state.step,
        .rate = rate_of(t, epoch),
        .loss = sums[SUM_LOSS] / steps,
        .gradient_norm = sums[SUM_NORM] / steps,
        .metrics = t->means,
        .validation = t->validation,
    };
    for (size_t i = 0; i < job->metric_count; i++)
        t->means[i] = sums[OWN_SUMS + i] / steps;
    bat_status status = validate(t, epoch, error);
    if (status != BAT_OK)
        return status;
    done.seconds = clock_seconds() - t->epoch_began;
    t->last_loss = done.loss;
    memset(sums, 0, t->state.sum_count * sizeof *sums);
    return observer->epoch != NULL ? observer->epoch(observer->context, &done, error) : BAT_OK;
}

/// The steps of the current epoch that remain.
static bat_status run_epoch(trainer *t, bat_error *error)
{
    const learn_job *job = t->job;
    const bat_progress *progress = &t->options->progress;
    uint64_t epoch = t->state.step / job->steps;
    double steps = (double)job->steps * (double)t->options->epochs;
    bat_random random = bat_random_seed(place_key(t->options->seed, STREAM_EPOCH, epoch, 0));
    t->epoch_began = clock_seconds();
    bat_status status = job->prepare_epoch != NULL ? job->prepare_epoch(job->context, epoch, &random, error) : BAT_OK;
    while (status == BAT_OK && t->state.step / job->steps == epoch)
    {
        if (progress->report != NULL && !progress->report(progress->context, (double)t->state.step / steps))
            return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped at step %llu",
                             (unsigned long long)t->state.step);
        status = run_step(t, error);
    }
    if (status == BAT_OK)
        status = end_epoch(t, epoch, error);
    if (status == BAT_OK && is_due(t->options->checkpoint_every, epoch, t->options->epochs))
        status = save(t, error);
    return status;
}

// All epochs

static bool is_over(const trainer *t)
{
    return t->state.step / t->job->steps >= t->options->epochs ||
           learn_plateau_stops(&t->state.plateau, &t->options->plateau);
}

static bat_status run_epochs(trainer *t, bat_error *error)
{
    bat_status status = BAT_OK;
    blas_single_begin();
    while (status == BAT_OK && !is_over(t))
        status = run_epoch(t, error);
    blas_single_end();
    bool early = status == BAT_OK && t->state.step / t->job->steps < t->options->epochs;
    if (early || status == BAT_CANCELLED)
    {
        // A checkpoint that cannot be written matters more than the stop. The text of the stop is kept otherwise.
        bat_status saved = save(t, error);
        status = saved != BAT_OK ? saved : status;
    }
    return status;
}

static void fill_report(const trainer *t, learn_report *report)
{
    *report = (learn_report){
        .epochs = t->state.step / t->job->steps,
        .steps = t->state.step,
        .loss = t->last_loss,
        .best = t->state.plateau.best,
        .best_epoch = t->state.plateau.best_epoch,
        .stopped = learn_plateau_stops(&t->state.plateau, &t->options->plateau),
    };
}

bat_status learn_train(const learn_job *job, const learn_options *options, learn_report *report, bat_error *error)
{
    trainer t;
    bat_status status = trainer_make(job, options, &t, error);
    if (status == BAT_OK)
        status = trainer_start(&t, error);
    if (status == BAT_OK)
        status = run_epochs(&t, error);
    if (status == BAT_OK && t.state.has_best && !options->keep_last)
        memcpy(job->parameters->values, t.state.best, job->parameters->total * sizeof(real));
    if (report != NULL && (status == BAT_OK || status == BAT_CANCELLED))
        fill_report(&t, report);
    trainer_free(&t);
    return status;
}
