#ifndef MESH_NETWORK_FRAME_H
#define MESH_NETWORK_FRAME_H

#include "learn/real.h"

#include <stdbool.h>
#include <stddef.h>

/// @file
/// The frames of half-flaps, forward and backward. All arrays hold a number of all half-flaps before the next number, so
/// that the loops over half-flaps are vector code.
///
/// With e_j, e_k, e_l from corner i to the others: x = e_j / |e_j|; z the unit vector along the sum of the unit normals of
/// the two faces; y = z cross x (Liu et al. 2020, figure 13). A half-flap without an edge, without an area or folded onto
/// itself has a frame of zeros, and what is seen in it is zero.

enum
{
    FLAP_EDGES = 9,            ///< numbers: e_j, e_k, e_l
    FLAP_FRAME = 10,           ///< numbers: x, y, z, and the length that stands for 1
    FLAP_UNIT = FLAP_FRAME - 1 ///< where that length is
};

/// How to look at half-flaps.
typedef struct flap_frame_options
{
    bool fixed;    ///< through the axes of space instead of the frames
    bool relative; ///< lengths by the root of the mean square of the half-flap's five edges
} flap_frame_options;

/// @param edges FLAP_EDGES x count
/// @param frame FLAP_FRAME x count
void flap_frames(flap_frame_options options, size_t count, const real *edges, real *frame);
/// Add the derivative by the edges to `edge_gradient`.
void flap_frames_back(flap_frame_options options, size_t count, const real *edges, const real *frame_gradient,
                      real *edge_gradient);

/// Vectors as they are seen: in the frame, over its length.
/// @param vectors,seen 3 x count
void flap_turn(size_t count, const real *frame, const real *vectors, real *result);
/// Add the derivative by the frame to `frame_gradient`; `gradient` is that by what is seen and becomes that by the vectors.
void flap_turn_back(size_t count, const real *frame, const real *vectors, real *frame_gradient, real *gradient);

#endif
