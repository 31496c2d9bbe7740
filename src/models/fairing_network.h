#ifndef MODELS_FAIRING_NETWORK_H
#define MODELS_FAIRING_NETWORK_H

#include "learn/operations.h"
#include "models/fairing_sight.h"

/// @file
/// The network of the shipped curve rule. Every layer commutes with mirror and reversal (learn/klein.h):
///
///     linear, GELU;  blocks times x + [linear, GELU, linear](x);  GELU;  linear to one number that the mirror changes the sign of
///
/// What it gives, through tanh, is the share of fairing_sight.scale that is added to the six-point angle. The last layer begins
/// at zero, so that training sets out from the six-point rule.

#ifndef FAIRING_CHANNELS
#define FAIRING_CHANNELS 64
#endif
#ifndef FAIRING_BLOCKS
#define FAIRING_BLOCKS 3
#endif

enum
{
    FAIRING_WIDTH = KLEIN_COUNT * FAIRING_CHANNELS,
    FAIRING_LAYERS = 1 + 2 * FAIRING_BLOCKS, ///< but for the last
    FAIRING_LAYER_SIZE = KLEIN_COUNT + 1,    ///< arrays of a layer: four weights and a bias
    FAIRING_AT_OUTPUT = FAIRING_LAYERS * FAIRING_LAYER_SIZE,
    FAIRING_PARAMETERS = FAIRING_AT_OUTPUT + 1
};

/// The weights' names and shapes, all zero.
/// @param parameters all zero before the call; release it with learn_parameters_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status fairing_network_make(learn_parameters *parameters, bat_error *error);
/// Draw weights.
void fairing_network_start(learn_parameters *parameters, uint64_t seed);

/// What the network says of a batch of edges, before the tanh: rows x 1. The tape must have begun with its parameters.
/// @param features rows x FAIRING_SEEN
learn_array *fairing_network_apply(learn_tape *tape, learn_array *features);

#endif
