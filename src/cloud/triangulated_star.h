#ifndef CLOUD_TRIANGULATED_STAR_H
#define CLOUD_TRIANGULATED_STAR_H

#include "batten/base.h"
#include "cloud/star.h"

/// The ring of the point `middle` in the Delaunay triangulation, by Qhull, of `count` points of the plane, counter-clockwise.
/// @param ring_count 0 where there is no triangulation, the point is on its hull or at another point, or has more than STAR_RING
///                   neighbours
/// @return BAT_OK or BAT_NO_MEMORY
bat_status triangulated_star_find(const double (*planar)[2], size_t count, size_t middle, size_t ring[STAR_RING],
                                  size_t *ring_count, bat_error *error);

#endif
