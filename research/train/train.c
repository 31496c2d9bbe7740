#include "research/train/train.h"
#include "base/clock.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "learn/blas.h"
#include "learn/checkpoint.h"
#include "learn/dropout.h"
#include "research/train/log.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum
{
    MOST_SLOTS = 8,   ///< unless more are asked for
    SUM_RUN = 1 << 14 ///< gradients are added up in runs of this many numbers
};

// Columns of the log before the job's own.
enum
{
    COLUMN_RATE = LEARN_LOG_STEP + 1,
    COLUMN_LOSS,
    COLUMN_NORM,
    OWN_COLUMNS
};

/// What a sum in the state is of; the job's figures follow.
enum
{
    SUM_LOSS,
    SUM_NORM,
    OWN_SUMS
};

// What the random streams are for.
enum
{
    STREAM_EPOCH,
    STREAM_PIECE,
    STREAM_DROPOUT
};

/// A gradient. Slot s adds up those of the pieces from s pieces / slots on, one after the other.
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
    learn_tape *tapes;    ///< one for each thread, so that its memory stays in the thread's cache
    size_t figure_count;  ///< of a piece: its loss and the job's figures
    double *figures;      ///< pieces x figure_count
    double *row;          ///< of the log
    const char **columns; ///< their names
    size_t column_count;
    learn_log log;
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
        .watch = {.reduce_factor = 0.5},
        .clip = HUGE_VAL,
        .seed = 1,
        .check_every = 1,
        .name = "",
        .checkpoint_every = 1,
    };
}

/// A key for what happens at a place, the same in every run with the seed.
static uint64_t place_key(uint64_t seed, uint64_t stream, uint64_t step, uint64_t piece)
{
    return dropout_mix(dropout_mix(dropout_mix(seed, stream), step), piece);
}

// Setting up and tearing down

static void name_columns(trainer *t)
{
    const learn_job *job = t->job;
    size_t count = 0;
    t->columns[count++] = "epoch";
    t->columns[count++] = "step";
    t->columns[count++] = "rate";
    t->columns[count++] = "loss";
    t->columns[count++] = "gradient_norm";
    for (size_t i = 0; i < job->figure_count; i++)
        t->columns[count++] = job->figures[i];
    for (size_t i = 0; i < job->check_count; i++)
        t->columns[count++] = job->checks[i];
    t->columns[count++] = "seconds";
    t->column_count = count;
}

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
    size_t most_columns = OWN_COLUMNS + job->figure_count + job->check_count + 1;
    t->state.sum_count = OWN_SUMS + job->figure_count;
    t->figure_count = 1 + job->figure_count;
    t->figures = calloc(job->pieces, t->figure_count * sizeof *t->figures);
    t->row = calloc(most_columns, sizeof *t->row);
    t->columns = calloc(most_columns, sizeof *t->columns);
    t->state.sums = calloc(t->state.sum_count, sizeof *t->state.sums);
    t->state.best = memory_array(job->parameters->total, sizeof(real));
    return t->figures != NULL && t->row != NULL && t->columns != NULL && t->state.sums != NULL && t->state.best != NULL;
}

static bat_status trainer_make(const learn_job *job, const learn_options *options, trainer *t, bat_error *error)
{
    *t = (trainer){.job = job, .options = options, .last_loss = NAN};
    if (job->steps == 0 || job->pieces == 0 || options->epochs > UINT64_MAX / job->steps)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "training needs steps and pieces, and not too many");
    t->slot_count = options->slots > 0 ? options->slots : MOST_SLOTS;
    t->slot_count = t->slot_count < job->pieces ? t->slot_count : job->pieces;
    t->threads = threads_for(options->threads, t->slot_count);
    t->state.seed = options->seed;
    t->state.pieces = job->pieces;
    t->state.slots = t->slot_count;
    t->state.epoch_steps = job->steps;
    t->state.watch = learn_watch_begin();
    if (!allocate_slots(t) || !allocate_numbers(t))
        return error_memory(error, t->slot_count * job->parameters->total * sizeof(real));
    name_columns(t);
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
    free(t->figures);
    free(t->row);
    free(t->columns);
    free(t->state.sums);
    free(t->state.best);
    learn_optimizer_free(&t->state.optimizer);
    learn_log_close(&t->log);
}

/// Go on from a checkpoint, if that is wanted and there is one, and open the log where it stands.
static bat_status trainer_start(trainer *t, bat_error *error)
{
    const learn_options *options = t->options;
    bat_status status = BAT_OK;
    if (options->resume && options->checkpoint != NULL && access(options->checkpoint, F_OK) == 0)
        status = learn_checkpoint_read(options->checkpoint, options->name, t->job->parameters, &t->state, error);
    if (status != BAT_OK)
        return status;
    return learn_log_open(options->log, t->columns, t->column_count, t->state.step, &t->log, error);
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
    double *figures = t->figures + index * t->figure_count;
    learn_array *loss = NULL;
    learn_tape_begin(tape, job->parameters, slot->gradient);
    learn_tape_drop(tape, place_key(seed, STREAM_DROPOUT, step, index));
    memset(figures, 0, t->figure_count * sizeof *figures);
    bat_status status = job->piece(job->context, &piece, tape, &loss, figures + 1, &slot->error);
    if (status == BAT_OK)
        status = learn_tape_status(tape, &slot->error);
    if (status != BAT_OK || loss == NULL)
        return status;
    figures[0] = (double)*loss->value;
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

/// Add the slots' gradients up in the first, each number in the order of the slots.
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

/// The step's figures into the epoch's sums; returns the step's loss.
static double sum_figures(trainer *t, double norm)
{
    double loss = 0;
    t->state.sums[SUM_NORM] += norm;
    for (size_t p = 0; p < t->job->pieces; p++)
    {
        const double *figures = t->figures + p * t->figure_count;
        loss += figures[0];
        for (size_t f = 0; f < t->job->figure_count; f++)
            t->state.sums[OWN_SUMS + f] += figures[1 + f];
    }
    t->state.sums[SUM_LOSS] += loss;
    return loss;
}

static double rate_of(const trainer *t, uint64_t epoch)
{
    return learn_watch_rate(&t->state.watch, &t->options->watch, learn_schedule_rate(&t->options->schedule, epoch));
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
    double loss = sum_figures(t, norm);
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
    if (t->options->checkpoint == NULL)
        return BAT_OK;
    return learn_checkpoint_write(t->options->checkpoint, t->options->name, t->job->parameters, &t->state, error);
}

static bat_status draw(const trainer *t, bat_error *error)
{
    if (t->options->chart == NULL)
        return BAT_OK;
    size_t figures_end = OWN_COLUMNS + t->job->figure_count, checks_end = figures_end + t->job->check_count;
    const size_t begins[] = {COLUMN_LOSS, COLUMN_NORM, COLUMN_RATE, OWN_COLUMNS, figures_end};
    const size_t ends[] = {COLUMN_NORM, OWN_COLUMNS, COLUMN_LOSS, figures_end, checks_end};
    return learn_log_draw(&t->log, t->options->chart, begins, ends, sizeof begins / sizeof *begins, error);
}

static bool is_due(uint64_t every, uint64_t epoch, uint64_t epochs)
{
    return epoch + 1 == epochs || (every > 0 && (epoch + 1) % every == 0);
}

/// Measure, and keep the weights when they are the best.
static bat_status run_check(trainer *t, uint64_t epoch, double *figures, bat_error *error)
{
    const learn_job *job = t->job;
    for (size_t i = 0; i < job->check_count; i++)
        figures[i] = NAN;
    if (job->check == NULL || job->check_count == 0 || !is_due(t->options->check_every, epoch, t->options->epochs))
        return BAT_OK;
    bat_status status = job->check(job->context, epoch, figures, error);
    if (status != BAT_OK || !learn_watch_see(&t->state.watch, &t->options->watch, epoch, figures[0]))
        return status;
    t->state.has_best = true;
    memcpy(t->state.best, job->parameters->values, job->parameters->total * sizeof(real));
    return BAT_OK;
}

/// After the last step of an epoch: check, log, and begin the sums anew.
static bat_status end_epoch(trainer *t, uint64_t epoch, bat_error *error)
{
    const learn_job *job = t->job;
    double *row = t->row;
    row[LEARN_LOG_EPOCH] = (double)epoch;
    row[LEARN_LOG_STEP] = (double)t->state.step;
    row[COLUMN_RATE] = rate_of(t, epoch);
    row[COLUMN_LOSS] = t->state.sums[SUM_LOSS] / (double)job->steps;
    row[COLUMN_NORM] = t->state.sums[SUM_NORM] / (double)job->steps;
    for (size_t f = 0; f < job->figure_count; f++)
        row[OWN_COLUMNS + f] = t->state.sums[OWN_SUMS + f] / (double)job->steps;
    bat_status status = run_check(t, epoch, row + OWN_COLUMNS + job->figure_count, error);
    if (status != BAT_OK)
        return status;
    row[t->column_count - 1] = clock_seconds() - t->epoch_began;
    t->last_loss = row[COLUMN_LOSS];
    memset(t->state.sums, 0, t->state.sum_count * sizeof *t->state.sums);
    return learn_log_add(&t->log, row, error);
}

/// The rest of the epoch that the state stands in.
static bat_status run_epoch(trainer *t, bat_error *error)
{
    const learn_job *job = t->job;
    const bat_progress *progress = &t->options->progress;
    uint64_t epoch = t->state.step / job->steps;
    double steps = (double)job->steps * (double)t->options->epochs;
    bat_random random = bat_random_seed(place_key(t->options->seed, STREAM_EPOCH, epoch, 0));
    t->epoch_began = clock_seconds();
    bat_status status = job->epoch != NULL ? job->epoch(job->context, epoch, &random, error) : BAT_OK;
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
    {
        status = save(t, error);
        if (status == BAT_OK)
            status = draw(t, error);
    }
    return status;
}

// All epochs

static bool is_over(const trainer *t)
{
    return t->state.step / t->job->steps >= t->options->epochs || learn_watch_stops(&t->state.watch, &t->options->watch);
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
        // The checkpoint's failure is the worse news.
        bat_status saved = save(t, error);
        status = saved != BAT_OK ? saved : status;
    }
    if (early && status == BAT_OK)
        status = draw(t, error);
    return status;
}

static void fill_report(const trainer *t, learn_report *report)
{
    *report = (learn_report){
        .epochs = t->state.step / t->job->steps,
        .steps = t->state.step,
        .loss = t->last_loss,
        .best = t->state.watch.best,
        .best_epoch = t->state.watch.best_epoch,
        .stopped = learn_watch_stops(&t->state.watch, &t->options->watch),
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
