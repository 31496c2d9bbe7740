#ifndef DRAW_MESH_SHADE_H
#define DRAW_MESH_SHADE_H

#include "draw/mesh/view.h"

/// @file
/// From a mesh to the pixels of its picture.

/// Samples of a pixel across and down.
#define SHADE_SAMPLES 3

typedef struct shade_task
{
    const bat_mesh *mesh;
    const double *values; ///< of the vertices, or null
    double value_low, value_high;
    bool wires, flat, occlusion, boundaries;
    mesh_placing placing; ///< in pixels
    double line;          ///< the width of wires in pixels
    size_t columns, rows; ///< of pixels
    int threads;
} shade_task;

/// Draw into pixels of four bytes, cairo's ARGB32 (premultiplied, in the machine's order), each row `stride` bytes after the
/// one before.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_shade(const shade_task *task, unsigned char *pixels, size_t stride, bat_error *error);

#endif
