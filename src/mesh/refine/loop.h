#ifndef MESH_REFINE_LOOP_H
#define MESH_REFINE_LOOP_H

#include "mesh/refine/sharpness.h"

/// @file
/// Limits and weights of Loop's scheme.

/// Compute the limit positions of a level's vertices on Loop's surface; `to` has as many rows as `from`.
void loop_limit(const mesh_rows *rows, int threads);

/// The weights of Loop's rule for a smooth vertex.
vertex_mask loop_smooth_mask(unsigned valence);

#endif
