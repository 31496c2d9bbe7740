#ifndef MESH_CHECK_H
#define MESH_CHECK_H

#include "batten/mesh.h"

/// @file
/// Internal checks of meshes.

/// Checks a mesh as bat_mesh_check() does, and that its faces are triangles.
/// @return as bat_mesh_check(), and BAT_UNSUPPORTED for polygons
bat_status mesh_check_triangles(const bat_mesh *mesh, bat_error *error);

/// The same, but accepts faces that name a vertex twice.
bat_status mesh_check_except_degenerate(const bat_mesh *mesh, bat_error *error);

#endif
