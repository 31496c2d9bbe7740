#ifndef LEARN_CHECKPOINT_H
#define LEARN_CHECKPOINT_H

#include "learn/optimizer.h"
#include "learn/parameters.h"
#include "learn/schedule.h"

/// @file
/// The state of a training between two steps, and its file (safetensors):
///
///     weight.NAME, best.NAME           the weights, and the best ones so far if there are any
///     optimizer.mean, .squares         laid out like all weights one after the other
///     state.NAME                       single numbers: steps done, the watch, the seed from which all randomness follows
///     sums                             of the figures of the epoch that is under way
///
/// Note `recipe` is the name of the recipe.

typedef struct learn_state
{
    uint64_t seed;
    uint64_t pieces, slots, epoch_steps; ///< on which the meaning of the rest depends
    uint64_t step;                       ///< steps done in all
    learn_optimizer optimizer;
    learn_watch watch;
    bool has_best;
    real *best;   ///< weights of the best check
    double *sums; ///< of the epoch under way
    size_t sum_count;
} learn_state;

/// @return BAT_OK, BAT_NO_MEMORY or BAT_FILE_ACCESS; the file appears whole or stays as it was
bat_status learn_checkpoint_write(const char *path, const char *recipe, const learn_parameters *parameters,
                                  const learn_state *state, bat_error *error);
/// Read into a state whose arrays are there and whose seed, pieces, slots and epoch_steps say what is expected.
/// @return BAT_OK, BAT_INVALID_ARGUMENT when the file is of another training, BAT_BAD_FILE, BAT_FILE_ACCESS or BAT_NO_MEMORY
bat_status learn_checkpoint_read(const char *path, const char *recipe, learn_parameters *parameters, learn_state *state,
                                 bat_error *error);

#endif
