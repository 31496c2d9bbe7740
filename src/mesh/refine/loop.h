#ifndef MESH_REFINE_LOOP_H
#define MESH_REFINE_LOOP_H

#include "mesh/refine/level.h"

/// Move a level's vertices to where Loop's scheme takes them in the limit, into `to` of as many rows.
void loop_limit(const mesh_rows *rows, int threads);

/// The weight that Loop's rule gives each of `valence` neighbours of a smooth vertex: Loop (1987).
double loop_ring_weight(unsigned valence);

#endif
