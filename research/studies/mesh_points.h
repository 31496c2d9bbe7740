#pragma once

#include "batten/mesh.h"

/// @file
/// Random places on a mesh, and meshes of grids, for studies of scans.

/// The density of points on a face by its unit normal.
typedef double point_density(const void *context, const double normal[3]);

/// Twice the areas of the faces up to each one, times a density; null: 1.
/// @param sums receives face_count + 1 numbers, the first of them 0
void mesh_face_sums(const bat_mesh *mesh, point_density *density, const void *context, double *sums);

/// The face at a place from 0 to the last sum.
size_t mesh_face_at(const double *sums, size_t face_count, double place);

/// Draw points with a density, and add noise to each coordinate.
/// @param noise  standard deviation
/// @param points receives count x 3 numbers
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_points_draw(const bat_mesh *mesh, point_density *density, const void *context, double noise, size_t count,
                            bat_random *random, double *points, bat_error *error);

/// Two triangles for each cell of a square grid. Vertex i has row i / (cells + 1); positions are not set.
/// @param mesh empty on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_of_grid(size_t cells, bat_mesh *mesh, bat_error *error);
