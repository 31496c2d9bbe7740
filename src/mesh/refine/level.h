#ifndef MESH_REFINE_LEVEL_H
#define MESH_REFINE_LEVEL_H

#include "batten/mesh.h"

/// @file
/// A mesh on its way through the levels of refinement, as the schemes' rules see it, and the loops that they run in.

/// One level of refinement.
typedef struct mesh_level mesh_level;

struct mesh_level
{
    const uint32_t *faces; ///< face_count x 3
    const bat_mesh_connectivity *links;
    const double *edge_sharpness;   ///< one an edge; null: no edge is sharp
    const double *vertex_sharpness; ///< one a vertex of the coarse mesh; null: no vertex is sharp
    const uint32_t *irregular;      ///< one a vertex of the coarse mesh: 0, or its number of faces where that is not regular
    size_t coarse_count;            ///< vertices of the coarse mesh, which keep their indices; later ones are all regular
    const mesh_level *parent;       ///< of whose faces these are quarters, with faces and links only; null for none
};

/// Numbers at the vertices, positions or channels, that a rule takes to the next level.
typedef struct mesh_rows
{
    const mesh_level *level;
    const double *from; ///< vertex_count x dim
    double *to;         ///< the next level's vertices x dim
    size_t dim;
} mesh_rows;

/// A rule of refinement: fills in `to`.
typedef void mesh_rule(const mesh_rows *rows, int threads);

mesh_rule midpoint_rule, loop_rule, butterfly_rule;

/// Work on the elements from `begin` to before `end`.
typedef void mesh_range(const void *job, size_t begin, size_t end);

/// Share out the elements from 0 to before `count` among threads, in a few contiguous ranges each.
void mesh_share(mesh_range *range, const void *job, size_t count, int threads);

/// Where a half-edge ends.
static inline uint32_t mesh_end(const uint32_t *faces, uint32_t half_edge)
{
    return faces[bat_mesh_next(half_edge)];
}

/// The vertex opposite a half-edge in its face.
static inline uint32_t mesh_opposite(const uint32_t *faces, uint32_t half_edge)
{
    return faces[bat_mesh_previous(half_edge)];
}

/// Whether a half-edge is the lesser one of its edge, by which the edge is numbered; true at a boundary.
static inline bool mesh_owns(const uint32_t *twin, uint32_t half_edge)
{
    return twin[half_edge] > half_edge;
}

/// Whether an edge is a boundary one or a vertex lies on the boundary: seen from the half-edge, or from the vertex's first
/// one.
static inline bool mesh_at_boundary(const bat_mesh_connectivity *links, uint32_t half_edge)
{
    return links->twin[half_edge] == BAT_MESH_NONE;
}

#endif
