#ifndef MESH_REFINE_ADAPTIVE_H
#define MESH_REFINE_ADAPTIVE_H

#include "batten/mesh_refine.h"
#include "mesh/sides.h"

/// @file
/// Adaptive refinement: faces are split where the surface needs it.

/// Refine a checked mesh by Loop's or Catmull and Clark's scheme until every face is within options->tolerance of the limit
/// surface, and no edge is longer than options->max_edge. All vertices are on the limit surface. Triangles beside finer ones
/// are cut to their vertices; quads beside finer ones take these in as corners.
/// @param sides of the faces of `coarse`
/// @param fine  receives the mesh without names of channels
/// @return as bat_mesh_refine(); BAT_TOO_LARGE where the deepest level does not suffice
bat_status adaptive_refine(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_refine_options *options,
                           bat_mesh *fine, bat_error *error);

/// Refine by levels: the function that adaptive_refine() repeats.
bat_status refine_corners(const bat_mesh *coarse, const mesh_sides *sides, const bat_mesh_refine_options *options,
                          bat_mesh *fine, bat_error *error);

#endif
