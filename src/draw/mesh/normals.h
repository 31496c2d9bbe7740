#ifndef DRAW_MESH_NORMALS_H
#define DRAW_MESH_NORMALS_H

#include "batten/mesh.h"

/// @file
/// What shading needs to know of a mesh, which need not be manifold: normals at the faces' corners, and boundary edges.

typedef struct mesh_surface
{
    float (*normals)[3];  ///< 3 x face_count: unit vectors at the corners; zero where a face has no area
    unsigned char *marks; ///< face_count: bit c is set where the edge from corner c has no other face
} mesh_surface;

/// @param flat every corner has its face's normal; else the mean of the faces at its vertex, weighted by area, whose normals
/// differ
///             by less than 40 degrees from it
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_surface_make(const bat_mesh *mesh, bool flat, int threads, mesh_surface *surface, bat_error *error);
void mesh_surface_free(mesh_surface *surface);

#endif
