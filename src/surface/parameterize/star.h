#ifndef SURFACE_PARAMETERIZE_STAR_H
#define SURFACE_PARAMETERIZE_STAR_H

#include "batten/base.h"

#include <stdbool.h>
#include <stddef.h>

/// @file
/// The star of a point in the plane: its neighbours in a Delaunay triangulation, and convex weights of these neighbours that
/// reproduce the point. The point is the origin.

enum
{
    STAR_MAX_RING = 64 ///< maximum number of neighbours
};

/// The neighbours of the origin in the Delaunay triangulation of the origin and `count` points, counter-clockwise. They are
/// the corners of the convex hull of the origin and the points p / |p|^2, which is polar to the Voronoi cell of the origin.
/// Of cocircular points, as few as possible are corners. Points at the origin are ignored.
/// @param inverse workspace of `count` pairs
/// @param closed  whether the neighbours surround the origin; if not, the origin is on the convex hull, and the gap is after
///        the last
/// @return the number of neighbours; 0 if there are more than STAR_MAX_RING
size_t star_find(const double (*planar)[2], size_t count, double (*inverse)[2], size_t ring[STAR_MAX_RING], bool *closed);

/// Shape-preserving weights (Floater 1997, section 6). Each corner l forms a triangle with the side of the ring that the ray
/// from l through the origin meets. The weights are the mean over l of the barycentric coordinates of the origin in these
/// triangles.
/// @param ring    corners about the origin, counter-clockwise, each less than half a turn after the one before
/// @param weights receives positive weights with sum 1
void star_shape_preserving(const double (*ring)[2], size_t count, double *weights);

/// Map a ring in space to the plane by the geodesic polar map. It preserves the lengths of spokes, and scales the angles
/// between them to sum to a full turn.
/// @param spokes vectors from the centre to the ring
/// @return false if a scaled angle reaches half a turn
bool star_unfold(const double (*spokes)[3], size_t count, double (*ring)[2]);

/// The neighbours of the point `middle` in the Delaunay triangulation of `count` points in the plane, computed by Qhull,
/// counter-clockwise. They do not surround a point on the convex hull.
/// @param ring_count receives 0 if there is no triangulation, if the point coincides with another one, or if it has fewer
///        than 3 or more than STAR_MAX_RING neighbours
/// @return BAT_OK or BAT_NO_MEMORY
bat_status triangulated_star_find(const double (*planar)[2], size_t count, size_t middle, size_t ring[STAR_MAX_RING],
                                  size_t *ring_count, bat_error *error);

#endif
