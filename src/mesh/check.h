#pragma once

#include "batten/mesh.h"

/// @file
/// Internal checks of meshes.

/// Checks a mesh as bat_mesh_check() does, and that its faces are triangles.
/// @return as bat_mesh_check(), and BAT_UNSUPPORTED for polygons
bat_status mesh_check_triangles(const bat_mesh *mesh, bat_error *error);

/// The same, but accepts faces that name a vertex twice.
bat_status mesh_check_except_degenerate(const bat_mesh *mesh, bat_error *error);

/// Checks that no coordinate of a mesh exceeds `most`, so that sums of them do not overflow.
/// @return BAT_OK or BAT_INVALID_POINT
bat_status mesh_check_coordinates(const bat_mesh *mesh, double most, bat_error *error);

/// Cut the polygons of a mesh, which have three or more existing vertices each, into triangles in place: quads along the
/// better diagonal, convex polygons as a fan from corner 0, any other by ear clipping.
/// @param offsets receives the offsets of the polygons, which the mesh no longer has; release them with free()
/// @return BAT_OK, BAT_NO_MEMORY or BAT_TOO_LARGE (too many triangles, a large concave polygon); the mesh stays on failure
bat_status mesh_cut_polygons(bat_mesh *mesh, uint32_t **offsets, bat_error *error);

/// Move rows of `dim` values to their new numbers, which count up; rows that are dropped, or stand for one before, have
/// others. Null values have none.
void mesh_move_rows(double *values, size_t rows, size_t dim, const uint32_t *numbers);

/// Number the vertices of a mesh anew, but for its faces: `count` remain. Creases and corners of those that are dropped,
/// BAT_MESH_NONE, go, and creases within one vertex.
void mesh_renumber(bat_mesh *mesh, size_t count, const uint32_t *numbers);

/// Exchange the textures of two meshes, but for materials.
void mesh_swap_texture(bat_mesh *a, bat_mesh *b);
/// Exchange the channels of two meshes.
void mesh_swap_channels(bat_mesh *a, bat_mesh *b);

/// Copy an array, which may be null or empty; then so is the copy. False when out of memory.
bool mesh_copy_array(const void *from, size_t count, size_t size, void **to);
