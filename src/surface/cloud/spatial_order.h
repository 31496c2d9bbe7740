#ifndef SURFACE_CLOUD_SPATIAL_ORDER_H
#define SURFACE_CLOUD_SPATIAL_ORDER_H

#include "batten/cloud.h"
#include "surface/cloud/neighbours.h"

/// @file
/// Renumbering of a cloud in the leaf order of a k-d tree, so that close interior points have close indices. The boundary
/// keeps its order.

/// The index of a point of the cloud in the input.
static inline size_t cloud_input_index(const bat_cloud *cloud, size_t point)
{
    return cloud->order != NULL ? cloud->order[point] : point;
}

/// A renumbered cloud.
typedef struct spatial_order
{
    bat_cloud cloud;     ///< points scaled to unit size, triangles, and indices in the input; no corners
    neighbour_tree tree; ///< tree of these points
    uint32_t *places;    ///< count: index of each point in the given cloud
} spatial_order;

/// Renumber a cloud. `order` is all zero on failure.
bat_status spatial_order_make(const bat_cloud *cloud, spatial_order *order, bat_error *error);
void spatial_order_free(spatial_order *order);

#endif
