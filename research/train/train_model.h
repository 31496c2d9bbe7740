#ifndef RESEARCH_TRAIN_TRAIN_MODEL_H
#define RESEARCH_TRAIN_TRAIN_MODEL_H

#include "learn/parameters.h"
#include "research/train/train.h"

/// @file
/// The file of weights that a training ends with.

/// Write the weights with notes: `recipe`, `seed`, `epochs` done, `best_epoch` counted from 1, and the best of what was
/// watched.
/// @param watched the name of that note
/// @return BAT_OK, BAT_NO_MEMORY or BAT_FILE_ACCESS
bat_status train_model_write(const char *path, const learn_parameters *parameters, const char *recipe, uint64_t seed,
                             const learn_report *made, const char *watched, bat_error *error);

#endif
