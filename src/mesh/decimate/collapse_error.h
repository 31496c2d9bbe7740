#pragma once

#include "mesh/decimate/collapse.h"
#include "mesh/measure/closest.h"

#include <stdbool.h>

/// @file
/// Sums of squared distances from planes (Garland and Heckbert, "Surface simplification using quadric error metrics", 1997),
/// about a centre: the error of the point centre + d is d^T A d + 2 b^T d + c. A centre at the vertex avoids cancellation on
/// meshes far from the origin.

typedef struct quadric
{
    double xx, xy, xz, yy, yz, zz; ///< A
    double x, y, z;                ///< b
    double constant;               ///< c
} quadric;

/// Add the plane through the centre with the unit normal `normal`.
static inline void quadric_add_plane(quadric *sum, const double *normal, double weight)
{
    sum->xx += weight * normal[0] * normal[0];
    sum->xy += weight * normal[0] * normal[1];
    sum->xz += weight * normal[0] * normal[2];
    sum->yy += weight * normal[1] * normal[1];
    sum->yz += weight * normal[1] * normal[2];
    sum->zz += weight * normal[2] * normal[2];
}

/// A d.
static inline void quadric_multiply(const quadric *q, const double *d, double *product)
{
    product[0] = q->xx * d[0] + q->xy * d[1] + q->xz * d[2];
    product[1] = q->xy * d[0] + q->yy * d[1] + q->yz * d[2];
    product[2] = q->xz * d[0] + q->yz * d[1] + q->zz * d[2];
}

static inline double quadric_error(const quadric *q, const double *d)
{
    double p[3];
    quadric_multiply(q, d, p);
    return q->constant + d[0] * (p[0] + 2 * q->x) + d[1] * (p[1] + 2 * q->y) + d[2] * (p[2] + 2 * q->z);
}

/// The same sum about the centre + d.
static inline quadric quadric_moved(const quadric *q, const double *d)
{
    quadric moved = *q;
    double p[3];
    quadric_multiply(q, d, p);
    moved.x += p[0];
    moved.y += p[1];
    moved.z += p[2];
    moved.constant = quadric_error(q, d);
    return moved;
}

/// The sum of two quadrics about the same centre.
static inline quadric quadric_sum(const quadric *p, const quadric *q)
{
    return (quadric){p->xx + q->xx, p->xy + q->xy, p->xz + q->xz, p->yy + q->yy, p->yz + q->yz,
                     p->zz + q->zz, p->x + q->x,   p->y + q->y,   p->z + q->z,   p->constant + q->constant};
}

/// The total weight of the planes.
static inline double quadric_weight(const quadric *q)
{
    return q->xx + q->yy + q->zz;
}

/// Minimize the error: solve (A + damping I) d = -b by Cholesky factorization. Damping keeps d short in directions that no
/// plane determines. False when the matrix is not positive definite.
static inline bool quadric_minimize(const quadric *q, double damping, double *d)
{
    double xx = q->xx + damping;
    if (!(xx > 0))
        return false;
    double yx = q->xy / xx, zx = q->xz / xx;
    double yy = q->yy + damping - yx * q->xy;
    if (!(yy > 0))
        return false;
    double below = q->yz - zx * q->xy, zy = below / yy;
    double zz = q->zz + damping - zx * q->xz - zy * below;
    if (!(zz > 0))
        return false;
    double y = -q->y + yx * q->x;
    d[2] = (-q->z + zx * q->x - zy * y) / zz;
    d[1] = y / yy - zy * d[2];
    d[0] = -q->x / xx - yx * d[1] - zx * d[2];
    return true;
}

// Texture coordinates and channels during decimation: Hoppe, "New quadric metric for simplifying meshes with appearance
// attributes" (1999).
//
// On a face with the gradient g of a value, the value s at a vertex p has the error (g . (p - v) + t - s)^2, with t the
// value at the face's corner v. An owner has the weighted sums of all given faces that became it: of the weights, of g and
// of the offsets g . (p - v) + t - s. A vertex has those of g g^T, of offsets times g and of squared offsets as a quadric.
// With them the best value of a merged owner, and its error, follow for any position.

struct error_vertex;

/// Values at owners, multiplied by scales that turn them into lengths: the texture's owners are the sectors of a vertex
/// between seams; those of channels are the vertices.
typedef struct attribute_field
{
    uint32_t *owner; ///< for each half-edge: the owner at its begin; null: the vertex
    double *values;  ///< owner_count x width
    double *sums;    ///< owner_count x (1 + 4 width): the weight; for each value the sums of gradients and of offsets
    double *scales;  ///< width powers of two
    size_t width, owner_count;
} attribute_field;

typedef struct attributes
{
    attribute_field texture, channels; ///< of width 0 where the mesh has none
    quadric *errors;                   ///< for each vertex, about it; null where the mesh has no values
} attributes;

/// Set the values of a mesh, in arrays of the pool.
/// @param weight a multiple of the scales
/// @return BAT_OK or BAT_NO_MEMORY
bat_status attributes_make(const bat_mesh *mesh, const collapse_mesh *topology, double weight, memory_pool *pool,
                           attributes *made, bat_error *error);

/// The error of the values of an edge's new vertex, about the edge's middle: of the best ones, or of those at `kept`.
/// `weight` receives the sum of the weights. False without values.
bool attributes_error(const attributes *all, const collapse_mesh *mesh, uint32_t edge, const double *half, uint32_t kept,
                      quadric *sum, double *weight);
/// Whether no face of a ring turns over in the texture when its edge collapses to a position.
bool attributes_stay_valid(const attributes *all, const collapse_mesh *mesh, const struct error_vertex *vertices,
                           const collapse_ring *ring, const double *position, uint32_t kept);
/// Merge the owners of an edge. It goes before error_merge() and collapse_apply().
void attributes_merge(attributes *all, const collapse_mesh *mesh, const collapse_ring *ring, const double *position,
                      uint32_t kept, const struct error_vertex *vertices);
/// Set texture and channels of the result. The stamp of a vertex is its number there.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status attributes_finish(const attributes *all, const bat_mesh *fine, const collapse_mesh *mesh, bat_mesh *coarse,
                             bat_error *error);

// The error of a collapse, the position of its new vertex, and the validity of the faces around it in space.

/// A vertex and the quadric of its planes.
typedef struct error_vertex
{
    double position[3];
    quadric planes; ///< about `position`
} error_vertex;

/// The new vertex of a collapse.
typedef struct error_placement
{
    double position[3];
    double error; ///< the key by which edges are ordered
} error_placement;

/// Set the quadrics, with the positions set: the planes of each vertex's faces, weighted by area. Each boundary and crease
/// edge adds the plane through it that is perpendicular to its face, weighted by its squared length times `curve_weight`; at
/// a seam, where no gap can open, by its squared length alone.
void error_vertices_set(const collapse_mesh *mesh, double curve_weight, error_vertex *vertices);

/// Place the new vertex of the edge from i to j at the minimum of the error. An end or the midpoint is preferred where it is
/// as good. `kept` is the prescribed end, or BAT_MESH_NONE.
error_placement error_place(const collapse_mesh *mesh, const error_vertex *vertices, const attributes *fields, uint32_t edge,
                            uint32_t kept);

/// Move vertex i to the new position and add the quadrics of both vertices.
void error_merge(error_vertex *vertices, uint32_t i, uint32_t j, const double *position);

/// Whether the remaining faces of a ring are valid after the collapse. The unit normals before and after have a scalar
/// product of at least `min_normal`. The quality is at least `min_quality`, or that of the worst face before.
bool error_faces_stay_valid(const error_vertex *vertices, const collapse_ring *ring, const double *position,
                            double min_normal, double min_quality);

// The memoryless error of a collapse: Lindstrom and Turk, "Fast and memory efficient polygonal simplification" (1998) and
// "Evaluation of memoryless simplification" (1999). It depends on the current mesh alone.
//
// The new vertex preserves the volume and the area at a boundary. Among such positions it minimizes the squared volumes of
// the tetrahedra between the new vertex and the faces around the edge, and the squared areas at the boundary. Directions
// that these do not determine bring the vertex near the mean of its neighbours.
//
// `planes` of an error_vertex holds sums over its faces: of n n^T (the matrix) and n (the vector), with n the normal of
// twice the face's area as length. All these faces pass through the vertex, so the error of the vertex + d is d^T A d.

/// Set the sums of a vertex from its current faces.
void memoryless_vertex_set(const collapse_mesh *mesh, error_vertex *vertices, uint32_t vertex);
/// Move vertex i of a ring to the new position and update the sums of it and of the vertices around. It goes before
/// collapse_apply().
void memoryless_merge(error_vertex *vertices, const collapse_ring *ring, const double *position);

/// Place the new vertex of an edge, by a closed form where `quick`. The mean squared error of its values is added to that of
/// the faces. `kept` is the prescribed end, or BAT_MESH_NONE.
error_placement memoryless_place(const collapse_mesh *mesh, const error_vertex *vertices, const attributes *fields,
                                 uint32_t edge, uint32_t kept, bool quick);

// A bound on the distance between a mesh and its decimation, checked at samples for every collapse.
//
// Samples of the given mesh are its vertices and the middles of its edges and faces. Each belongs to the present face that
// was nearest when the faces around it last changed; it must stay within the bound of one of the new faces. Samples of the
// result are its vertices, three points of each edge and four of each face; they must stay within the bound of the given
// mesh.

typedef struct tolerance
{
    memory_pool pool; ///< holds the arrays
    double bound;
    closest_tree tree; ///< of the given mesh
    double *samples;   ///< sample_count x 3
    size_t sample_count;
    uint32_t *first;  ///< for each face: its first sample, or BAT_MESH_NONE
    uint32_t *next;   ///< for each sample: the next one of its face, or BAT_MESH_NONE
    uint32_t *place;  ///< for each vertex: a place of the tree near it
    uint32_t *moved;  ///< the samples of the current ring
    uint8_t *nearest; ///< for each of them: its new face in the ring
    size_t moved_count;
} tolerance;

/// @return BAT_OK or BAT_NO_MEMORY
/// @param topology of the given mesh, before any collapse
bat_status tolerance_make(const bat_mesh *fine, const bat_mesh_connectivity *topology, double bound, tolerance *made,
                          bat_error *error);
void tolerance_free(tolerance *all);

/// Whether the collapse of a ring to a position keeps the bound at all samples.
bool tolerance_allows(tolerance *all, const error_vertex *vertices, const collapse_ring *ring, const double *position);
/// Give the samples of the ring of the last tolerance_allows() to their new faces.
void tolerance_apply(tolerance *all, const collapse_ring *ring);
