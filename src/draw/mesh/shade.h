#ifndef DRAW_MESH_SHADE_H
#define DRAW_MESH_SHADE_H

#include "draw/mesh/view.h"

/// @file
/// Shading of a mesh into pixels.

/// Samples of a pixel in each direction.
#define SHADE_SAMPLES 3

typedef struct shade_task
{
    const bat_mesh *mesh;     ///< triangles
    const bat_mesh *polygons; ///< that the mesh is cut from, or null
    const double *values;     ///< at the vertices, or null
    double value_low, value_high;
    bool wires, flat, occlusion, boundaries;
    mesh_placing placing; ///< in pixels
    double line;          ///< the width of wires in pixels
    size_t columns, rows; ///< in pixels
    int threads;
} shade_task;

/// Draw into pixels of four bytes, cairo's ARGB32 (premultiplied, in native byte order), with rows `stride` bytes apart.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_shade(const shade_task *task, unsigned char *pixels, size_t stride, bat_error *error);

#endif
