#ifndef MESH_REFINE_LIMIT_H
#define MESH_REFINE_LIMIT_H

#include "mesh/refine/sharpness.h"

/// @file
/// Limit positions that Loop's and Catmull and Clark's schemes have in common: those of creases and corners.

/// Compute the limit positions of a level's vertices; `rows->to` has as many rows as `rows->from`. A crease is a cubic
/// B-spline, so its limit is (4 v + p + q) / 6 for the neighbours p and q on it. Corners stay.
/// @param inner writes the row of a vertex that is neither
void limit_rows(const mesh_rows *rows, void (*inner)(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp),
                int threads);

#endif
