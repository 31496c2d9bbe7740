#ifndef SURFACE_FIT_FIT_ROBUST_H
#define SURFACE_FIT_FIT_ROBUST_H

#include "surface/fit/fit_points.h"

/// Weigh points anew by their distances, the next step of iteratively re-weighted least squares: Tukey's biweight (Beaton
/// and Tukey, 1974) of the distance over its scale, 1.4826 times a median. The scale of a point is the larger of that of all
/// points and that of its neighbours along the Morton curve, so that where a surface is still too stiff for a shape no shape
/// is taken for outliers.
/// @param outliers receives how many points weigh nothing
bat_status fit_robust_weigh(fit_points *points, size_t *outliers, bat_error *error);

#endif
