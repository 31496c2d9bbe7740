#ifndef MESH_CHECK_H
#define MESH_CHECK_H

#include "batten/mesh.h"

/// bat_mesh_check(), but faces may have the same vertex twice.
bat_status mesh_check_except_degenerate(const bat_mesh *mesh, bat_error *error);

#endif
