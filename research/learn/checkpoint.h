#ifndef RESEARCH_LEARN_CHECKPOINT_H
#define RESEARCH_LEARN_CHECKPOINT_H

#include "learn/parameters.h"
#include "research/learn/optimizer.h"

/// @file
/// The state of a training between two steps, and its file (safetensors):
///
///     weight.NAME, best.NAME           the weights, and the best ones so far if there are any
///     optimizer.mean, .squares         in the order of all weights
///     state.NAME                       single numbers: steps done, plateau, the seed that determines all randomness
///     sums                             of the loss, the gradient's norm and the metrics in the current epoch
///
/// The note `recipe` holds all hyperparameters except the seed; it identifies a checkpoint.

typedef struct learn_state
{
    uint64_t seed;
    uint64_t pieces, slots, epoch_steps; ///< the other fields are valid for these alone
    uint64_t step;                       ///< steps done in all
    learn_optimizer optimizer;
    learn_plateau plateau;
    bool has_best;
    real *best;   ///< weights of the best validation
    double *sums; ///< over the current epoch
    size_t sum_count;
} learn_state;

/// Errors name the file, which appears complete or stays unchanged.
/// @return BAT_OK, BAT_NO_MEMORY or BAT_FILE_ACCESS
bat_status learn_checkpoint_write(const char *path, const char *recipe, const learn_parameters *parameters,
                                  const learn_state *state, bat_error *error);
/// Read into a state whose arrays are allocated and whose seed, pieces, slots and epoch_steps must agree with the file.
/// Errors name the file.
/// @return BAT_OK, BAT_INVALID_ARGUMENT when the file belongs to another training, BAT_BAD_FILE, BAT_FILE_ACCESS or
/// BAT_NO_MEMORY
bat_status learn_checkpoint_read(const char *path, const char *recipe, learn_parameters *parameters, learn_state *state,
                                 bat_error *error);

#endif
