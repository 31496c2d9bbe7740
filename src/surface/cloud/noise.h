#ifndef SURFACE_CLOUD_NOISE_H
#define SURFACE_CLOUD_NOISE_H

#include "surface/cloud/neighbours.h"

/// @file
/// Noise of a cloud, from residuals of local quadratic fits.

/// Estimate the standard deviation of a coordinate. Quadratic polynomials over local tangent planes are fitted to the
/// neighbours of up to 1,000 points. The estimate is the root of the median of their residual variances, divided by the
/// degrees of freedom and by the median of the distribution of chi squared (Wilson and Hilferty, 1931), so that creases and
/// outliers in less than half of the neighbourhoods do not count.
/// @param points of the tree
/// @return BAT_OK or BAT_NO_MEMORY
bat_status noise_estimate(const double *points, const neighbour_tree *tree, double *sigma, bat_error *error);

#endif
