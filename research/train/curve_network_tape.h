#ifndef RESEARCH_TRAIN_CURVE_NETWORK_TAPE_H
#define RESEARCH_TRAIN_CURVE_NETWORK_TAPE_H

#include "research/train/tension_sample.h"

/// @file
/// The network of the shipped curve rule on a tape, and the loss of one training sample.

/// One learned step. The tape must have begun with the weights of learned_network_make().
tape_polygon *curve_network_step(learn_tape *tape, tape_polygon *polygon, double fairness);

/// The terms of the loss, and their sum.
typedef struct curve_network_loss
{
    learn_array *distance; ///< to the truth
    learn_array *bending;  ///< ln(b / (b + unit)) of the refined polygon's bending b
    learn_array *angle;    ///< power mean of the refined polygon's
    learn_array *total;
} curve_network_loss;

/// The weights of the terms. Bending and angle together are the roughness.
typedef struct curve_loss_weights
{
    double distance_unit[BAT_TENSION_SPACE_COUNT]; ///< a typical distance in each space
    double bending_unit[BAT_TENSION_SPACE_COUNT];  ///< the penalty saturates above it, where the curve itself bends
    double angle_unit[BAT_TENSION_SPACE_COUNT];    ///< a typical largest angle of a polygon of 384 vertices
    double min_roughness, max_roughness;           ///< the roughness's weight at fairness 0 and 1; geometric in between
    double angle;                                  ///< weight of the angle, relative to that of bending
} curve_loss_weights;

/// Refine by `steps` learned steps and compute the loss of the result.
curve_network_loss curve_network_sample_loss(learn_tape *tape, const tension_sample *sample, bat_tension_space space,
                                             size_t steps, double fairness, const curve_loss_weights *weights);

#endif
