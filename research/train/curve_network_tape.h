#ifndef RESEARCH_TRAIN_CURVE_NETWORK_TAPE_H
#define RESEARCH_TRAIN_CURVE_NETWORK_TAPE_H

#include "curve/network/learned_network.h"
#include "research/train/tension_sample.h"

/// @file
/// The network of the shipped curve rule on a tape, and the loss of one training sample.

/// Draw weights.
void learned_network_start(learn_parameters *parameters, uint64_t seed);

/// Evaluate a batch of edges. The tape must have begun with the network's parameters.
/// @param features rows x LEARNED_FEATURES
/// @return rows x LEARNED_OUTPUTS
learn_array *learned_network_apply(learn_tape *tape, learn_array *features);

/// One step of the learned rule. The tape must have begun with the weights of learned_network_make().
/// @param level levels before this one; from LEARNED_LEVELS on the step is the six-point rule in turns
tape_polygon *curve_network_step(learn_tape *tape, tape_polygon *polygon, size_t level, double fairness);

/// The terms of the loss, and their sum. Each is relative to what classical schemes do with the same polygon.
typedef struct curve_network_loss
{
    /// To the truth, over the weights' unit, or else over the smaller one of the polygon's own distance and that of the
    /// six-point rule.
    learn_array *distance;
    learn_array *bending; ///< ln(b / (b + b_6)) of the bending b, that of the six-point rule being b_6
    learn_array *angle;   ///< power mean of the exterior angles, over that of the six-point rule
    learn_array *total;
} curve_network_loss;

/// The weights of the terms. Bending and angle together are the roughness.
typedef struct curve_loss_weights
{
    double min_roughness, max_roughness; ///< the roughness's weight at fairness 0 and 1; between them the
                                         ///< logarithm grows as a power of the fairness
    double angle;                        ///< weight of the angle, relative to that of bending
    double hinge;                        ///< further weight of the distance where it exceeds the classical one
    double distance_unit;                ///< a distance that a good rule reaches; 0: that of the classical rules
} curve_loss_weights;

/// Refine by `steps` levels and compute the loss of the result.
curve_network_loss curve_network_sample_loss(learn_tape *tape, const tension_sample *sample, size_t steps, double fairness,
                                             const curve_loss_weights *weights);

#endif
