#ifndef MESH_DECIMATE_COLLAPSE_ERROR_H
#define MESH_DECIMATE_COLLAPSE_ERROR_H

#include "mesh/decimate/collapse.h"
#include "mesh/decimate/quadric.h"

/// @file
/// What a collapse costs, where the new vertex goes, and whether the faces around it stay sound in space.

/// A vertex and the planes that it stands for.
typedef struct error_vertex
{
    double position[3];
    quadric planes; ///< about `position`
} error_vertex;

/// Where the new vertex of a collapse goes.
typedef struct error_placement
{
    double position[3];
    double error; ///< by which edges are ordered
} error_placement;

/// Give every vertex the planes of its faces, weighted by their areas, and across every boundary and crease edge a plane
/// through it, upright on its face, weighted by the square of its length times `curve_weight`.
void error_vertices_set(const bat_mesh *mesh, const collapse_mesh *topology, double curve_weight, error_vertex *vertices);

/// Place the new vertex of the edge from i to j where the error is least, at one of its ends or in its middle where that is
/// as good. `kept` is the end where it must be, or BAT_MESH_NONE.
error_placement error_place(const error_vertex *vertices, uint32_t i, uint32_t j, uint32_t kept);

/// Give vertex i the place of a collapse and the planes of both.
void error_merge(error_vertex *vertices, uint32_t i, uint32_t j, const double *position);

/// Whether every face of a ring that stays keeps its side, unit normals before and after having a scalar product of at least
/// `min_normal`, and has after the collapse a quality of at least `min_quality`, or that of the worst face before.
bool error_faces_stay_valid(const error_vertex *vertices, const collapse_ring *ring, const double *position,
                            double min_normal, double min_quality);

#endif
