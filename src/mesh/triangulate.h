#ifndef MESH_TRIANGULATE_H
#define MESH_TRIANGULATE_H

#include "batten/mesh.h"

/// @file
/// Triangulation of polygons in space.

/// Memory that polygon_triangulate() reuses. All zero: empty. Release it with polygon_workspace_free().
typedef struct polygon_workspace
{
    uint32_t *numbers;
    size_t capacity;
} polygon_workspace;

void polygon_workspace_free(polygon_workspace *workspace);

/// The most corners of a concave polygon. Ear clipping takes time in proportion to their square.
enum
{
    POLYGON_MAX_EARS = 10000
};

/// Triangulate a polygon of `count` >= 3 corners: a quad along its better diagonal, a convex polygon as a fan from corner 0,
/// any other by ear clipping.
///
/// @param corners   the vertices at the corners
/// @param triangles receives 3 x (count - 2) corner numbers, each 0 to count - 1, with the orientation of the polygon
/// @return BAT_OK, BAT_NO_MEMORY or BAT_TOO_LARGE (a concave polygon of more than POLYGON_MAX_EARS corners)
bat_status polygon_triangulate(const double *positions, const uint32_t *corners, size_t count, uint32_t *triangles,
                               polygon_workspace *workspace);

#endif
