#ifndef MESH_CHECK_H
#define MESH_CHECK_H

#include "batten/mesh.h"

/// @file
/// An internal check of meshes.

/// Checks a mesh as bat_mesh_check() does, but accepts faces that name a vertex twice.
bat_status mesh_check_except_degenerate(const bat_mesh *mesh, bat_error *error);

#endif
