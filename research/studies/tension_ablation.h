#ifndef RESEARCH_STUDIES_TENSION_ABLATION_H
#define RESEARCH_STUDIES_TENSION_ABLATION_H

#include "batten/research/curve_study.h"

/// @file
/// Ablation of the learned tension scheme on any data.

/// Train variants on the given curves, without the published numbers.
/// @param data as for curve_train_size
/// @param rows receives `count` rows
bat_status tension_ablate_on(const bat_tension_data *data, const bat_tension_variant *variants, size_t count,
                             const bat_tension_ablation_options *options, bat_tension_ablation_row *rows, bat_error *error);

#endif
