#pragma once

#include "batten/cloud.h"
#include "search/nearest.h"

// Renumbering of a cloud in a k-d tree's leaf order: close interior points have close indices; the boundary stays.

/// The index of a point of the cloud in the input.
static inline size_t cloud_input_index(const bat_cloud *cloud, size_t point)
{
    return cloud->order != NULL ? cloud->order[point] : point;
}

/// Change the numbers of points, also in the triangles. The boundary and the corners are the caller's.
/// @param order the old number of each point
/// @return BAT_OK or BAT_NO_MEMORY; the cloud is untouched on failure
bat_status cloud_permute(bat_cloud *cloud, const size_t *order, bat_error *error);

/// A renumbered cloud.
typedef struct spatial_order
{
    bat_cloud cloud;   ///< points scaled to unit size, triangles, and indices in the input; no corners
    nearest_tree tree; ///< of these points, for neighbours_within() and neighbours_nearest() alone
    uint32_t *places;  ///< count: index of each point in the given cloud
} spatial_order;

/// Renumber a cloud. `order` is all zero on failure.
bat_status spatial_order_make(const bat_cloud *cloud, spatial_order *order, bat_error *error);
void spatial_order_free(spatial_order *order);

// An order of points that depends on their coordinates alone, so that results do not depend on the order of the input.

/// Half the distance from the centre of the bounding box, by which points are sorted.
double canonical_order_key(const double point[3], const double centre[3]);
/// Sort points by their distance from the centre of their bounding box, those at the same distance by their coordinates. The
/// order of a mirrored cloud is the same up to rounding.
/// @param points count x 3, finite
/// @param order  receives the indices of the points, [count]
/// @return BAT_OK or BAT_NO_MEMORY
bat_status canonical_order_find(const double *points, size_t count, size_t *order, bat_error *error);

/// Sort a cloud's points but for its boundary loop; one without corners begins at the first in the canonical order.
/// @return BAT_OK or BAT_NO_MEMORY; the cloud is untouched on failure
bat_status canonical_order_apply(bat_cloud *cloud, bat_error *error);
