#ifndef RESEARCH_NETWORKS_MESH_FRAME_H
#define RESEARCH_NETWORKS_MESH_FRAME_H

#include "learn/real.h"

#include <stdbool.h>
#include <stddef.h>

/// @file
/// Local frames of half-flaps and their derivatives. Arrays are stored component by component, each for all half-flaps, so
/// that loops over half-flaps vectorize.
///
/// Let e_j, e_k, e_l be the vectors from corner i to the other corners. Then x = e_j / |e_j|, z is the normalized sum of the
/// unit normals of both faces, and y is the cross product of z and x (Liu et al., 2020, figure 13). The frame and all
/// coordinates in it are zero where an edge or an area vanishes, or where the faces are folded onto each other.

enum
{
    FLAP_EDGES = 9,            ///< components of e_j, e_k, e_l
    FLAP_FRAME = 10,           ///< components of x, y, z, and the unit of length
    FLAP_UNIT = FLAP_FRAME - 1 ///< the index of the unit of length
};

/// How frames are chosen.
typedef struct flap_frame_options
{
    bool fixed;    ///< the axes of space replace the local frames
    bool relative; ///< lengths are divided by the root mean square of the half-flap's five edges
} flap_frame_options;

/// Compute the frames.
/// @param edges FLAP_EDGES x count
/// @param frame FLAP_FRAME x count
void flap_frames(flap_frame_options options, size_t count, const real *edges, real *frame);
/// Add the gradient with respect to the edges to `edge_gradient`.
void flap_frames_back(flap_frame_options options, size_t count, const real *edges, const real *frame_gradient,
                      real *edge_gradient);

/// Transform vectors into the frames, divided by the unit of length.
/// @param vectors 3 x count
/// @param result  3 x count
void flap_turn(size_t count, const real *frame, const real *vectors, real *result);
/// Add the gradient with respect to the frames to `frame_gradient`. `gradient` is the one with respect to the result and
/// becomes the one with respect to the vectors.
void flap_turn_back(size_t count, const real *frame, const real *vectors, real *frame_gradient, real *gradient);

#endif
