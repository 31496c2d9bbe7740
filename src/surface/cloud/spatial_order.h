#ifndef SURFACE_CLOUD_SPATIAL_ORDER_H
#define SURFACE_CLOUD_SPATIAL_ORDER_H

#include "batten/cloud.h"
#include "surface/cloud/neighbours.h"

/// @file
/// A cloud whose interior points are numbered so that close ones have close numbers, as the leaves of a tree follow each
/// other. The boundary stays where it is.

typedef struct spatial_order
{
    bat_cloud cloud;     ///< points, triangles and their places in the input; no corners
    neighbour_tree tree; ///< of these points
    uint32_t *places;    ///< count: each point's number in the cloud that was given
} spatial_order;

/// All zero on failure.
bat_status spatial_order_make(const bat_cloud *cloud, spatial_order *order, bat_error *error);
void spatial_order_free(spatial_order *order);

#endif
