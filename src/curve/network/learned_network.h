#pragma once

#include "batten/curve_scheme.h"
#include "curve/network/learned_features.h"
#include "learn/model.h"

/// @file
/// The network of the learned curve rule. Every layer commutes with mirror and reversal (learn/klein.h):
///
///     linear, GELU;  blocks times x + [linear, GELU, linear](x);  GELU;  linear to two numbers
///
/// The mirror changes the sign of the first, the correction, and preserves the second, the gate: learned_angle(). The last
/// layer begins at zero, so that training begins with the six-point rule.
///
/// The network decides the first LEARNED_LEVELS levels; the six-point rule in turns the others.

#ifndef LEARNED_CHANNELS
#define LEARNED_CHANNELS 64
#endif
#ifndef LEARNED_BLOCKS
#define LEARNED_BLOCKS 4
#endif

enum
{
    LEARNED_WIDTH = KLEIN_COUNT * LEARNED_CHANNELS,
    LEARNED_LAYERS = 1 + 2 * LEARNED_BLOCKS, ///< but for the last
    LEARNED_LAYER_SIZE = KLEIN_COUNT + 1,    ///< arrays of a layer: four weights and a bias
    LEARNED_OUTPUTS = 2,                     ///< correction, gate
    LEARNED_LEVELS = 2,
    LEARNED_AT_OUTPUT = LEARNED_LAYERS * LEARNED_LAYER_SIZE,
    LEARNED_PARAMETERS = LEARNED_AT_OUTPUT + LEARNED_OUTPUTS
};

/// The weights' names and shapes, all zero.
/// @param parameters all zero before the call; release it with learn_parameters_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status learned_network_make(learn_parameters *parameters, bat_error *error);

// The shipped network as a rule of curve refinement; bat_curve_scheme_learned() is the one with the shipped weights.

/// What is wrong with a space for a learned rule, that of the published network too: bat_curve_angle_rule's fault().
const char *learned_rule_fault(const bat_curve_angle_rule *rule, const bat_space *space);

/// The rule with weights laid out as learned_network_make() describes them, which must outlive it.
bat_curve_angle_rule learned_rule(const real *weights);

/// The network as a row of learn/model.h, and its table.
extern const learn_network curve_network_learned;
extern const learn_networks curve_networks;

/// Read a model, a row's rule being a bat_curve_angle_rule whose parameters are the network.
bat_status curve_model_read(const learn_networks *networks, const char *path, bat_curve_model **model, bat_error *error);
