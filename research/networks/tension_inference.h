#ifndef RESEARCH_NETWORKS_TENSION_INFERENCE_H
#define RESEARCH_NETWORKS_TENSION_INFERENCE_H

#include "learn/packed.h"
#include "learn/parameters.h"
#include "research/networks/tension_network.h"

/// @file
/// The network of tension_network.h for inference alone: no tape, nothing allocated, any number of threads
/// at once.

/// What follows a linear layer.
typedef struct tension_norm
{
    const real *gain, *shift;
} tension_norm;

typedef struct tension_inference
{
    learn_packed input[TENSION_SPACES]; ///< they differ in the bias, which holds what the space contributes
    tension_norm input_norm;
    struct
    {
        learn_packed linear_1, linear_2;
        tension_norm norm_1, norm_2;
    } blocks[TENSION_BLOCKS];
    learn_packed head_1, head_2;
    real *memory; ///< all of them
} tension_inference;

enum
{
    /// Rows that go through the network together.
    TENSION_INFERENCE_ROWS = 8 * LEARN_TILE,
    /// Numbers of scratch memory: three arrays of so many rows.
    TENSION_INFERENCE_SCRATCH = 3 * TENSION_INFERENCE_ROWS * TENSION_WIDTH
};

/// Lay out weights as tension_network_make() or tension_network_make_plain() describes them, the latter with
/// TENSION_FEATURES inputs, or with TENSION_SPACES more of which the edge's space is 1. Release it with
/// tension_inference_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status tension_inference_make(const learn_parameters *parameters, tension_inference *network, bat_error *error);
void tension_inference_free(tension_inference *network);

/// The insertion angles of `count` edges in one space. Where weights are so large that numbers overflow on the way, the
/// angle is 0: every angle is within TENSION_ANGLE_LIMIT.
/// @param space    curvature + 1
/// @param features rows of TENSION_FEATURES, with room for learn_whole_tiles(count) rows; the rows behind the last are
///                 overwritten
/// @param scratch  TENSION_INFERENCE_SCRATCH numbers, aligned to 64 bytes
void tension_inference_angles(const tension_inference *network, size_t space, size_t count, real *features, double *angles,
                              real *scratch);

#endif
