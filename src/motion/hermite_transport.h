#ifndef MOTION_HERMITE_TRANSPORT_H
#define MOTION_HERMITE_TRANSPORT_H

#include "batten/motion_hermite.h"
#include "curve/kernel.h"

/// Whether a mask is valid: finite matrices, and weights of points that sum to 1 for every new point and to 0 for
/// every new derivative, as invariance under translations requires.
/// @return BAT_OK or BAT_INVALID_ARGUMENT
bat_status hermite_mask_check(const bat_hermite_mask *mask, bat_error *error);

/// A linear Hermite step on rows of a point, a derivative and, where dim has room for one, a time. The mask must outlive it.
refine_kernel kernel_hermite_transport(const bat_space *space, size_t dim, const bat_hermite_mask *mask,
                                       bat_curve_base base);

#endif
