#ifndef MESH_DECIMATE_COLLAPSE_ERROR_H
#define MESH_DECIMATE_COLLAPSE_ERROR_H

#include "mesh/decimate/attributes.h"
#include "mesh/decimate/collapse.h"
#include "mesh/decimate/quadric.h"

/// @file
/// The error of a collapse, the position of its new vertex, and the validity of the faces around it in space.

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

#endif
