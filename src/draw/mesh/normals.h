#ifndef DRAW_MESH_NORMALS_H
#define DRAW_MESH_NORMALS_H

#include "batten/mesh.h"

/// @file
/// Normals at the corners of faces and boundary edges, for shading of meshes that need not be manifold.

typedef struct mesh_surface
{
    float (*normals)[3];  ///< 3 x face_count unit vectors at the corners; zero where a face has no area
    unsigned char *marks; ///< face_count bit sets: bit c marks a boundary edge at corner c
} mesh_surface;

/// Compute normals and boundary edges.
/// @param flat use the faces' normals; otherwise the area-weighted mean of those faces at the vertex whose normals differ by
/// less than 40 degrees
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_surface_make(const bat_mesh *mesh, bool flat, int threads, mesh_surface *surface, bat_error *error);
void mesh_surface_free(mesh_surface *surface);

#endif
