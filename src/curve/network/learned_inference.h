#ifndef CURVE_NETWORK_LEARNED_INFERENCE_H
#define CURVE_NETWORK_LEARNED_INFERENCE_H

#include "curve/network/learned_network.h"
#include "learn/packed.h"

/// @file
/// The network of src/curve/network/learned_network.h for inference: no tape, no allocation. The weights are
/// used in the layout of their file.

enum
{
    /// Edges that go through the network together.
    LEARNED_ROWS = 8 * LEARN_TILE
};

/// One call's memory; aligned to 64 bytes.
typedef struct learned_scratch
{
    _Alignas(64) real x[LEARNED_ROWS * LEARNED_WIDTH];
    real inner[LEARNED_ROWS * LEARNED_WIDTH], next[LEARNED_ROWS * LEARNED_WIDTH];
    real features[LEARNED_ROWS * LEARNED_FEATURES];
    learned_edge edges[LEARNED_ROWS];
} learned_scratch;

/// The insertion angles of `count` edges, positive to the left. Where weights are so large that numbers overflow on the way,
/// the angle is that of the six-point rule.
/// @param weights  the values of learned_network_make()'s parameters, in order
/// @param angles   angles[j + i] is that of vertex i of edge j (learned_features_of()), lengths likewise
/// @param setting  that of edge 0; the parity alternates
/// @param chosen   receives `count` angles; not limited to the admissible ones
void learned_inference_angles(const real *weights, size_t count, const double *angles, const double *lengths,
                              learned_setting setting, double *chosen, learned_scratch *scratch);

#endif
