#ifndef SURFACE_SPLINE_TENSOR_REFINE_H
#define SURFACE_SPLINE_TENSOR_REFINE_H

#include "batten/spline.h"

/// Cut a surface down to the part between two parameters of a direction's domain, low below high, its knots clamped there.
/// @return BAT_OK or BAT_NO_MEMORY, the surface then being as it was
bat_status tensor_surface_restrict(bat_tensor_surface *surface, int direction, double low, double high, bat_error *error);

#endif
