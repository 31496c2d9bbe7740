#ifndef MOTION_SPLINE_SMOOTH_H
#define MOTION_SPLINE_SMOOTH_H

#include "batten/motion_spline.h"
#include "motion/spline_factor.h"

/// Move noisy keys of one factor, FACTOR_FLAT or FACTOR_ROTATION, onto the penalized spline whose root mean square distance
/// from them is sigma; see bat_motion_spline_options. Ends are natural.
///
/// @param lengths of the count - 1 intervals in time
/// @param sigma   above 0
/// @param points  count x point_dim; replaced
/// @param deviations receives, for each key, the larger of what it has and the distance of the given key in units of sigma
/// @return BAT_OK; BAT_CUT_LOCUS with the key whose measurement is half a turn from the motion; BAT_NO_MEMORY
bat_status spline_smooth(const spline_factor *f, size_t count, const double *lengths, double sigma,
                         bat_motion_outliers outliers, double *points, double *deviations, bat_error *error);

/// The distance from the motion, in units of sigma, from which a rule lets keys count less; 0 for BAT_MOTION_OUTLIERS_NONE.
double motion_outliers_threshold(bat_motion_outliers outliers);

#endif
