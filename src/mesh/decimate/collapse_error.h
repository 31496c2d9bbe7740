#ifndef MESH_DECIMATE_COLLAPSE_ERROR_H
#define MESH_DECIMATE_COLLAPSE_ERROR_H

#include "base/memory.h"
#include "mesh/decimate/collapse.h"
#include "mesh/decimate/quadric.h"
#include "mesh/measure/closest.h"

/// @file
/// Texture coordinates and channels during decimation: Hoppe, "New quadric metric for simplifying meshes with appearance
/// attributes" (1999).
///
/// On a face with the gradient g of a value, the value s at a vertex p has the error (g . (p - v) + t - s)^2, with t the
/// value at the face's corner v. An owner has the weighted sums of all given faces that became it: of the weights, of g and
/// of the offsets g . (p - v) + t - s. A vertex has those of g g^T, of offsets times g and of squared offsets as a quadric.
/// With them the best value of a merged owner, and its error, follow for any position.

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

/// Set the values of a mesh.
/// @param weight a multiple of the scales
/// @return BAT_OK or BAT_NO_MEMORY
bat_status attributes_make(const bat_mesh *mesh, const collapse_mesh *topology, double weight, attributes *made,
                           bat_error *error);
void attributes_free(attributes *all);

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

/// Set the quadrics: the planes of each vertex's faces, weighted by area. Each boundary and crease edge adds the plane
/// through it that is perpendicular to its face, weighted by its squared length times `curve_weight`; at a seam, where no
/// gap can open, by its squared length alone.
void error_vertices_set(const bat_mesh *mesh, const collapse_mesh *topology, double curve_weight, error_vertex *vertices);

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

/// Place the new vertex of an edge. The mean squared error of its values is added to that of the faces. `kept` is the
/// prescribed end, or BAT_MESH_NONE.
error_placement memoryless_place(const collapse_mesh *mesh, const error_vertex *vertices, const attributes *fields,
                                 uint32_t edge, uint32_t kept);

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

#endif
