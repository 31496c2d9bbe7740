#ifndef SURFACE_CLOUD_ADVANCING_FRONT_H
#define SURFACE_CLOUD_ADVANCING_FRONT_H

#include "batten/base.h"
#include "batten/cloud.h"

/// @file
/// Triangulation of a cloud that is a topological disc: Cohen-Steiner and Da, "A greedy Delaunay-based surface
/// reconstruction algorithm" (2004). Triangles of the Delaunay triangulation in space are added one by one at the edge of an
/// oriented surface, the most plausible first: those that continue it smoothly with the smallest empty ball through their
/// corners.
///
/// The surface stays a sphere with holes: it never grows together where that would make a handle. Of its loops, the longest
/// remains, and the others are filled. Points that are left over are put into the nearest triangles. A tube has two long
/// loops. It can be cut along a strip of triangles between them. The edges of such a disc are as near as its points.

/// How triangles are chosen.
typedef struct advancing_front_options
{
    double scale;     ///< factor of the size of triangles that join points that are on the surface: with a smaller one gaps
                      ///< of the boundary stay open
    bool spares_thin; ///< thin parts, such as ankles, are not closed by small triangles across them
    bool cuts_tube;   ///< a tube is cut
} advancing_front_options;

/// Triangulate a cloud.
/// @param cloud   made in canonical order (spatial_order.h); its boundary and its triangles are not used
/// @param disc    receives a cloud with the same points, a boundary, and triangles
/// @return BAT_OK; BAT_NO_CONVERGENCE where the points have no such triangulation; BAT_CANCELLED; BAT_NO_MEMORY; `disc` is
///         untouched on failure
bat_status advancing_front_triangulate(const bat_cloud *cloud, advancing_front_options options, bat_progress progress,
                                       bat_cloud *disc, bat_error *error);

// Cut a tube into a disc.

/// Remove the shortest strip of triangles from one boundary loop to the other.
/// @param faces  *count x 3, consistently oriented; the others keep their order
/// @param points number of vertices
/// @return BAT_OK; BAT_NO_CONVERGENCE where there are not two loops, or a loop visits a point twice; BAT_NO_MEMORY
bat_status tube_cut(uint32_t *faces, size_t *count, size_t points, bat_error *error);

#endif
