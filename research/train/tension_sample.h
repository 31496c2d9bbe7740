#ifndef RESEARCH_TRAIN_TENSION_SAMPLE_H
#define RESEARCH_TRAIN_TENSION_SAMPLE_H

#include "batten/research/curve_train.h"
#include "research/train/tape_polygon.h"

/// @file
/// The loss of one training sample of Ugail and Howard (2026), Algorithm 1, as a graph on a tape.

/// A closed control polygon and its true curve.
typedef struct tension_sample
{
    geometry_polygon control;
    const double *truth; ///< truth_count x geometry_dim()
    size_t truth_count;
} tension_sample;

/// Curve i of a set.
tension_sample tension_sample_of(const bat_tension_set *set, bat_tension_space space, size_t i);
geometry_surface tension_surface(bat_tension_space space);

/// The weights of a network of section 5.3 or table 3, all zero.
bat_status tension_predictor_make(bat_tension_embedding embedding, learn_parameters *parameters, bat_error *error);
/// The network's insertion angles, positive to the left of the edge, as printed.
/// @param features rows x 6 (tape_polygon_features())
learn_array *tension_predict(learn_tape *tape, learn_array *features, geometry_surface surface,
                             bat_tension_embedding embedding);
/// One learned step.
tape_polygon *tension_step(learn_tape *tape, tape_polygon *polygon, bat_tension_embedding embedding);

/// The terms of eq. (18), and their sum.
typedef struct tension_loss
{
    learn_array *chamfer, *smoothness, *bending;
    learn_array *consistency; ///< null when its weight is 0
    learn_array *total;
} tension_loss;

/// Warm up with tension -0.15, refine by two learned steps and compute the loss of the result. The tape must have begun with
/// the weights of tension_predictor_make().
/// @param random for the isometries of eq. (22)
tension_loss tension_sample_loss(learn_tape *tape, const tension_sample *sample, const bat_curve_train_options *options,
                                 bat_random *random);
/// Eq. (22) for a polygon that is held fixed.
learn_array *tension_consistency(learn_tape *tape, const geometry_polygon *polygon, bat_tension_embedding embedding,
                                 bat_random *random);

#endif
