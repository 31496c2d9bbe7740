#ifndef RESEARCH_TRAIN_LEARNED_SAMPLE_H
#define RESEARCH_TRAIN_LEARNED_SAMPLE_H

#include "research/train/tension_sample.h"

/// @file
/// The loss of one training sample of the shipped curve rule, as a graph on a tape.

/// One learned step. The tape must have begun with the weights of learned_network_make().
tape_polygon *learned_step(learn_tape *tape, tape_polygon *polygon, double fairness);

/// The terms of the loss, and the whole.
typedef struct learned_loss
{
    learn_array *distance; ///< to the truth
    learn_array *bending;  ///< ln(b / (b + unit)) of the refined polygon's bending b
    learn_array *angle;    ///< power mean of the refined polygon's
    learn_array *total;
} learned_loss;

/// How the terms are weighed.
typedef struct learned_weights
{
    double distance_unit[BAT_TENSION_SPACE_COUNT]; ///< a typical distance in each space
    double bending_unit[BAT_TENSION_SPACE_COUNT]; ///< who bends more than that must do so, and is asked less to do otherwise
    double angle_unit[BAT_TENSION_SPACE_COUNT];   ///< a typical largest angle of a polygon of 384 vertices
    double least, most;                           ///< weight of the other terms at fairness 0 and 1; geometric in between
    double angle;                                 ///< of the angle's term, relative to that of bending
} learned_weights;

/// Refine by `steps` learned steps and judge the result.
learned_loss learned_sample_loss(learn_tape *tape, const tension_sample *sample, bat_tension_space space, size_t steps,
                                 double fairness, const learned_weights *weights);

#endif
