#ifndef DRAW_MESH_AMBIENT_OCCLUSION_H
#define DRAW_MESH_AMBIENT_OCCLUSION_H

#include "batten/base.h"

/// @file
/// How much of the sky a seen surface has above it, from the depths of its surroundings in the picture.

/// What is seen at the pixels of a picture: depths in pixels towards the eye, -HUGE_VALF where there is nothing; unit
/// normals, x to the right, y upwards, z to the eye.
typedef struct hollow_picture
{
    size_t columns, rows;
    const float *depths;
    const float (*normals)[3];
    double reach; ///< pixels: what is farther away takes no light
} hollow_picture;

/// The share of light from all around that reaches each pixel's surface, 0 to 1 (Mittring, "Finding Next Gen", 2007, with
/// the surface's own plane as horizon).
/// @param light receives columns x rows shares
/// @return BAT_OK or BAT_NO_MEMORY
bat_status hollow_light(const hollow_picture *picture, int threads, float *light, bat_error *error);

#endif
