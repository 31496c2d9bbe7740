#ifndef BATTEN_RESEARCH_TRAIN_H
#define BATTEN_RESEARCH_TRAIN_H

#include "batten/base.h"
#include "batten/research/distributed.h"

BAT_C_BEGIN

/// @file
/// What all trainings have in common. A training has a recipe: network, data, loss and hyperparameters.

/// The two recipes of a training.
typedef enum bat_recipe
{
    BAT_RECIPE_PUBLISHED, ///< that of the paper
    BAT_RECIPE_BATTEN     ///< that of the weights that the library comes with
} bat_recipe;

/// "published" or "batten"; null for any other value.
BAT_API const char *bat_recipe_name(bat_recipe recipe);

/// The largest number of epochs, of threads, and of slots.
#define BAT_TRAIN_MAX_EPOCHS 1000000000
#define BAT_TRAIN_MAX_THREADS 1024
#define BAT_TRAIN_MAX_SLOTS 4096

/// Options of all trainings. They are the first field, `run`, of the options of each.
typedef struct bat_train_options
{
    uint64_t seed;   ///< of the initial weights, the data, their order and dropout; default 1
    uint64_t epochs; ///< at most, 1 to BAT_TRAIN_MAX_EPOCHS; a cosine decay of the learning rate takes as many
    /// The folder for the files; it and its parents are made where they are missing. During the training: the log `log.csv`,
    /// its picture `log.png`, and every few epochs and at a stop `checkpoint.safetensors`. At the end: `model.safetensors`.
    /// Null for no files; default null.
    const char *folder;
    /// Resume from the folder's checkpoint, if there is one, to the same bytes as without the interruption; default false.
    bool resume;
    /// Of each process, 0 to BAT_TRAIN_MAX_THREADS; 0: as many as OpenMP gives; the result does not depend on it; default 0.
    int threads;
    /// Gradients of a step that are accumulated apart, each from consecutive samples, and then summed in order; 0 to
    /// BAT_TRAIN_MAX_SLOTS, and at most the samples of a step; 0: 8. At most as many threads of all processes work at a
    /// step. Other numbers of slots round otherwise, so the result depends on it; default 0.
    size_t slots;
    /// Processes that divide the samples of each step; the result does not depend on their number. All make the same call,
    /// with report or without. Rank 0 alone uses the folder; default null.
    const bat_group *group;
    bat_progress progress; ///< called before every step; when it asks to stop, the checkpoint is written first
} bat_train_options;

/// The outcome of any training.
typedef struct bat_train_report
{
    uint64_t epochs;     ///< done, earlier runs included
    uint64_t best_epoch; ///< the epoch after which the validation was best, counted from 1
    bool stopped;        ///< before the last epoch, because the validation no longer improved
    double loss;         ///< mean over the last complete epoch of this run; NaN when there was none
    double best;         ///< the validation metric of that epoch; the training's page in docs/ tells which
} bat_train_report;

BAT_C_END

#endif
