#ifndef RESEARCH_TRAIN_TENSION_TRAIN_H
#define RESEARCH_TRAIN_TENSION_TRAIN_H

#include "batten/research/curve_train.h"

/// bat_tension_train() on curves of the caller's.
/// @param data at least one curve to train on and one to validate with; a space may be without
bat_status tension_train_on(const bat_tension_data *data, const bat_tension_train_options *options,
                            bat_tension_train_report *report, bat_error *error);

#endif
