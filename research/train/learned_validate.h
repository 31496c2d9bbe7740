#ifndef RESEARCH_TRAIN_LEARNED_VALIDATE_H
#define RESEARCH_TRAIN_LEARNED_VALIDATE_H

#include "batten/research/curve_train.h"
#include "learn/parameters.h"

/// @file
/// How well weights refine curves that were kept aside.

/// Refine the control polygons of each space's set by BAT_TENSION_LEVELS levels at one fairness and take the means of the
/// measures.
/// @return BAT_OK or what refining returned
bat_status learned_validate(const learn_parameters *parameters, const bat_tension_set sets[BAT_TENSION_SPACE_COUNT],
                            double fairness, int threads, bat_learned_score scores[BAT_TENSION_SPACE_COUNT],
                            bat_error *error);

#endif
