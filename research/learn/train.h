#ifndef RESEARCH_LEARN_TRAIN_H
#define RESEARCH_LEARN_TRAIN_H

#include "research/learn/optimizer.h"
#include "research/learn/tape.h"
#include "research/surface/group.h"

/// @file
/// The training loop: the pieces of a step in parallel, one update per step, validation, checkpoints.
///
/// The loss of a step is the sum of the losses of its pieces (a sample, a few samples, a mesh), each differentiated by
/// itself. All randomness is a function of the seed and of the position (epoch, step, piece). Neither the number of threads,
/// nor that of processes, nor an interruption changes a byte of the result.
///
/// Processes of a group divide the pieces of each step, a slot's to one process. Rank after rank adds the gradients of its
/// slots to the sum of the ranks before, so that every number is summed in the order of the slots; the last rank sends the
/// sum to all, and each makes the same update. Rank 0 reads and writes the files.

/// The position of a piece.
typedef struct learn_piece
{
    uint64_t epoch;
    uint64_t step;     ///< within the epoch
    size_t index;      ///< within the step
    bat_random random; ///< a stream of this piece's own
} learn_piece;

/// Items begin … end - 1 of a list.
typedef struct group_items
{
    size_t begin, end;
} group_items;

/// The items of this process among `count`: the ranks have consecutive items, and numbers that differ by at most 1.
group_items group_items_of(const bat_group *group, size_t count);

/// Collect the items that the processes made: each has those of its share, and receives all others. The first failure as by
/// bat_group_agree().
/// @param items  count x size bytes
/// @param status,error of this process; where it failed its items are not used
bat_status group_collect(const bat_group *group, void *items, size_t size, size_t count, bat_status status,
                         bat_error *error);

/// What is trained, and on what. All functions but `piece_loss` are called from the calling thread. In a group every process
/// calls them, `piece_loss` for its own pieces alone; `validate` may share its work (group_collect()), but gives every
/// process the same metrics.
typedef struct learn_job
{
    void *context;                ///< handed to the functions
    learn_parameters *parameters; ///< the initial weights, then the result
    uint64_t steps;               ///< per epoch, at least 1
    size_t pieces;                ///< per step, at least 1
    size_t metric_count;          ///< numbers recorded per piece, beside the loss
    size_t validation_count;      ///< numbers of a validation; the first decides which weights are best: lower is better

    /// Prepare an epoch: shuffle, draw new data. `random` is a stream of this epoch's own. Called again with the same
    /// arguments when an interrupted run resumes within the epoch. May be null.
    bat_status (*prepare_epoch)(void *context, uint64_t epoch, bat_random *random, bat_error *error);
    /// Build the graph of a piece on a tape that has begun with the job's parameters and dropout. Called from several
    /// threads at once. Leave *loss null for a piece that does not exist. `metrics` are zero before the call; the loop adds
    /// them up over the pieces of a step and averages them over the steps of an epoch.
    bat_status (*piece_loss)(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *metrics,
                             bat_error *error);
    /// Measure the current parameters on data that training does not use. May be null.
    bat_status (*validate)(void *context, double *metrics, bat_error *error);
} learn_job;

/// A finished epoch.
typedef struct learn_epoch
{
    uint64_t epoch;           ///< counted from 0
    uint64_t step;            ///< steps done in all at its end
    double rate;              ///< the learning rate
    double loss;              ///< mean over the steps
    double gradient_norm;     ///< mean over the steps, before clipping
    const double *metrics;    ///< job->metric_count: means over the steps
    const double *validation; ///< job->validation_count; NaN where the epoch was not validated
    double seconds;           ///< wall time; of a resumed epoch, since it was resumed
} learn_epoch;

/// Functions that follow a training, for example to write a log. Each may be null; a failure ends the training. In a group
/// rank 0 alone calls them.
typedef struct learn_observer
{
    void *context;
    /// Before the first step of a run; `step` steps were done by earlier runs.
    bat_status (*begin)(void *context, uint64_t step, bat_error *error);
    /// After every epoch.
    bat_status (*epoch)(void *context, const learn_epoch *epoch, bat_error *error);
    /// Where a checkpoint is due, after it was written.
    bat_status (*checkpoint)(void *context, bat_error *error);
} learn_observer;

/// How to train. Begin with learn_options_defaults().
typedef struct learn_options
{
    uint64_t epochs;                   ///< default 1
    learn_optimizer_options optimizer; ///< default AdamW (.9, .999), epsilon 1e-8, decay .01
    learn_schedule schedule;           ///< default constant 1e-3
    learn_plateau_options plateau;     ///< default: none
    double clip;                       ///< the largest norm of a gradient; default infinite
    uint64_t seed;                     ///< default 1
    size_t slots;              ///< gradients that are accumulated apart and summed in order: the most threads that help.
                               ///< Unlike threads they change roundings. 0: as many as pieces, up to 8; default 0
    int threads;               ///< of each process; 0: as many as OpenMP gives; default 0
    const bat_group *group;    ///< processes that divide the pieces of a step; default null
    uint64_t validate_every;   ///< epochs; the last epoch is always validated; default 1
    bool keep_last;            ///< end with the weights of the last step, not with the best validated; default false
    const char *name;          ///< identifies a checkpoint: another training's is refused; default ""
    const char *checkpoint;    ///< file; null for none; default null
    uint64_t checkpoint_every; ///< epochs; 0: at the end and when stopped; default 1
    bool resume;               ///< resume from the checkpoint if there is one; default false
    learn_observer observer;   ///< default: none
    bat_progress progress;     ///< called before every step
} learn_options;

learn_options learn_options_defaults(void);

/// The pieces of every step that this process differentiates.
group_items learn_own_pieces(const bat_group *group, size_t slots, size_t pieces);

/// The outcome of a training.
typedef struct learn_report
{
    uint64_t epochs, steps; ///< done, earlier runs included
    double loss;            ///< mean of the last complete epoch of this run; NaN when there was none
    double best;            ///< the lowest first number of a validation; infinite without validation
    uint64_t best_epoch;    ///< the epoch of that validation, counted from 0
    bool stopped;           ///< before the last epoch, because the validation no longer improved
} learn_report;

/// Train. When stopped through `progress`, the checkpoint holds the state at that step, and a resumed training continues to
/// the same bytes as an uninterrupted one.
///
/// In a group all processes call it, with the same job and options, and return the same status. A wish to stop of one stops
/// all after the step.
///
/// While it runs, OpenBLAS works on one thread in the whole process (linalg/blas_single.h).
///
/// @param report may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT for counts of 0 or a checkpoint of another seed, name or shape;
///         BAT_NO_CONVERGENCE with the step when a loss or gradient is not finite; BAT_BAD_FILE, BAT_FILE_ACCESS,
///         BAT_NO_MEMORY; what the functions of the job and the observer return
bat_status learn_train(const learn_job *job, const learn_options *options, learn_report *report, bat_error *error);

#endif
