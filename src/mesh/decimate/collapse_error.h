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

#endif
