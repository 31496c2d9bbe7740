#ifndef RESEARCH_TRAIN_TENSION_VALIDATE_H
#define RESEARCH_TRAIN_TENSION_VALIDATE_H

#include "research/train/tension_sample.h"

/// @file
/// How well weights refine curves that were kept aside.

/// Refine the control polygons of each space's set by BAT_TENSION_LEVELS learned steps and measure them against their truths
/// (Ugail and Howard 2026, section 7.1: all levels are learned, without the warm-up of training). A set without curves
/// scores NaN.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status tension_validate(const learn_parameters *parameters, bat_tension_embedding embedding,
                            const bat_tension_set sets[BAT_TENSION_SPACE_COUNT], int threads,
                            bat_tension_score scores[BAT_TENSION_SPACE_COUNT], bat_error *error);

/// The figure that is watched (section 6.4): the mean over the spaces that have curves of their mean_nn.
double tension_cross_mean(const bat_tension_score scores[BAT_TENSION_SPACE_COUNT]);

#endif
