#ifndef RESEARCH_TRAIN_TRAIN_H
#define RESEARCH_TRAIN_TRAIN_H

#include "learn/optimizer.h"
#include "learn/schedule.h"
#include "learn/tape.h"

/// @file
/// The loop that trains: pieces of a step in parallel, one update a step, checks, a log, checkpoints.
///
/// A step's loss is the sum of the losses of its pieces (a sample, a few samples, a mesh), each differentiated by itself.
/// All randomness is a function of the seed and of the place (epoch, step, piece), so that neither the number of threads nor
/// an interruption changes a byte of the result.

/// Which piece is asked for.
typedef struct learn_piece
{
    uint64_t epoch;
    uint64_t step;     ///< within the epoch
    size_t index;      ///< within the step
    bat_random random; ///< a stream of this piece's own
} learn_piece;

/// What is trained, and on what. Functions are called from the calling thread, but for `piece`.
typedef struct learn_job
{
    void *context;                ///< handed to the functions
    learn_parameters *parameters; ///< the weights to begin with, then the result
    uint64_t steps;               ///< of an epoch, at least 1
    size_t pieces;                ///< of a step, at least 1
    const char *const *figures;   ///< names of what is recorded of every piece beside the loss; no commas
    size_t figure_count;
    const char *const *checks; ///< names of the figures of a check; the first is watched: lower is better
    size_t check_count;

    /// Prepare an epoch: shuffle, draw new data. `random` is a stream of this epoch's own. Called again with the same
    /// arguments when a stopped run goes on within the epoch. May be null.
    bat_status (*epoch)(void *context, uint64_t epoch, bat_random *random, bat_error *error);
    /// Build the graph of a piece on a tape that has begun with the job's parameters and drops. Called from several threads
    /// at once. Leave *loss null for a piece that does not exist. `figures` are zero; they are added up over the pieces of a
    /// step and averaged over the steps of an epoch.
    bat_status (*piece)(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *figures,
                        bat_error *error);
    /// Measure the parameters as they are, for example on curves kept aside. May be null.
    bat_status (*check)(void *context, uint64_t epoch, double *figures, bat_error *error);
} learn_job;

/// How. Begin with learn_options_defaults().
typedef struct learn_options
{
    uint64_t epochs;                   ///< default 1
    learn_optimizer_options optimizer; ///< default AdamW (.9, .999), epsilon 1e-8, decay .01
    learn_schedule schedule;           ///< default constant 1e-3
    learn_watch_options watch;         ///< default: none
    double clip;                       ///< the longest gradient; default infinite
    uint64_t seed;                     ///< default 1
    size_t slots; ///< gradients that are kept apart and added up in order: the most threads that help. Changes roundings, as
                  ///< threads do not. 0: as many as pieces, up to 8; default 0
    int threads;  ///< 0: as OpenMP likes; default 0
    uint64_t check_every;      ///< epochs from check to check; the last epoch has one too; default 1
    bool keep_last;            ///< end with the weights of the last step, not with the best checked; default false
    const char *name;          ///< of the recipe; a checkpoint of another is refused; default ""
    const char *checkpoint;    ///< file; null for none; default null
    uint64_t checkpoint_every; ///< epochs; 0: at the end and when stopped; default 1
    bool resume;               ///< go on from the checkpoint if there is one; default false
    const char *log;           ///< CSV file; null for none; default null
    const char *chart;     ///< picture of the log, drawn with every checkpoint and at the end; null for none; default null
    bat_progress progress; ///< asked before every step
} learn_options;

learn_options learn_options_defaults(void);

/// How it went.
typedef struct learn_report
{
    uint64_t epochs, steps; ///< done, earlier runs included
    double loss;            ///< mean of the last whole epoch of this run; NaN when there was none
    double best;            ///< the least watched figure; infinite without checks
    uint64_t best_epoch;    ///< where it was, counted from 0
    bool stopped;           ///< early, because the figure no longer fell
} learn_report;

/// Train. When stopped through `progress`, the state at that step is in the checkpoint, and training goes on from it as if
/// nothing had been.
///
/// While it runs, OpenBLAS works on one thread in the whole process (linalg/blas_single.h).
///
/// @param report may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT for counts of 0 or a checkpoint of another seed, recipe or shape;
///         BAT_NO_CONVERGENCE with the step when a loss or gradient is not finite; BAT_BAD_FILE, BAT_FILE_ACCESS,
///         BAT_NO_MEMORY; what the job's functions return
bat_status learn_train(const learn_job *job, const learn_options *options, learn_report *report, bat_error *error);

#endif
