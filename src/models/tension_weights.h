#ifndef MODELS_TENSION_WEIGHTS_H
#define MODELS_TENSION_WEIGHTS_H

#include "batten/tension_train.h"
#include "learn/parameters.h"

/// Read the weights of a network of Ugail and Howard (2026), section 5.3 or table 3, from a safetensors file, as
/// bat_tension_model_read() describes it.
/// @param parameters receives the weights, laid out as tension_predictor_make() does; release it with learn_parameters_free()
/// @param embedding  receives which of the networks it is
bat_status tension_weights_read(const char *path, learn_parameters *parameters, bat_tension_embedding *embedding,
                                bat_error *error);

#endif
