#ifndef MESH_REFINE_SPLIT_H
#define MESH_REFINE_SPLIT_H

#include "batten/mesh.h"

/// @file
/// Every face split in four, in the numbering of mesh_refine.h: what the next level's faces and neighbours are follows from
/// this level's by arithmetic alone.
///
/// Half-edge h = 3 f + c is halved into its near half, which begins where h begins, and its far half. Child face 4 f + c
/// holds the near half of h, an inner edge and the far half of the half-edge before h; child face 4 f + 3 holds the inner
/// edges' other sides.

/// Write the faces that `faces` are split into, 4 x face_count of them.
void split_faces(const uint32_t *faces, const bat_mesh_connectivity *links, int threads, uint32_t *fine);

/// Find the neighbours in the split mesh, as bat_mesh_connect() would. `first` is left out where `links` has none.
/// @return BAT_OK or BAT_NO_MEMORY; `fine` is untouched on failure
bat_status split_links(const bat_mesh_connectivity *links, int threads, bat_mesh_connectivity *fine, bat_error *error);

/// The near and the far half of a half-edge.
static inline uint32_t split_near(uint32_t half_edge)
{
    return half_edge / 3 * 12 + half_edge % 3 * 3;
}

static inline uint32_t split_far(uint32_t half_edge)
{
    return half_edge / 3 * 12 + bat_mesh_next(half_edge) % 3 * 3 + 2;
}

#endif
