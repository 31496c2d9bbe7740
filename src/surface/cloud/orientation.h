#ifndef SURFACE_CLOUD_ORIENTATION_H
#define SURFACE_CLOUD_ORIENTATION_H

#include "batten/cloud.h"
#include "surface/cloud/local_plane.h"
#include "surface/cloud/neighbours.h"

/// @file
/// Consistently oriented tangent planes of a cloud.

/// The planes.
typedef struct oriented_planes
{
    local_plane *planes; ///< count: right-handed, with consistent normals about which the boundary runs counter-clockwise
    size_t *reach;       ///< count: number of nearest points in each fit, including the point itself
    size_t conflicts;    ///< pairs of near neighbours with nearly parallel planes that stay turned against each other
} oriented_planes;

/// Fit a plane at each point and orient the normals consistently. Orientation propagates along a minimum spanning forest of
/// the neighbour graph, with the angles between planes as costs (Hoppe, DeRose, Duchamp, McDonald and Stuetzle, "Surface
/// reconstruction from unorganized points", 1992). The boundary, with the patch to its left, determines the sign by
/// majority. Components without boundary points keep an arbitrary sign.
/// @param tree the tree of the cloud's points
/// @return BAT_OK or BAT_NO_MEMORY; all zero on failure
bat_status oriented_planes_make(const bat_cloud *cloud, const neighbour_tree *tree, oriented_planes *oriented,
                                bat_error *error);
void oriented_planes_free(oriented_planes *oriented);

#endif
