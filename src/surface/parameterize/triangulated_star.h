#ifndef SURFACE_PARAMETERIZE_TRIANGULATED_STAR_H
#define SURFACE_PARAMETERIZE_TRIANGULATED_STAR_H

#include "batten/base.h"
#include "surface/parameterize/star.h"

/// The neighbours of the point `middle` in the Delaunay triangulation, by Qhull, of `count` points of the plane,
/// counter-clockwise; on the hull they do not go all around.
/// @param ring_count 0 where there is no triangulation, the point is at another point, or has fewer than 3 or more than
/// STAR_RING
///                   neighbours
/// @return BAT_OK or BAT_NO_MEMORY
bat_status triangulated_star_find(const double (*planar)[2], size_t count, size_t middle, size_t ring[STAR_RING],
                                  size_t *ring_count, bat_error *error);

#endif
