#ifndef MODELS_TENSION_ABLATION_H
#define MODELS_TENSION_ABLATION_H

#include "batten/tension_ablation.h"

/// Train some variants on curves of the caller's; no published figures.
/// @param data as for tension_train_on()
/// @param rows receives `count` rows
bat_status tension_ablate_on(const bat_tension_data *data, const bat_tension_variant *variants, size_t count,
                             const bat_tension_ablation_options *options, bat_tension_ablation_row *rows, bat_error *error);

#endif
