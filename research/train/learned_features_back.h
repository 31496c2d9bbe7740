#ifndef RESEARCH_TRAIN_LEARNED_FEATURES_BACK_H
#define RESEARCH_TRAIN_LEARNED_FEATURES_BACK_H

#include "curve/network/learned_features.h"

/// The insertion angle of the levels after the learned ones: the rule of base, with the turns z_i that are bounded at
/// corners.
double learned_later(const double *angles, const double *lengths);
/// Add the gradients of learned_later() with respect to angles and lengths.
void learned_later_back(const double *angles, const double *lengths, double gradient, double *angle_gradient,
                        double *length_gradient);

/// Add the gradients with respect to angles and lengths to arrays that are placed like them. Statistics are of the given
/// polygon, which has no gradient; they are 0 at later levels.
/// @param feature_gradient with respect to the features
/// @param edge_gradient    with respect to the result
void learned_features_back(const double *angles, const double *lengths, learned_setting setting,
                           const double *feature_gradient, learned_edge edge_gradient, double *angle_gradient,
                           double *length_gradient);

#endif
