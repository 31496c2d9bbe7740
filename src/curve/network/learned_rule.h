#ifndef CURVE_NETWORK_LEARNED_RULE_H
#define CURVE_NETWORK_LEARNED_RULE_H

#include "batten/curve_scheme.h"
#include "learn/model.h"

/// @file
/// The shipped network as a rule of curve refinement; bat_curve_scheme_learned() is the one with the shipped weights.

/// What is wrong with a space for a learned rule, that of the published network too: bat_curve_angle_rule's fault().
const char *learned_rule_fault(const bat_curve_angle_rule *rule, const bat_space *space);

/// The rule with weights laid out as learned_network_make() describes them, which must outlive it.
bat_curve_angle_rule learned_rule(const real *weights);

/// The network as a row of learn/model.h, and its table.
extern const learn_network curve_network_learned;
extern const learn_networks curve_networks;

/// Read a model, a row's rule being a bat_curve_angle_rule whose parameters are the network.
bat_status curve_model_read(const learn_networks *networks, const char *path, bat_curve_model **model, bat_error *error);

#endif
