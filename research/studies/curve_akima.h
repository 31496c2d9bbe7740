#ifndef STUDIES_CURVE_AKIMA_H
#define STUDIES_CURVE_AKIMA_H

#include "batten/curve.h"

/// Akima's interpolation (1970) of each coordinate by chord length, at 2^levels equal parts of every edge. Closed curves are
/// continued periodically, open ones by Akima's quadratic rule.
/// @param coarse a curve of R^n
/// @param fine   receives the curve; release it with bat_curve_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status curve_akima(const bat_curve *coarse, size_t levels, bat_curve *fine, bat_error *error);

#endif
