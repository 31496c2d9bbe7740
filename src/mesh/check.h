#ifndef MESH_CHECK_H
#define MESH_CHECK_H

#include "batten/mesh.h"

/// @file
/// Internal checks and copies of meshes.

/// Checks a mesh as bat_mesh_check() does, but accepts faces that name a vertex twice.
bat_status mesh_check_except_degenerate(const bat_mesh *mesh, bat_error *error);

/// Checks all but the faces: finite numbers, labels that exist, and creases and corners of existing vertices.
bat_status mesh_check_data(const bat_mesh *mesh, bat_error *error);

/// As bat_mesh_copy(), of a mesh with `corner_count` corners of faces.
bat_status mesh_copy_corners(const bat_mesh *mesh, size_t corner_count, bat_mesh *copy, bat_error *error);

#endif
