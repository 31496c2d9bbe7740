#ifndef RESEARCH_TRAIN_GEOMETRY_LOSS_H
#define RESEARCH_TRAIN_GEOMETRY_LOSS_H

#include "research/train/geometry_polygon.h"

/// @file
/// How fair a polygon is, as losses of its profile. Each NAME_back() takes the gradient with respect to the loss's value.
/// For open polygons means run over what there is.

/// Mean of the squared angles: eq. (20) of Ugail and Howard (2026).
double geometry_smoothness(const geometry_polygon *polygon, geometry_profile profile);
void geometry_smoothness_back(const geometry_polygon *polygon, geometry_profile profile, double loss_gradient,
                              geometry_profile gradient);

/// Mean of the squares of angle / (mean length of its two edges + offset): eq. (21). The published program's offset is
/// BAT_CURVE_BENDING_OFFSET.
double geometry_bending(const geometry_polygon *polygon, geometry_profile profile, double offset);
void geometry_bending_back(const geometry_polygon *polygon, geometry_profile profile, double offset, double loss_gradient,
                           geometry_profile gradient);

/// Mean of the squared differences of angles at neighbouring vertices.
double geometry_angle_variation(const geometry_polygon *polygon, geometry_profile profile);
void geometry_angle_variation_back(const geometry_polygon *polygon, geometry_profile profile, double loss_gradient,
                                   geometry_profile gradient);

/// Power mean (mean |angle|^power)^(1/power), power > 1: a differentiable stand-in for the largest angle.
double geometry_angle_power_mean(const geometry_polygon *polygon, geometry_profile profile, double power);
void geometry_angle_power_mean_back(const geometry_polygon *polygon, geometry_profile profile, double power,
                                    double loss_gradient, geometry_profile gradient);

#endif
