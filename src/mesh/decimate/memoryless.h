#ifndef MESH_DECIMATE_MEMORYLESS_H
#define MESH_DECIMATE_MEMORYLESS_H

#include "mesh/decimate/collapse_error.h"

/// @file
/// The memoryless error of a collapse: Lindstrom and Turk, "Fast and memory efficient polygonal simplification" (1998) and
/// "Evaluation of memoryless simplification" (1999). It depends on the current mesh alone.
///
/// The new vertex preserves the volume and the area at a boundary. Among such positions it minimizes the squared volumes of
/// the tetrahedra between the new vertex and the faces around the edge, and the squared areas at the boundary. Directions
/// that these do not determine bring the vertex near the mean of its neighbours.
///
/// `planes` of an error_vertex holds sums over its faces: of n n^T (the matrix) and n (the vector), with n the normal of
/// twice the face's area as length. All these faces pass through the vertex, so the error of the vertex + d is d^T A d.

/// Set the sums of a vertex from its current faces.
void memoryless_vertex_set(const collapse_mesh *mesh, error_vertex *vertices, uint32_t vertex);

/// Place the new vertex of an edge. The mean squared error of its values is added to that of the faces. `kept` is the
/// prescribed end, or BAT_MESH_NONE.
error_placement memoryless_place(const collapse_mesh *mesh, const error_vertex *vertices, const attributes *fields,
                                 uint32_t edge, uint32_t kept);

#endif
