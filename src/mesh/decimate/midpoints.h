#ifndef MESH_DECIMATE_MIDPOINTS_H
#define MESH_DECIMATE_MIDPOINTS_H

#include "batten/mesh_decimate.h"

/// A mesh split at its edges' midpoints, as points of the mesh it was made from. Numbered as batten/mesh_refine.h says.
typedef struct midpoint_mesh
{
    uint32_t *faces;
    double (*corners)[3][3]; ///< of every face: its corners' barycentric coordinates in face f >> 2 level
    bat_mesh_point *points;  ///< of every vertex
    size_t face_count, vertex_count;
} midpoint_mesh;

/// Split a mesh so often.
/// @return as bat_mesh_midpoints()
bat_status midpoint_mesh_make(const bat_mesh *coarse, size_t levels, midpoint_mesh *made, bat_error *error);
void midpoint_mesh_free(midpoint_mesh *mesh);

#endif
