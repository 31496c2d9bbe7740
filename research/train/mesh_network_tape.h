#ifndef RESEARCH_TRAIN_MESH_NETWORK_TAPE_H
#define RESEARCH_TRAIN_MESH_NETWORK_TAPE_H

#include "mesh/network/mesh_network.h"
#include "research/train/tape_flap.h"

/// @file
/// The mesh network of mesh/network/mesh_network.h on a tape, for training.

/// Draw weights and biases evenly between plus and minus 1 / sqrt(inputs), as PyTorch does.
void mesh_network_start(learn_parameters *parameters, uint64_t seed);

/// Refine a mesh. The tape must have begun with the network's parameters.
/// @param positions vertices x 3
/// @param states    receives the state at each level, levels->count + 1 arrays, of which the first three columns are the
///                  positions
void mesh_network_refine(learn_tape *tape, mesh_network_form form, const mesh_levels *levels, learn_array *positions,
                         learn_array **states);

#endif
