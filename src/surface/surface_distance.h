#ifndef SURFACE_SURFACE_DISTANCE_H
#define SURFACE_SURFACE_DISTANCE_H

#include "batten/spline_hierarchical.h"

/// How far a surface goes from the points that it is for: the largest distance of the corners and the middle of its cells
/// from the nearest point. The distances of the points from the surface do not see what it does where there are none.
/// @param points count x 3
bat_status surface_distance(const bat_spline_surface *surface, const double *points, size_t count, double *stray,
                            bat_error *error);

#endif
