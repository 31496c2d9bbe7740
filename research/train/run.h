#ifndef RESEARCH_TRAIN_RUN_H
#define RESEARCH_TRAIN_RUN_H

#include "batten/research/train.h"
#include "learn/parameters.h"
#include "research/train/log.h"

/// @file
/// One training from its options to its files and report. What makes trainings differ is a recipe: a row of data and
/// functions.

enum
{
    TRAIN_TEXT_SIZE = 512
};

/// What the functions of a recipe work on: the first member of a recipe's own struct, which is all zero but for `options`
/// and what the recipe's caller sets.
typedef struct train_context
{
    const bat_train_options *options;
    learn_parameters parameters; ///< the weights
    uint64_t begun_with;         ///< a hash of the weights that train_begin() read; 0 for random ones
} train_context;

/// A recipe. All functions get a pointer to the recipe's own struct; those of learn_job are described there.
typedef struct train_recipe
{
    train_log_columns columns;
    const char *best_note; ///< name of the model's note with the best validation; null where the last weights are taken
    learn_optimizer_options optimizer;
    learn_schedule schedule; ///< its epochs are those of the options
    learn_plateau_options plateau;
    double clip;
    uint64_t validate_every, checkpoint_every; ///< epochs

    /// Refuse options that are out of range.
    bat_status (*check)(const void *context, bat_error *error);
    /// Make the data and the initial weights.
    bat_status (*make)(void *context, bat_error *error);
    /// Set the steps and pieces of the job, and what depends on options.
    void (*configure)(const void *context, learn_job *job, learn_options *options);
    /// Write all hyperparameters except the seed; identifies a checkpoint.
    void (*describe)(const void *context, char text[TRAIN_TEXT_SIZE]);
    bat_status (*prepare_epoch)(void *context, uint64_t epoch, bat_random *random, bat_error *error);
    bat_status (*piece_loss)(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *metrics,
                             bat_error *error);
    bat_status (*validate)(void *context, double *metrics, bat_error *error);
} train_recipe;

enum
{
    TRAIN_RECIPES = BAT_RECIPE_BATTEN + 1
};

/// Check the options, make the folder, train, and write the model with its notes.
/// @param recipes by bat_recipe
/// @param context the recipe's own struct; it holds the final weights afterwards, and the caller releases it in any case
/// @param report  null for none
bat_status train_run(const train_recipe *const recipes[TRAIN_RECIPES], bat_recipe which, void *context,
                     bat_train_report *report, bat_error *error);

/// Begin with the weights of a file in place of random ones.
/// @return BAT_OK or the failures of safetensors_read() and learn_parameters_extract()
bat_status train_begin(train_context *context, const char *path, bat_error *error);
/// Add to a description with which weights the training began; nothing for random ones.
void train_describe_begin(const train_context *context, char text[TRAIN_TEXT_SIZE]);

/// The progress of what precedes the training: forwards the wish to stop, and the share 0.
/// @param given stays in use
bat_progress train_progress_before(bat_progress *given);

/// An option and its range.
typedef struct train_range
{
    const char *field;
    double value, min, max; ///< an infinite max admits any finite number
    bool above;             ///< min itself is out of range
    bool below;             ///< max itself is out of range
} train_range;

/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the first field out of range, and its range
bat_status train_check_ranges(const train_range *ranges, size_t count, bat_error *error);

/// Put 0 … count - 1 into a random order.
void train_shuffle(size_t *order, size_t count, bat_random *random);

/// Mark the samples that this process differentiates in an epoch whose steps take `batch` samples each, in this order, one a
/// piece.
void train_own_samples(const bat_train_options *options, const size_t *order, size_t count, size_t batch, bool *own);

#endif
