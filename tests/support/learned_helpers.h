#ifndef TESTS_SUPPORT_LEARNED_HELPERS_H
#define TESTS_SUPPORT_LEARNED_HELPERS_H

// Random weights of the learned rule's network, and refinement with them.

#include "geometry_helpers.h"
#include "refine_helpers.h"

#include "curve/network/learned_network.h"
#include "research/learn/parameters.h"
#include "research/train/curve_network_tape.h"

/// As training would draw them, with a last layer and biases that are not zero.
static inline learn_parameters random_weights(uint64_t seed)
{
    learn_parameters parameters = {0};
    bat_random random = bat_random_seed(seed);
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    learned_network_start(&parameters, seed);
    for (size_t i = LEARNED_AT_OUTPUT; i < LEARNED_PARAMETERS; i++)
        learn_parameter_fill_normal(&parameters, i, 0.05, &random);
    for (size_t i = 0; i < LEARNED_AT_OUTPUT; i++)
        if (parameters.list[i].rank == 1)
            learn_parameter_fill_normal(&parameters, i, 0.1, &random);
    return parameters;
}

/// A rule must outlive the options.
static inline bat_curve_refine_options by_rule(const bat_curve_angle_rule *rule, double fairness, size_t levels)
{
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = bat_curve_scheme_angle_rule(rule);
    how.scheme.fairness = fairness;
    how.levels = levels;
    how.simple = BAT_CURVE_SIMPLE_NEVER; // the rule alone
    return how;
}

#endif
