#ifndef SURFACE_FIT_ROBUST_H
#define SURFACE_FIT_ROBUST_H

#include "surface/fit/points.h"

/// @file
/// Weights of points with outliers among them.

/// One step of iteratively re-weighted least squares with Tukey's biweight (Beaton and Tukey, 1974):
///     w_i = (1 - t^2)^2 for t < 1, else 0,   t = d_i / (4.685 s_i),   s_i = 1.4826 max(median of all d, median of the
///     neighbours' d).
/// The second median is that of the neighbours in Morton order. It prevents that a feature which the surface is still too
/// stiff to follow is taken for outliers.
/// @param outliers receives the number of points of weight 0
/// @param size     the largest absolute coordinate of all points
/// @return BAT_OK or BAT_NO_MEMORY
bat_status fit_robust_weights(fit_points *points, double size, size_t *outliers, bat_error *error);

#endif
