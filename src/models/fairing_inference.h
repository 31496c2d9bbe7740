#ifndef MODELS_FAIRING_INFERENCE_H
#define MODELS_FAIRING_INFERENCE_H

#include "learn/packed.h"
#include "models/fairing_network.h"

/// @file
/// The network of models/fairing_network.h for inference alone: no tape, nothing allocated, nothing laid out anew: the
/// weights are used as a file holds them.

enum
{
    /// Edges that go through the network together.
    FAIRING_ROWS = 8 * LEARN_TILE
};

/// One call's memory; aligned to 64 bytes.
typedef struct fairing_scratch
{
    _Alignas(64) real x[FAIRING_ROWS * FAIRING_WIDTH];
    real inner[FAIRING_ROWS * FAIRING_WIDTH], next[FAIRING_ROWS * FAIRING_WIDTH];
    real features[FAIRING_ROWS * FAIRING_SEEN];
    fairing_sight sights[FAIRING_ROWS];
} fairing_scratch;

/// The insertion angles of `count` edges, positive to the left. Where weights are so large that numbers overflow on the way, the
/// angle is that of the six-point rule.
/// @param weights  the values of fairing_network_make()'s parameters, in order
/// @param angles   angles[j + i] is that of vertex i as edge j counts (fairing_see()), lengths alike
/// @param chosen   receives `count` angles; not limited to the admissible ones
void fairing_inference_angles(const real *weights, size_t count, const double *angles, const double *lengths,
                              double curvature, double fairness, double *chosen, fairing_scratch *scratch);

#endif
