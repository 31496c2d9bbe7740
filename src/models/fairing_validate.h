#ifndef MODELS_FAIRING_VALIDATE_H
#define MODELS_FAIRING_VALIDATE_H

#include "batten/fairing_train.h"
#include "learn/parameters.h"

/// @file
/// How well weights refine curves that were kept aside.

/// Refine the control polygons of each space's set by BAT_TENSION_LEVELS levels at one fairness and take the means of the
/// measures.
/// @return BAT_OK or what refining returned
bat_status fairing_validate(const learn_parameters *parameters, const bat_tension_set sets[BAT_TENSION_SPACE_COUNT],
                            double fairness, int threads, bat_fairing_score scores[BAT_TENSION_SPACE_COUNT],
                            bat_error *error);

#endif
