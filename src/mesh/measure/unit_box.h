#pragma once

#include <math.h>
#include <stddef.h>

/// @file
/// The published normalization of meshes (Liu et al., 2020): u = (v - low) / size, which maps the smallest coordinates to 0
/// and the largest extent to 1.

typedef struct unit_box
{
    double low[3], size;
} unit_box;

/// The box of `count` x 3 coordinates.
static inline unit_box unit_box_of(const double *positions, size_t count)
{
    unit_box box = {{INFINITY, INFINITY, INFINITY}, 0};
    for (size_t i = 0; i < 3 * count; i++)
        box.low[i % 3] = fmin(box.low[i % 3], positions[i]);
    for (size_t i = 0; i < 3 * count; i++)
        box.size = fmax(box.size, positions[i] - box.low[i % 3]);
    if (!(box.size > 0))
        box.size = 1;
    return box;
}

/// Map coordinate i % 3 into the box.
static inline double unit_box_in(const unit_box *box, size_t i, double coordinate)
{
    return (coordinate - box->low[i % 3]) / box->size;
}
