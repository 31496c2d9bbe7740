#include "research/learn/train.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/threads.h"
#include "learn/blas.h"
#include "research/learn/checkpoint.h"
#include "research/learn/dropout.h"

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

/// A gradient. Slot s accumulates those of the pieces from s pieces / slots on, one after the other. A process has the slots
/// of its share.
typedef struct train_slot
{
    real *gradient;
    bat_status status;
    bat_error error;
} train_slot;

/// What the processes tell each other of a step, beside the gradient.
typedef struct step_note
{
    bat_status status; ///< the first failure in the order of slots
    bool stops;        ///< whether a process was asked to stop
    bat_error error;
} step_note;

typedef struct trainer
{
    const learn_job *job;
    const learn_options *options;
    const bat_group *group;
    size_t slot_count; ///< of all processes
    group_items own;   ///< slots of this process
    train_slot *slots; ///< of this process
    real *gradient;    ///< in a group: the sum
    step_note note;    ///< of the last step
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

// The division of a step

static size_t count_slots(size_t wanted, size_t pieces)
{
    size_t slots = wanted > 0 ? wanted : MAX_SLOTS;
    return slots < pieces ? slots : pieces;
}

/// The first piece of a slot.
static size_t slot_begin(size_t slots, size_t pieces, size_t s)
{
    return s * pieces / slots;
}

group_items group_items_of(const bat_group *group, size_t count)
{
    size_t rank = group_rank(group), ranks = group_count(group);
    size_t each = count / ranks, more = count % ranks;
    size_t begin = rank * each + (rank < more ? rank : more);
    return (group_items){begin, begin + each + (rank < more ? 1 : 0)};
}

bat_status group_collect(const bat_group *group, void *items, size_t size, size_t count, bat_status status, bat_error *error)
{
    size_t rank = group_rank(group), last = group_count(group) - 1;
    group_items share = group_items_of(group, count);
    status = bat_group_agree(group, status, error);
    if (last == 0 || status != BAT_OK)
        return status;
    if (rank > 0 && share.begin > 0)
        status = group->receive(group->context, rank - 1, items, share.begin * size, error);
    if (status == BAT_OK && rank < last && share.end > 0)
        status = group->send(group->context, rank + 1, items, share.end * size, error);
    return status == BAT_OK ? group_broadcast(group, last, items, count * size, error) : status;
}

group_items learn_own_pieces(const bat_group *group, size_t slots, size_t pieces)
{
    size_t count = count_slots(slots, pieces);
    group_items own = group_items_of(group, count);
    return (group_items){slot_begin(count, pieces, own.begin), slot_begin(count, pieces, own.end)};
}

/// The number of slots of this process.
static size_t own_slots(const trainer *t)
{
    return t->own.end - t->own.begin;
}

// Setting up and tearing down

static bool allocate_slots(trainer *t)
{
    size_t total = t->job->parameters->total;
    t->slots = calloc(own_slots(t) + 1, sizeof *t->slots);
    t->tapes = calloc((size_t)t->threads, sizeof *t->tapes);
    if (group_count(t->group) > 1)
    {
        t->gradient = calloc(total, sizeof(real));
        if (t->gradient == NULL)
            return false;
    }
    for (size_t s = 0; t->slots != NULL && s < own_slots(t); s++)
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
    *t = (trainer){.job = job, .options = options, .group = options->group, .last_loss = NAN};
    if (job->steps == 0 || job->pieces == 0 || options->epochs > UINT64_MAX / job->steps)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "training needs at least 1 step per epoch and 1 piece per step, and at most 2^64 steps in all");
    t->slot_count = count_slots(options->slots, job->pieces);
    t->own = group_items_of(t->group, t->slot_count);
    t->threads = threads_for(options->threads, own_slots(t));
    t->state.seed = options->seed;
    t->state.pieces = job->pieces;
    t->state.slots = t->slot_count;
    t->state.epoch_steps = job->steps;
    t->state.plateau = learn_plateau_begin();
    if (!allocate_slots(t) || !allocate_numbers(t))
        return error_memory(error, own_slots(t) * job->parameters->total * sizeof(real));
    return learn_optimizer_make(&options->optimizer, job->parameters->total, &t->state.optimizer, error);
}

static void trainer_free(trainer *t)
{
    for (size_t s = 0; t->slots != NULL && s < own_slots(t); s++)
        free(t->slots[s].gradient);
    free(t->gradient);
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

static bool leads(const trainer *t)
{
    return group_rank(t->group) == 0;
}

/// Send what rank 0 has read to all.
static bat_status share_state(trainer *t, bat_error *error)
{
    learn_state *state = &t->state, read = *state;
    size_t size = t->job->parameters->total * sizeof(real);
    const struct
    {
        void *bytes;
        size_t size;
    } arrays[] = {{t->job->parameters->values, size},
                  {state->best, size},
                  {state->optimizer.mean, size},
                  {state->optimizer.squares, state->optimizer.squares != NULL ? size : 0},
                  {state->sums, state->sum_count * sizeof *state->sums}};
    bat_status status = group_broadcast(t->group, 0, &read, sizeof read, error);
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays && status == BAT_OK; i++)
        status = group_broadcast(t->group, 0, arrays[i].bytes, arrays[i].size, error);
    state->step = read.step;
    state->plateau = read.plateau;
    state->has_best = read.has_best;
    state->optimizer.steps = read.optimizer.steps;
    return status;
}

/// Resume from a checkpoint, if that is asked for and there is one.
static bat_status trainer_start(trainer *t, bat_error *error)
{
    const learn_options *options = t->options;
    const learn_observer *observer = &options->observer;
    bat_status status = BAT_OK;
    if (leads(t) && options->resume && options->checkpoint != NULL && access(options->checkpoint, F_OK) == 0)
        status = learn_checkpoint_read(options->checkpoint, options->name, t->job->parameters, &t->state, error);
    if (leads(t) && status == BAT_OK && observer->begin != NULL)
        status = observer->begin(observer->context, t->state.step, error);
    status = bat_group_agree(t->group, status, error);
    return status == BAT_OK && options->resume && group_count(t->group) > 1 ? share_state(t, error) : status;
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
    size_t pieces = t->job->pieces, begin = slot_begin(t->slot_count, pieces, t->own.begin + s),
           end = slot_begin(t->slot_count, pieces, t->own.begin + s + 1);
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
static void sum_own_gradients(trainer *t)
{
    size_t total = t->job->parameters->total;
#pragma omp parallel for schedule(static) num_threads(t->threads) if (t->threads > 1)
    for (size_t begin = 0; begin < total; begin += SUM_RUN)
    {
        size_t count = total - begin < SUM_RUN ? total - begin : SUM_RUN;
        for (size_t s = 1; s < own_slots(t); s++)
            add_numbers(count, t->slots[s].gradient + begin, t->slots[0].gradient + begin);
    }
}

/// Add numbers of the slots of this process to the sum of the slots before.
static void add_own(trainer *t, size_t begin, size_t count)
{
    for (size_t s = 0; s < own_slots(t); s++)
    {
        const real *from = t->slots[s].gradient + begin;
        if (t->own.begin + s == 0)
            memcpy(t->gradient + begin, from, count * sizeof *from);
        else
            add_numbers(count, from, t->gradient + begin);
    }
}

/// Continue the sums of the rank before, and hand them to the next one.
static bat_status chain_gradient(trainer *t, bat_error *error)
{
    const bat_group *group = t->group;
    size_t total = t->job->parameters->total, run = GROUP_RUN / sizeof(real);
    bat_status status = BAT_OK;
    for (size_t begin = 0; begin < total && status == BAT_OK; begin += run)
    {
        size_t count = total - begin < run ? total - begin : run;
        if (group->rank > 0)
            status = group->receive(group->context, group->rank - 1, t->gradient + begin, count * sizeof(real), error);
        if (status != BAT_OK)
            break;
        add_own(t, begin, count);
        if (group->rank + 1 < group->count)
            status = group->send(group->context, group->rank + 1, t->gradient + begin, count * sizeof(real), error);
    }
    return status;
}

/// The same for the notes and metrics: those of the pieces before, then those of this process.
static bat_status chain_notes(trainer *t, bat_error *error)
{
    const bat_group *group = t->group;
    group_items own = learn_own_pieces(group, t->options->slots, t->job->pieces);
    size_t size = t->metric_count * sizeof *t->metrics;
    step_note before;
    bat_status status = BAT_OK;
    if (group->rank > 0)
    {
        status = group->receive(group->context, group->rank - 1, &before, sizeof before, error);
        if (status == BAT_OK && own.begin > 0)
            status = group->receive(group->context, group->rank - 1, t->metrics, own.begin * size, error);
        if (status != BAT_OK)
            return status;
        before.stops |= t->note.stops;
        if (before.status == BAT_OK)
        {
            before.status = t->note.status;
            before.error = t->note.error;
        }
        t->note = before;
    }
    if (group->rank + 1 < group->count)
    {
        status = group->send(group->context, group->rank + 1, &t->note, sizeof t->note, error);
        if (status == BAT_OK && own.end > 0)
            status = group->send(group->context, group->rank + 1, t->metrics, own.end * size, error);
    }
    return status;
}

/// Sum the gradients of all processes and collect their notes and metrics.
static bat_status exchange_step(trainer *t, bat_error *error)
{
    size_t last = t->group->count - 1;
    bat_status status = chain_notes(t, error);
    if (status == BAT_OK)
        status = chain_gradient(t, error);
    if (status == BAT_OK)
        status = group_broadcast(t->group, last, &t->note, sizeof t->note, error);
    if (status == BAT_OK)
        status = group_broadcast(t->group, last, t->metrics, t->job->pieces * t->metric_count * sizeof *t->metrics, error);
    if (status == BAT_OK)
        status = group_broadcast(t->group, last, t->gradient, t->job->parameters->total * sizeof(real), error);
    return status;
}

/// The gradient of the step, from those of the slots.
static bat_status sum_gradients(trainer *t, real **gradient, bat_error *error)
{
    bool alone = group_count(t->group) == 1;
    *gradient = alone ? t->slots[0].gradient : t->gradient;
    for (size_t s = 0; s < own_slots(t) && t->note.status == BAT_OK; s++)
        if (t->slots[s].status != BAT_OK)
        {
            t->note.status = t->slots[s].status;
            t->note.error = t->slots[s].error;
        }
    bat_status status = alone ? BAT_OK : exchange_step(t, error);
    if (status == BAT_OK && t->note.status != BAT_OK)
    {
        status = t->note.status;
        if (error != NULL)
            *error = t->note.error;
    }
    if (alone && status == BAT_OK)
        sum_own_gradients(t);
    return status;
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

/// @param stops whether this process was asked to stop
static bat_status run_step(trainer *t, bool stops, bat_error *error)
{
    learn_state *state = &t->state;
    real *gradient;
    memset(&t->note, 0, sizeof t->note);
    t->note.stops = stops;
#pragma omp parallel for schedule(dynamic, 1) num_threads(t->threads) if (t->threads > 1)
    for (size_t s = 0; s < own_slots(t); s++)
        run_slot(t, s, &t->tapes[threads_current()]);
    bat_status status = sum_gradients(t, &gradient, error);
    if (status != BAT_OK)
        return status;
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
    if (leads(t) && options->checkpoint != NULL)
        status = learn_checkpoint_write(options->checkpoint, options->name, t->job->parameters, &t->state, error);
    if (leads(t) && status == BAT_OK && observer->checkpoint != NULL)
        status = observer->checkpoint(observer->context, error);
    return bat_group_agree(t->group, status, error);
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
    bat_status status = bat_group_agree(t->group, job->validate(job->context, t->validation, error), error);
    if (status != BAT_OK || !learn_plateau_update(&t->state.plateau, &t->options->plateau, epoch, t->validation[0]))
        return status;
    t->state.has_best = true;
    memcpy(t->state.best, job->parameters->values, job->parameters->total * sizeof(real));
    return BAT_OK;
}

/// Refuse to continue where a process has other weights than rank 0.
static bat_status check_weights(const trainer *t, bat_error *error)
{
    const learn_parameters *parameters = t->job->parameters;
    if (group_count(t->group) == 1)
        return BAT_OK;
    uint64_t own = hash_bytes(HASH_BEGIN, parameters->values, parameters->total * sizeof(real)), first = own;
    bat_status status = group_broadcast(t->group, 0, &first, sizeof first, error);
    if (status != BAT_OK)
        return status;
    if (own != first)
        status = error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                           "rank %zu has other weights than rank 0: all processes must be of the same build, on machines of "
                           "the same kind",
                           group_rank(t->group));
    return bat_group_agree(t->group, status, error);
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
    bat_status status = check_weights(t, error);
    if (status == BAT_OK)
        status = validate(t, epoch, error);
    if (status != BAT_OK)
        return status;
    done.seconds = clock_seconds() - t->epoch_began;
    t->last_loss = done.loss;
    memset(sums, 0, t->state.sum_count * sizeof *sums);
    if (leads(t) && observer->epoch != NULL)
        status = observer->epoch(observer->context, &done, error);
    return bat_group_agree(t->group, status, error);
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
    status = bat_group_agree(t->group, status, error);
    while (status == BAT_OK && t->state.step / job->steps == epoch)
    {
        bool stops = progress->report != NULL && !progress->report(progress->context, (double)t->state.step / steps);
        // In a group what counts is the wish that the step before agreed on.
        if (group_count(t->group) > 1 ? t->note.stops : stops)
            return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped at step %llu",
                             (unsigned long long)t->state.step);
        status = run_step(t, stops, error);
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
    bat_status status = bat_group_agree(options->group, trainer_make(job, options, &t, error), error);
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
