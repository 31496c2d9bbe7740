#pragma once

#include "base/memory.h"
#include "batten/mesh.h"

/// @file
/// A mesh with edge collapses. Faces, half-edges, edges and vertices keep their original numbers until they vanish. The
/// collapse of the edge from i to j removes its faces and assigns the remaining faces of j to i.

/// Constraints on the position of a vertex.
typedef enum collapse_freedom
{
    COLLAPSE_FREE,
    COLLAPSE_ON_CURVE, ///< on a boundary, a crease, a seam or a border of parts
    COLLAPSE_FIXED     ///< a corner, or a vertex where creases or seams meet or end
} collapse_freedom;

typedef struct collapse_mesh
{
    uint32_t *corner;    ///< 3 x faces: the corners of each face; BAT_MESH_NONE for a removed face
    uint32_t *twin;      ///< as in bat_mesh_connectivity
    uint32_t *edge;      ///< as in bat_mesh_connectivity
    uint32_t *first;     ///< as in bat_mesh_connectivity
    uint32_t *half_edge; ///< for each edge: one of its half-edges; BAT_MESH_NONE for a removed edge
    uint8_t *freedom;    ///< for each vertex: a collapse_freedom
    double *sharpness;   ///< for each edge: the sharpness of its crease, or 0; null for a mesh without creases
    uint8_t *seam;       ///< for each edge: whether it is a seam of the texture or between parts; null without
    uint32_t *stamp;     ///< for each vertex: the last search that visited it
    uint32_t last_stamp;
    size_t vertex_count, face_count, edge_count; ///< of the original mesh
    size_t vertices_left;                        ///< vertices with faces
    size_t faces_left;
    memory_pool pool; ///< of all arrays but those as in bat_mesh_connectivity
} collapse_mesh;

/// The most faces of a ring. Edges with larger rings wait until other collapses have reduced them.
#define COLLAPSE_MAX_FACES 64

/// The neighbourhood of an edge from i to j: the faces that remain after its collapse, counter-clockwise, and the vertices
/// opposite to i and j.
///
/// Face k has the corners apex, vertex[k] and vertex[k + 1]. The apex is j for j_begin <= k < j_end, else i; half_edge[k]
/// runs from the apex to vertex[k]. In a closed ring vertex[count] is vertex[0]. Then come the one or two vanishing faces,
/// (i, j, vertex[j_end]) and (j, i, vertex[j_begin]), with the half-edges between i and j.
typedef struct collapse_ring
{
    uint32_t half_edge[COLLAPSE_MAX_FACES + 2];
    uint32_t vertex[COLLAPSE_MAX_FACES + 1];
    uint32_t i, j;
    uint32_t count;          ///< the number of remaining faces
    uint32_t vanishing;      ///< the number of vanishing faces: 1 on the boundary, else 2
    uint32_t j_begin, j_end; ///< the range of the faces of j
    bool closed;             ///< neither i nor j is on the boundary
} collapse_ring;

/// Make a collapse_mesh from a mesh that passes bat_mesh_check(), with its creases, its corners and the borders between
/// objects, groups and materials.
/// @param seams whether seams of the texture are curves
/// @return BAT_OK, the failures of bat_mesh_connect(), or BAT_INVALID_ARGUMENT for a crease that is not an edge
bat_status collapse_mesh_make(const bat_mesh *mesh, bool seams, collapse_mesh *made, bat_error *error);
void collapse_mesh_free(collapse_mesh *mesh);

/// Whether the texture coordinates at two half-edges that begin at the same vertex differ.
static inline bool collapse_texture_jumps(const bat_mesh *mesh, uint32_t a, uint32_t b)
{
    const double *of_a = mesh->texture + 2 * (size_t)mesh->texture_faces[a],
                 *of_b = mesh->texture + 2 * (size_t)mesh->texture_faces[b];
    return of_a[0] != of_b[0] || of_a[1] != of_b[1];
}

/// Whether an edge is on the boundary or a crease.
static inline bool collapse_edge_is_rim(const collapse_mesh *mesh, uint32_t edge)
{
    return mesh->twin[mesh->half_edge[edge]] == BAT_MESH_NONE || (mesh->sharpness != NULL && mesh->sharpness[edge] > 0);
}

/// Whether an edge is on the boundary, a crease, a seam or a border of parts.
static inline bool collapse_edge_is_curve(const collapse_mesh *mesh, uint32_t edge)
{
    return collapse_edge_is_rim(mesh, edge) || (mesh->seam != NULL && mesh->seam[edge] != 0);
}

/// Whether the constraints at both ends of an edge allow its collapse: fixed vertices do not move, vertices on curves stay
/// on them, and curves do not touch. `kept` receives the end where the new vertex must be, or BAT_MESH_NONE.
static inline bool collapse_edge_is_allowed(const collapse_mesh *mesh, uint32_t edge, uint32_t *kept)
{
    uint32_t h = mesh->half_edge[edge], a = mesh->corner[h], b = mesh->corner[bat_mesh_next(h)];
    uint8_t of_a = mesh->freedom[a], of_b = mesh->freedom[b];
    *kept = BAT_MESH_NONE;
    if (of_a == COLLAPSE_FREE && of_b == COLLAPSE_FREE)
        return true;
    if (of_a != of_b)
        *kept = of_a > of_b ? a : b;
    if (collapse_edge_is_curve(mesh, edge))
        return of_a != COLLAPSE_FIXED || of_b != COLLAPSE_FIXED;
    return of_a == COLLAPSE_FREE || of_b == COLLAPSE_FREE;
}

/// Find the ring of an edge. If exactly one of its ends is on the boundary, that end becomes i.
/// @return false if the ring is too large or the collapse would change the topology. Then the link condition fails (Dey et
/// al., 1999), or a component would have fewer faces than a tetrahedron or none
bool collapse_ring_find(collapse_mesh *mesh, uint32_t edge, collapse_ring *ring);

/// The local number of a corner of a face: 0 for i, 1 for j, 2 + k for vertex[k]. `c` counts from the corner where
/// half_edge[face] begins.
static inline uint32_t collapse_ring_corner(const collapse_ring *ring, uint32_t face, uint32_t c)
{
    bool stays = face < ring->count, of_j = stays ? face >= ring->j_begin && face < ring->j_end : face > ring->count;
    uint32_t last = stays ? face + 1 : of_j ? ring->j_begin : ring->j_end;
    return c == 0 ? of_j : c == 1 ? (stays ? 2 + face : !of_j) : 2 + (ring->closed && last == ring->count ? 0 : last);
}

/// The vertex at a corner of a face.
static inline uint32_t collapse_ring_vertex(const collapse_ring *ring, uint32_t face, uint32_t c)
{
    uint32_t local = collapse_ring_corner(ring, face, c);
    return local == 0 ? ring->i : local == 1 ? ring->j : ring->vertex[local - 2];
}

/// The number of different outer vertices.
static inline uint32_t collapse_ring_vertices(const collapse_ring *ring)
{
    return ring->closed ? ring->count : ring->count + 1;
}

/// Collapse the edge of a ring into vertex i. `gone` receives the two or three removed edges, `gone_count` their number.
void collapse_apply(collapse_mesh *mesh, const collapse_ring *ring, uint32_t *gone, uint32_t *gone_count);

// A priority queue of edges by error. The next edge is the one with the smallest error, or with the smallest error of a few
// random edges (Liu et al., 2020, appendix E).

typedef struct edge_queue_item
{
    double error;
    uint32_t edge;
} edge_queue_item;

typedef struct edge_queue
{
    edge_queue_item *items; ///< `count` items; a heap when `candidates` is 0
    uint32_t *place;        ///< for each edge: its item, or EDGE_QUEUE_ABSENT
    size_t count;
    size_t candidates; ///< the number of random edges to choose from; 0: the minimum of all
    bat_random random;
} edge_queue;

#define EDGE_QUEUE_ABSENT UINT32_MAX

/// Make an empty queue for `edges` edges, in arrays of the pool.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status edge_queue_make(size_t edges, size_t candidates, uint64_t seed, memory_pool *pool, edge_queue *queue,
                           bat_error *error);

/// Fill an empty queue with the edges of finite error, in linear time. `errors` has one for each edge.
void edge_queue_fill(edge_queue *queue, const double *errors, size_t edges);
/// Insert an edge or change its error. Of equal errors the smaller index comes first.
void edge_queue_put(edge_queue *queue, uint32_t edge, double error);
/// Remove an edge, if it is in the queue.
void edge_queue_remove(edge_queue *queue, uint32_t edge);
/// Remove and return the next edge; EDGE_QUEUE_ABSENT when the queue is empty.
uint32_t edge_queue_take(edge_queue *queue);

static inline bool edge_queue_has(const edge_queue *queue, uint32_t edge)
{
    return queue->place[edge] != EDGE_QUEUE_ABSENT;
}
