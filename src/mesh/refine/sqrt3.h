#ifndef MESH_REFINE_SQRT3_H
#define MESH_REFINE_SQRT3_H

#include "mesh/refine/level.h"

/// @file
/// Square-root-three subdivision: Kobbelt, "sqrt(3)-subdivision" (2000). Each level puts a vertex into every face and flips
/// the old edges, so that they join the new vertices on both sides. Boundary edges remain on even levels; on odd levels they
/// are trisected together with their faces.
///
/// Half-edge h becomes face h, which begins at the same vertex. New vertices are numbered by face. A face with a trisected
/// edge has two, in boundary order.

/// Make the next level's vertices, faces and channels.
/// @param cut whether boundary edges are trisected; only after a level without it; then each face has at most one such edge
/// @return BAT_OK or BAT_NO_MEMORY; `fine` can be freed on failure
bat_status sqrt3_refine(const bat_mesh *mesh, const bat_mesh_connectivity *links, bool cut, int threads, bat_mesh *fine,
                        bat_error *error);

#endif
