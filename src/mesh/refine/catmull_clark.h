#ifndef MESH_REFINE_CATMULL_CLARK_H
#define MESH_REFINE_CATMULL_CLARK_H

#include "mesh/refine/sharpness.h"

/// @file
/// Limits and weights of Catmull and Clark's scheme.

/// The weights of a smooth vertex of valence n: (n - 2) / n of it, and 1 / n^2 of each neighbour and each face's middle.
vertex_mask catmull_clark_smooth_mask(unsigned valence);

/// Compute midpoints of edges and means of faces' corners; vertices stay.
void catmull_clark_linear_rule(const mesh_rows *rows, int threads);

/// Compute the limit positions of a level's vertices; `to` has as many rows as `from`.
void catmull_clark_limit(const mesh_rows *rows, int threads);

#endif
