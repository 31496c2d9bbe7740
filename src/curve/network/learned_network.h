#ifndef CURVE_NETWORK_LEARNED_NETWORK_H
#define CURVE_NETWORK_LEARNED_NETWORK_H

#include "curve/network/learned_features.h"
#include "learn/operations.h"

/// @file
/// The network of the shipped curve rule. Every layer commutes with mirror and reversal (learn/klein.h):
///
///     linear, GELU;  blocks times x + [linear, GELU, linear](x);  GELU;  linear to one number that the mirror changes the
///     sign of
///
/// What it gives, through tanh, is the share of learned_features.scale that is added to the six-point angle. The last layer
/// begins at zero, so that training sets out from the six-point rule.

#ifndef LEARNED_CHANNELS
#define LEARNED_CHANNELS 64
#endif
#ifndef LEARNED_BLOCKS
#define LEARNED_BLOCKS 3
#endif

enum
{
    LEARNED_WIDTH = KLEIN_COUNT * LEARNED_CHANNELS,
    LEARNED_LAYERS = 1 + 2 * LEARNED_BLOCKS, ///< but for the last
    LEARNED_LAYER_SIZE = KLEIN_COUNT + 1,    ///< arrays of a layer: four weights and a bias
    LEARNED_AT_OUTPUT = LEARNED_LAYERS * LEARNED_LAYER_SIZE,
    LEARNED_PARAMETERS = LEARNED_AT_OUTPUT + 1
};

/// The weights' names and shapes, all zero.
/// @param parameters all zero before the call; release it with learn_parameters_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status learned_network_make(learn_parameters *parameters, bat_error *error);
/// Draw weights.
void learned_network_start(learn_parameters *parameters, uint64_t seed);

/// What the network says of a batch of edges, before the tanh: rows x 1. The tape must have begun with its parameters.
/// @param features rows x LEARNED_FEATURES
learn_array *learned_network_apply(learn_tape *tape, learn_array *features);

#endif
