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

/// One level of square-root-three subdivision.
typedef struct sqrt3_plan
{
    const uint32_t *faces;
    const bat_mesh_connectivity *links;
    uint32_t *new_vertex; ///< for each face: its first new vertex
    size_t vertex_count;  ///< the number of vertices of the next level
    bool cut;             ///< whether boundary edges are trisected
} sqrt3_plan;

/// Prepare a level.
/// @param cut allowed only after a level without it; then each face has at most one boundary edge
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sqrt3_plan_make(const uint32_t *faces, const bat_mesh_connectivity *links, bool cut, sqrt3_plan *plan,
                           bat_error *error);
void sqrt3_plan_free(sqrt3_plan *plan);

/// Write the 3 x face_count faces of the next level.
void sqrt3_faces(const sqrt3_plan *plan, int threads, uint32_t *fine);
/// Compute the values at the vertices of the next level.
void sqrt3_rule(const sqrt3_plan *plan, const double *from, double *to, size_t dim, int threads);

#endif
