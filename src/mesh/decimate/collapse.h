#ifndef MESH_DECIMATE_COLLAPSE_H
#define MESH_DECIMATE_COLLAPSE_H

#include "batten/mesh.h"

/// @file
/// A mesh whose edges can be collapsed. Faces, half-edges, edges and vertices keep their numbers of the mesh it was
/// made from until they vanish. A collapse of the half-edge from i to j takes away the faces beside it and gives j's
/// other faces to i.

/// How free a vertex is to move.
typedef enum collapse_freedom
{
    COLLAPSE_FREE,
    COLLAPSE_ON_CURVE, ///< on a boundary or a crease
    COLLAPSE_FIXED     ///< a corner, or where creases meet or end
} collapse_freedom;

typedef struct collapse_mesh
{
    uint32_t *corner;    ///< 3 x faces: the vertices at a face's corners; BAT_MESH_NONE for a face that vanished
    uint32_t *twin;      ///< as in bat_mesh_connectivity
    uint32_t *edge;      ///< the edge of a half-edge
    uint32_t *first;     ///< as in bat_mesh_connectivity
    uint32_t *half_edge; ///< of an edge: one of its half-edges; BAT_MESH_NONE for an edge that vanished
    uint8_t *freedom;    ///< of a vertex: a collapse_freedom
    double *sharpness;   ///< of an edge: its crease's, 0 for none; null for a mesh without creases
    uint32_t *stamp;     ///< of a vertex: the last search that met it
    uint32_t last_stamp;
    size_t vertex_count, face_count, edge_count; ///< of the mesh it was made from
    size_t vertices_left;                        ///< those with faces
    size_t faces_left;
} collapse_mesh;

enum
{
    /// The most faces of a ring. Edges with more wait until collapses nearby have made them fewer.
    COLLAPSE_MAX_FACES = 64
};

/// The neighbourhood of an edge from i to j: the fan of faces that stays when the edge is collapsed, counter-clockwise
/// around it, and the vertices on its outside.
///
/// Face k of the fan has the corners apex, vertex[k] and vertex[k + 1], the apex being j for j_begin <= k < j_end, else i;
/// half_edge[k] runs from the apex to vertex[k]. Where the fan is closed, vertex[count] is vertex[0] once more. Then come
/// the one or two faces that vanish: (i, j, vertex[j_end]) and (j, i, vertex[j_begin]), with the half-edges from i to j and
/// from j to i.
typedef struct collapse_ring
{
    uint32_t half_edge[COLLAPSE_MAX_FACES + 2];
    uint32_t vertex[COLLAPSE_MAX_FACES + 1];
    uint32_t i, j;
    uint32_t count;          ///< faces that stay
    uint32_t vanishing;      ///< faces that vanish: 1 at the boundary, else 2
    uint32_t j_begin, j_end; ///< the faces of j
    bool closed;             ///< neither i nor j lies on the boundary
} collapse_ring;

/// Make one from a mesh that passes bat_mesh_check(), with its creases and corners.
/// @return BAT_OK, what bat_mesh_connect() returns, BAT_INVALID_ARGUMENT (a crease that is no edge)
bat_status collapse_mesh_make(const bat_mesh *mesh, collapse_mesh *made, bat_error *error);
void collapse_mesh_free(collapse_mesh *mesh);

/// Whether an edge is a boundary or a crease.
bool collapse_edge_is_curve(const collapse_mesh *mesh, uint32_t edge);
/// Whether the freedoms of an edge's ends allow its collapse: what is fixed must not move, what is on a curve must stay on
/// it, and curves must not be pinched together. `kept` receives the end where the new vertex must be, BAT_MESH_NONE where it
/// is free.
bool collapse_edge_is_allowed(const collapse_mesh *mesh, uint32_t edge, uint32_t *kept);

/// Find the ring of an edge. Where exactly one of its ends is on the boundary, that one is i.
/// @return false where the collapse would change the topology: where the link condition of Dey et al. (1999) fails, where a
///         piece of the mesh would be left with less than a tetrahedron or without faces; also where the ring is too large
bool collapse_ring_find(collapse_mesh *mesh, uint32_t edge, collapse_ring *ring);

/// The local number of a face's corner: 0 for i, 1 for j, 2 + k for vertex[k]. `c` counts from the corner where
/// half_edge[face] begins.
static inline uint32_t collapse_ring_corner(const collapse_ring *ring, uint32_t face, uint32_t c)
{
    uint32_t apex = face >= ring->j_begin && face < ring->j_end ? 1 : 0;
    if (face < ring->count)
        return c == 0 ? apex : 2 + (ring->closed && face + c - 1 == ring->count ? 0 : face + c - 1);
    uint32_t opposite = face == ring->count ? ring->j_end : ring->j_begin;
    if (ring->closed && opposite == ring->count)
        opposite = 0;
    uint32_t first = face == ring->count ? 0 : 1;
    return c == 0 ? first : c == 1 ? 1 - first : 2 + opposite;
}

/// The number of different vertices on the outside.
static inline uint32_t collapse_ring_vertices(const collapse_ring *ring)
{
    return ring->closed ? ring->count : ring->count + 1;
}

/// Collapse the edge of a ring into its vertex i. `gone` receives the two or three edges that vanish, `gone_count` their
/// number.
void collapse_apply(collapse_mesh *mesh, const collapse_ring *ring, uint32_t *gone, uint32_t *gone_count);

#endif
