#ifndef DRAW_MESH_NORMALS_H
#define DRAW_MESH_NORMALS_H

#include "batten/mesh.h"

/// @file
/// Normals at the corners of faces and boundary edges, for shading of meshes that need not be manifold.

typedef struct mesh_surface
{
    float (*normals)[3];  ///< 3 x face_count unit vectors at the corners; zero where a face has no area
    unsigned char *marks; ///< face_count bit sets: bit c marks a boundary edge at corner c, bit 3 + c one within a polygon
} mesh_surface;

/// Bits of mesh_surface::marks, for the edge at corner c.
static inline bool mesh_edge_at_boundary(const mesh_surface *surface, size_t face, size_t c)
{
    return (surface->marks[face] >> c & 1) != 0;
}

static inline bool mesh_edge_within_polygon(const mesh_surface *surface, size_t face, size_t c)
{
    return (surface->marks[face] >> (3 + c) & 1) != 0;
}

/// Compute normals and boundary edges.
/// @param polygons that the mesh is cut from, or null: flat faces have their polygon's mean normal
/// @param flat use the faces' normals; otherwise the area-weighted mean of those faces at the vertex whose normals differ by
/// less than 40 degrees
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_surface_make(const bat_mesh *mesh, const bat_mesh *polygons, bool flat, int threads, mesh_surface *surface,
                             bat_error *error);
void mesh_surface_free(mesh_surface *surface);

#endif
