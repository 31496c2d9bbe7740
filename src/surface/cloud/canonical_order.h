#ifndef SURFACE_CLOUD_CANONICAL_ORDER_H
#define SURFACE_CLOUD_CANONICAL_ORDER_H

#include "batten/cloud.h"

/// @file
/// An order of points that depends on their coordinates alone, so that results do not depend on the order of the input.

/// Sort points by their distance from the centre of their bounding box, those at the same distance by their coordinates. The
/// order of a mirrored cloud is the same up to rounding.
/// @param points count x 3, finite
/// @param order  receives the indices of the points, [count]
/// @return BAT_OK or BAT_NO_MEMORY
bat_status canonical_order_find(const double *points, size_t count, size_t *order, bat_error *error);

/// Sort the points of a cloud that are not on its boundary loop. A loop without corners begins at the point that is first
/// in the canonical order.
/// @return BAT_OK or BAT_NO_MEMORY; the cloud is untouched on failure
bat_status canonical_order_apply(bat_cloud *cloud, bat_error *error);

#endif
