#ifndef SURFACE_PARAMETERIZE_STAR_H
#define SURFACE_PARAMETERIZE_STAR_H

#include "batten/base.h"

#include <stdbool.h>
#include <stddef.h>

/// @file
/// The star of a point of the plane, which is the origin, among others, and weights of its ring that make the origin an
/// average of the ring.

enum
{
    STAR_MAX_RING = 64 ///< stars of more neighbours are not looked for
};

/// The neighbours of the origin in the Delaunay triangulation of it and `count` points, counter-clockwise. They are the
/// corners of the convex hull of the origin and the points p / |p|^2, which is polar to the origin's Voronoi cell; among
/// points of one empty circle the fewest that triangulate. Points at the origin do not count.
/// @param inverse room for `count` pairs
/// @param closed  whether they go all around; else the origin is on the hull of the points, and the gap is after the last
/// @return how many; 0 for more than STAR_MAX_RING
size_t star_find(const double (*planar)[2], size_t count, double (*inverse)[2], size_t ring[STAR_MAX_RING], bool *closed);

/// Floater's shape-preserving weights (1997, section 6): each corner of the ring makes a triangle with the side of the ring
/// across the origin; the weights are the mean of the origin's barycentric coordinates in these triangles.
/// @param ring corners about the origin, counter-clockwise, each less than half a turn before the next
/// @param weights above 0, of sum 1
void star_shape_preserving(const double (*ring)[2], size_t count, double *weights);

/// Unfold a ring in space into the plane as a geodesic polar map does: the lengths of its spokes stay, and the angles
/// between them are scaled to a full turn.
/// @param spokes from the middle to the ring
/// @return false where an angle comes to half a turn or more
bool star_unfold(const double (*spokes)[3], size_t count, double (*ring)[2]);

/// The neighbours of the point `middle` in the Delaunay triangulation, by Qhull, of `count` points of the plane,
/// counter-clockwise; on the hull they do not go all around.
/// @param ring_count 0 where there is no triangulation, the point is at another point, or has fewer than 3 or more than
/// STAR_MAX_RING
///                   neighbours
/// @return BAT_OK or BAT_NO_MEMORY
bat_status triangulated_star_find(const double (*planar)[2], size_t count, size_t middle, size_t ring[STAR_MAX_RING],
                                  size_t *ring_count, bat_error *error);

#endif
