#ifndef CURVE_NETWORK_LEARNED_RULE_H
#define CURVE_NETWORK_LEARNED_RULE_H

#include "batten/curve_scheme.h"
#include "learn/real.h"

/// @file
/// The shipped network as a rule of curve refinement; bat_curve_scheme_learned() is the one with the shipped weights.

/// What is wrong with a space for a learned rule, that of the published network too: bat_curve_angle_rule's fault().
const char *learned_rule_fault(const bat_curve_angle_rule *rule, const bat_space *space);

/// The rule with weights laid out as learned_network_make() describes them, which must outlive it.
bat_curve_angle_rule learned_rule(const real *weights);

#endif
