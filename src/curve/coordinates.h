#ifndef CURVE_COORDINATES_H
#define CURVE_COORDINATES_H

#include "batten/curve.h"

/// Check that the differences of a curve's coordinates can be taken: none is beyond DBL_MAX / 2, infinite or NaN.
/// @param which "first", "second", …, for the message
/// @return BAT_OK or BAT_INVALID_POINT with the point's index
bat_status coordinates_check(const bat_curve *curve, const char *which, bat_error *error);

#endif
