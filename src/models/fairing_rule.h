#ifndef MODELS_FAIRING_RULE_H
#define MODELS_FAIRING_RULE_H

#include "batten/scheme.h"
#include "learn/real.h"

/// @file
/// The shipped network as a rule of curve refinement; bat_scheme_learned() is the one with the shipped weights.

/// The rule with weights laid out as fairing_network_make() describes them, which must outlive it.
bat_angle_rule fairing_rule(const real *weights);

#endif
