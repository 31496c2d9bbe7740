#ifndef MODELS_FAIRING_RULE_H
#define MODELS_FAIRING_RULE_H

#include "batten/scheme.h"
#include "learn/real.h"

/// @file
/// The shipped network as a rule of curve refinement; bat_scheme_learned() is the one with the shipped weights.

/// What is wrong with a space for a learned rule, that of the published network too: bat_angle_rule's fault().
const char *fairing_rule_fault(const bat_angle_rule *rule, const bat_space *space);

/// The rule with weights laid out as fairing_network_make() describes them, which must outlive it.
bat_angle_rule fairing_rule(const real *weights);

#endif
