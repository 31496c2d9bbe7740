#ifndef MESH_NETWORK_INFERENCE_H
#define MESH_NETWORK_INFERENCE_H

#include "learn/packed.h"
#include "mesh/network/flap.h"
#include "mesh/network/frame.h"
#include "mesh/network/network.h"

/// @file
/// The network of src/mesh/network/network.h for inference alone: no tape, a block of half-flaps at a time, on any
/// number of threads to the same bytes.

/// A module's layers.
typedef struct mesh_inference_module
{
    learn_packed features; ///< of the first layer: from a vertex's features to its share of a half-flap, for each corner
    learn_packed geometry; ///< of the first layer: from what is seen
    learn_packed hidden, last;
} mesh_inference_module;

typedef struct mesh_inference
{
    mesh_network_form form;
    mesh_inference_module module[MESH_MODULE_COUNT];
    real *memory; ///< all of them
} mesh_inference;

/// Lay out weights as mesh_network_make() describes them. Release it with mesh_inference_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_inference_make(const learn_parameters *parameters, mesh_network_form form, mesh_inference *network,
                               bat_error *error);
void mesh_inference_free(mesh_inference *network);

/// Refine a mesh by levels->count levels, at least 1.
/// @param positions of the coarse mesh, vertices x 3
/// @param fine      receives levels->vertex_count x 3 positions
/// @param fallback  receives the edges of the coarse mesh without a frame, of no length or no area, and those half-flaps of
/// any level for
///                  which the network says no number; they displace nothing, which leaves new vertices in the middle of
///                  their edges
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_inference_refine(const mesh_inference *network, const mesh_levels *levels, int threads,
                                 const real *positions, real *fine, size_t *fallback, bat_error *error);

#endif
