#pragma once

#include "batten/curve_scheme.h"

/// Whether a mask can be worked with: 1 to BAT_MASK_MAX finite moderate coefficients, not all zero, a moderate first index.
/// @return BAT_OK or BAT_INVALID_ARGUMENT with the coefficient at fault
bat_status mask_check(const bat_mask *mask, bat_error *error);

/// Whether a mask is at most its own length away from index 0: with others the curve is elsewhere along the points.
/// @return BAT_OK or BAT_INVALID_ARGUMENT with the range of the first index
bat_status mask_check_place(const bat_mask *mask, bat_error *error);

/// The same mask without zeros at its ends; empty when all are zero.
bat_mask mask_trimmed(const bat_mask *mask);

/// The coefficients of a mask for new points of one parity: new point 2 j + parity is the sum over k of weights[k] times
/// old point j + start + k. No weight at either end is zero.
typedef struct mask_taps
{
    double weights[BAT_MASK_MAX];
    size_t count;
    ptrdiff_t start;
} mask_taps;

/// `parity` is 0 or 1.
mask_taps mask_taps_of(const bat_mask *mask, int parity);

/// Whether the refined curve contains the vertices of the coarse one: a(0) = 1 and every other even coefficient 0.
bool mask_is_interpolatory(const bat_mask *mask);

/// Whether a(c - k) = a(c + k) for some centre c.
bool mask_is_symmetric(const bat_mask *mask);
