#ifndef MESH_REFINE_LEVEL_H
#define MESH_REFINE_LEVEL_H

#include "mesh/sides.h"

/// @file
/// One level of refinement as the rules of the schemes use it, and loops over its elements on several threads.

/// What is sharp on a level. Made by sharp_list_make().
typedef struct sharp_list
{
    uint32_t *half_edges; ///< the owning half-edges of sharp edges, in their order
    size_t half_edge_count;
    uint32_t *vertices; ///< vertices that are sharp or have a sharp edge, each once
    size_t vertex_count;
    unsigned char *marked; ///< for each vertex of the level: 1 if it is among them
} sharp_list;

/// A mesh during refinement.
typedef struct mesh_level mesh_level;

struct mesh_level
{
    const uint32_t *faces; ///< the vertices at the corners
    mesh_sides sides;
    const bat_mesh_connectivity *links;
    const double *edge_sharpness;   ///< one number for each edge; null: no edge is sharp
    const double *child_sharpness;  ///< where creases follow Chaikin: of both halves of each edge, that at the owner's begin
                                    ///< first; null: one less than the edge's
    const double *vertex_sharpness; ///< one number for each coarse vertex; null: no vertex is sharp
    const sharp_list *sharp;        ///< what is sharp; null: not known, or nothing
    const uint32_t *irregular;      ///< for each coarse vertex: 0 where it is regular, else its number of faces
    size_t coarse_count;      ///< the number of coarse vertices, which keep their indices; all later vertices are regular
    const mesh_level *parent; ///< the level whose faces were split into these, with faces and links only; or null
};

/// Whether a vertex is known to be sharp, so that sharpness_visit() computes it after the smooth ones.
static inline bool mesh_is_sharp(const mesh_level *level, size_t vertex)
{
    return level->sharp != NULL && level->sharp->marked[vertex] != 0;
}

/// Values at the vertices, positions or channels, that a rule carries to the next level.
typedef struct mesh_rows
{
    const mesh_level *level;
    const double *from; ///< vertex_count x dim
    double *to;         ///< vertices of the next level x dim
    size_t dim;
} mesh_rows;

/// A refinement rule: computes `to` from `from`.
typedef void mesh_rule(const mesh_rows *rows, int threads);

mesh_rule midpoint_rule, loop_rule, butterfly_rule, catmull_clark_rule;

/// The work on the elements begin, …, end - 1.
typedef void mesh_range(const void *job, size_t begin, size_t end);

/// Distribute the elements 0, …, count - 1 over threads, in contiguous ranges.
void mesh_share(mesh_range *range, const void *job, size_t count, int threads);

/// As bat_mesh_next_around(), for faces of any number of corners.
static inline uint32_t sides_next_around(const mesh_level *level, uint32_t half_edge)
{
    return level->links->twin[sides_previous(&level->sides, half_edge)];
}

/// The last vertex of a half-edge.
static inline uint32_t mesh_end(const uint32_t *faces, uint32_t half_edge)
{
    return faces[bat_mesh_next(half_edge)];
}

/// The vertex opposite a half-edge in its face.
static inline uint32_t mesh_opposite(const uint32_t *faces, uint32_t half_edge)
{
    return faces[bat_mesh_previous(half_edge)];
}

/// Whether a half-edge is the smaller one of its edge and so determines the edge's number; true at a boundary.
static inline bool mesh_owns(const uint32_t *twin, uint32_t half_edge)
{
    return twin[half_edge] > half_edge;
}

/// Whether a half-edge is on the boundary. For the first half-edge of a vertex: whether the vertex is on the boundary.
static inline bool mesh_at_boundary(const bat_mesh_connectivity *links, uint32_t half_edge)
{
    return links->twin[half_edge] == BAT_MESH_NONE;
}

#endif
