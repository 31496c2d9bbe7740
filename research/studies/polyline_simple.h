#ifndef STUDIES_POLYLINE_SIMPLE_H
#define STUDIES_POLYLINE_SIMPLE_H

#include "batten/base.h"

/// Whether a polyline of the plane neither crosses nor touches itself. Points equal to the one before them are skipped.
/// Signs of areas are computed in doubles: nearly touching edges may be judged either way.
/// @param points 2 numbers each
/// @return BAT_OK or BAT_NO_MEMORY
bat_status polyline_is_simple(const double *points, size_t count, bool closed, bool *simple, bat_error *error);

#endif
