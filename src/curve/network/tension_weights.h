#ifndef CURVE_NETWORK_TENSION_WEIGHTS_H
#define CURVE_NETWORK_TENSION_WEIGHTS_H

#include "curve/network/tension_network.h"
#include "learn/parameters.h"

/// @file
/// The weights of networks of Ugail and Howard (2026), section 5.3 or table 3, from safetensors files as
/// bat_curve_model_read() describes them.

/// The prefix of a file's arrays, where one of the name is there: a checkpoint has more than one set of weights.
bool tension_weights_prefix(const safetensors *content, const char *wanted, const char **prefix);

/// The weights in a file's content.
/// @param parameters receives the weights, laid out as tension_network_make_embedded() does; release it with
/// learn_parameters_free()
/// @param embedding  receives which of the networks it is
bat_status tension_weights_take(const safetensors *content, learn_parameters *parameters, tension_embedding *embedding,
                                bat_error *error);

/// The weights in a file, or for null those that the library holds.
bat_status tension_weights_read(const char *path, learn_parameters *parameters, tension_embedding *embedding,
                                bat_error *error);

#endif
