#pragma once

#include "batten/base.h"

/// @file
/// Delaunay triangulations of points in the plane and in space, by Qhull.

/// Triangles of points of the plane, or tetrahedra of points in space. Release them with simplices_free().
typedef struct simplices
{
    uint32_t *corners; ///< count x 3, or 4
    size_t count;
} simplices;

void simplices_free(simplices *made);

/// Triangulate points. Of points at the same place one is a corner. Fewer than three, or collinear: no triangles. Triangles
/// are counter-clockwise, and none is degenerate.
/// @return BAT_OK or BAT_NO_MEMORY; `triangles` is empty on failure
bat_status planar_delaunay(const double (*planar)[2], size_t count, simplices *triangles, bat_error *error);

/// Triangulate points in space. No tetrahedra where the points are fewer than five or nearly coplanar. Their corners are in
/// no order, and some tetrahedra may be flat.
/// @param points count x 3
/// @return BAT_OK or BAT_NO_MEMORY; `tetrahedra` is empty on failure
bat_status spatial_delaunay(const double *points, size_t count, simplices *tetrahedra, bat_error *error);
