#ifndef MESH_TRIANGULATE_H
#define MESH_TRIANGULATE_H

#include "batten/mesh.h"

/// Room that triangulating works in. All zero: empty; it grows with the polygons and is released with
/// polygon_workspace_free().
typedef struct polygon_workspace
{
    uint32_t *numbers;
    size_t capacity;
} polygon_workspace;

void polygon_workspace_free(polygon_workspace *workspace);

/// Concave polygons of more corners than this are refused: cutting ears takes time in proportion to their square.
enum
{
    POLYGON_MAX_EARS = 10000
};

/// Cut a polygon of `count` >= 3 corners into `count` - 2 triangles, seen along the normal of Newell: a quad along the
/// diagonal that gives the better triangles, a convex polygon as a fan of its first corner, any other by its ears.
///
/// @param corners   the vertices at the corners
/// @param triangles receives 3 x (count - 2) places in the polygon, 0 to count - 1, in the polygon's direction
/// @return BAT_OK, BAT_NO_MEMORY or BAT_TOO_LARGE (a concave polygon of more than POLYGON_MAX_EARS corners)
bat_status polygon_triangulate(const double *positions, const uint32_t *corners, size_t count, uint32_t *triangles,
                               polygon_workspace *workspace);

#endif
