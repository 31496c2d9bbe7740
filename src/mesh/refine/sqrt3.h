#ifndef MESH_REFINE_SQRT3_H
#define MESH_REFINE_SQRT3_H

#include "mesh/refine/level.h"

/// @file
/// Square-root-three subdivision: Kobbelt, "sqrt(3)-subdivision" (2000). A level puts a vertex into every face and turns the
/// edges that were there, so that one edge joins the new vertices on its sides. Boundary edges stay on the first level and
/// are cut in three on the second, together with their faces, and so on in turn.
///
/// Half-edge h becomes face h, which begins where h begins. New vertices are numbered by the faces that they are put into; a
/// face at a boundary that is cut has two, in the boundary's direction.

/// A level of square-root-three subdivision.
typedef struct sqrt3_plan
{
    const uint32_t *faces;
    const bat_mesh_connectivity *links;
    uint32_t *new_vertex; ///< one a face: its first new vertex
    size_t vertex_count;  ///< of the next level
    bool cut;             ///< whether boundary edges are cut
} sqrt3_plan;

/// Plan a level.
/// @param cut must only be asked for on what a level without has given: each face has one boundary edge at most
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sqrt3_plan_make(const uint32_t *faces, const bat_mesh_connectivity *links, bool cut, sqrt3_plan *plan,
                           bat_error *error);
void sqrt3_plan_free(sqrt3_plan *plan);

/// Write the next level's faces, 3 x face_count of them.
void sqrt3_faces(const sqrt3_plan *plan, int threads, uint32_t *fine);
/// Write the next level's rows of numbers at the vertices.
void sqrt3_rule(const sqrt3_plan *plan, const double *from, double *to, size_t dim, int threads);

#endif
