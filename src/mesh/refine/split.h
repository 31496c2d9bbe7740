#ifndef MESH_REFINE_SPLIT_H
#define MESH_REFINE_SPLIT_H

#include "mesh/refine/level.h"

/// @file
/// Faces split in four, in the numbering of batten/mesh_refine.h. The next level's connectivity follows by arithmetic alone.
///
/// Half-edge h = 3 f + c is split into a near half, which begins where h begins, and a far half. Child face 4 f + c holds
/// the near half of h, an inner edge, and the far half of the previous half-edge. Child face 4 f + 3 holds the other sides
/// of the inner edges.

/// Write the 4 x face_count child faces of `faces`.
void split_faces(const uint32_t *faces, const bat_mesh_connectivity *links, int threads, uint32_t *fine);

/// Compute the connectivity of the split mesh, equal to that of bat_mesh_connect(). `first` is left out where `links` has
/// none.
/// @return BAT_OK or BAT_NO_MEMORY; `fine` is untouched on failure
bat_status split_links(const bat_mesh_connectivity *links, int threads, bat_mesh_connectivity *fine, bat_error *error);

/// The near half of a half-edge.
static inline uint32_t split_near(uint32_t half_edge)
{
    return half_edge / 3 * 12 + half_edge % 3 * 3;
}

static inline uint32_t split_far(uint32_t half_edge)
{
    return half_edge / 3 * 12 + bat_mesh_next(half_edge) % 3 * 3 + 2;
}

// Faces of any number of corners split into quads, one for each corner. The next level's connectivity follows by arithmetic
// alone.
//
// Corner h becomes quad h: that corner, the vertex on the edge from it, the vertex of the face, and the vertex on the edge
// towards it. New vertices of edges follow the old vertices, those of faces follow these. So half-edge h is split into 4 h
// and 4 next(h) + 3; 4 h + 1 and 4 next(h) + 2 are the two sides of the inner edge between them.

/// Write the faces, one quad for each corner.
/// @param faces the vertices at the corners, or the texture coordinates with their own links
void quads_faces(const mesh_sides *sides, const uint32_t *faces, const bat_mesh_connectivity *links, int threads,
                 uint32_t *fine);

/// Compute the connectivity of the split mesh, equal to that of sides_connect(). `first` is left out where `links` has none.
/// @return BAT_OK or BAT_NO_MEMORY; `fine` is untouched on failure
bat_status quads_links(const mesh_sides *sides, const bat_mesh_connectivity *links, int threads, bat_mesh_connectivity *fine,
                       bat_error *error);

#endif
