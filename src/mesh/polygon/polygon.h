#ifndef MESH_POLYGON_POLYGON_H
#define MESH_POLYGON_POLYGON_H

#include "batten/mesh.h"

/// @file
/// Polygon meshes in the form of triangle meshes.

/// A bat_mesh with the arrays of a polygon mesh: `faces` and `texture_faces` hold all corners, `face_count` is the number of
/// polygons. It shares what the polygon mesh owns.
bat_mesh polygon_mesh_view(const bat_polygon_mesh *mesh);

/// The polygon mesh with the arrays of such a view, and with these offsets.
bat_polygon_mesh polygon_mesh_from_view(const bat_mesh *view, uint32_t *offsets);

/// The offsets of `face_count` faces of `sides` corners each; null when out of memory.
uint32_t *polygon_offsets(size_t face_count, uint32_t sides);

/// A copy of a mesh's offsets; null when out of memory.
uint32_t *polygon_copy_offsets(const bat_polygon_mesh *mesh);

/// The face of each corner; null when out of memory. Release it with free().
uint32_t *polygon_faces_of_corners(const bat_polygon_mesh *mesh);

#endif
