#ifndef MESH_REFINE_QUADS_H
#define MESH_REFINE_QUADS_H

#include "mesh/refine/level.h"

/// @file
/// Faces of any number of corners split into quads, one for each corner. The next level's connectivity follows by arithmetic
/// alone.
///
/// Corner h becomes quad h: that corner, the vertex on the edge from it, the vertex of the face, and the vertex on the edge
/// towards it. New vertices of edges follow the old vertices, those of faces follow these. So half-edge h is split into 4 h
/// and 4 next(h) + 3; 4 h + 1 and 4 next(h) + 2 are the two sides of the inner edge between them.

/// Write the faces, one quad for each corner.
/// @param faces the vertices at the corners, or the texture coordinates with their own links
void quads_faces(const mesh_sides *sides, const uint32_t *faces, const bat_mesh_connectivity *links, int threads,
                 uint32_t *fine);

/// Compute the connectivity of the split mesh, equal to that of sides_connect(). `first` is left out where `links` has none.
/// @return BAT_OK or BAT_NO_MEMORY; `fine` is untouched on failure
bat_status quads_links(const mesh_sides *sides, const bat_mesh_connectivity *links, int threads, bat_mesh_connectivity *fine,
                       bat_error *error);

#endif
