#pragma once

#include "batten/base.h"

/// @file
/// Delaunay triangulations of points in the plane and in space, by Qhull.

/// Triangles of points. Release it with planar_triangles_free().
typedef struct planar_triangles
{
    uint32_t *corners; ///< count x 3, counter-clockwise; none is degenerate
    size_t count;
} planar_triangles;

void planar_triangles_free(planar_triangles *triangles);

/// Triangulate points. Of points at the same place one is a corner. Fewer than three, or collinear: no triangles.
/// @return BAT_OK or BAT_NO_MEMORY; `triangles` is empty on failure
bat_status planar_delaunay(const double (*planar)[2], size_t count, planar_triangles *triangles, bat_error *error);

/// Tetrahedra of points. Release it with spatial_tetrahedra_free().
typedef struct spatial_tetrahedra
{
    uint32_t *corners; ///< count x 4, in no order; some may be flat
    size_t count;
} spatial_tetrahedra;

void spatial_tetrahedra_free(spatial_tetrahedra *tetrahedra);

/// Triangulate points in space. No tetrahedra where the points are fewer than five or nearly coplanar.
/// @param points count x 3
/// @return BAT_OK or BAT_NO_MEMORY; `tetrahedra` is empty on failure
bat_status spatial_delaunay(const double *points, size_t count, spatial_tetrahedra *tetrahedra, bat_error *error);
