#ifndef SURFACE_CLOUD_ORIENTATION_H
#define SURFACE_CLOUD_ORIENTATION_H

#include "batten/cloud.h"
#include "surface/cloud/local_plane.h"
#include "surface/cloud/neighbours.h"

/// @file
/// Local planes of a cloud that agree about which side is up.

typedef struct oriented_planes
{
    local_plane *planes; ///< count: right-handed axes, turned so that normals agree and the boundary runs counter-clockwise
                         ///< around them
    size_t *reach;       ///< count: how many nearest points each was fitted to, its middle among them
} oriented_planes;

/// Fit a plane around each point, and turn its normal as its neighbours' are: along the tree of neighbours whose planes
/// differ least (Hoppe et al. 1992), with the turning that most of the boundary asks for, which has the patch to its left.
/// What hangs together without the boundary is turned by itself.
/// @param tree of the cloud's points
/// @return BAT_OK or BAT_NO_MEMORY; all zero on failure
bat_status oriented_planes_make(const bat_cloud *cloud, const neighbour_tree *tree, oriented_planes *oriented,
                                bat_error *error);
void oriented_planes_free(oriented_planes *oriented);

#endif
