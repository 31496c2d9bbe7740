#ifndef SURFACE_PARAMETERIZE_DELAUNAY_H
#define SURFACE_PARAMETERIZE_DELAUNAY_H

#include "batten/base.h"

/// @file
/// Delaunay triangulations of points in the plane, by Qhull.

/// Triangles of points. Release it with planar_triangles_free().
typedef struct planar_triangles
{
    uint32_t *corners; ///< count x 3, counter-clockwise; none is degenerate
    size_t count;
} planar_triangles;

void planar_triangles_free(planar_triangles *triangles);

/// Triangulate points. Of points at the same place one is a corner. No triangles where the points are fewer than three or
/// collinear.
/// @return BAT_OK or BAT_NO_MEMORY; `triangles` is empty on failure
bat_status planar_delaunay(const double (*planar)[2], size_t count, planar_triangles *triangles, bat_error *error);

#endif
