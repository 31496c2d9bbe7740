#ifndef RESEARCH_NETWORKS_MESH_INFERENCE_H
#define RESEARCH_NETWORKS_MESH_INFERENCE_H

#include "learn/packed.h"
#include "mesh/network/flap.h"
#include "research/networks/mesh_frame.h"
#include "research/networks/mesh_network.h"

/// @file
/// Inference of the network in network.h, without a tape. The results do not depend on the number of threads.

/// The layers of a module.
typedef struct mesh_inference_module
{
    learn_packed features; ///< the part of the first layer for vertex features, for each corner
    learn_packed geometry; ///< the part of the first layer for edges and differential coordinates
    learn_packed hidden, last;
} mesh_inference_module;

typedef struct mesh_inference
{
    mesh_network_form form;
    mesh_inference_module module[MESH_MODULE_COUNT];
    real *memory; ///< the weights of all modules
} mesh_inference;

/// Pack weights with the layout of mesh_network_make(). Release the result with mesh_inference_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_inference_make(const learn_parameters *parameters, mesh_network_form form, mesh_inference *network,
                               bat_error *error);
void mesh_inference_free(mesh_inference *network);

/// Refine a mesh by levels->count levels, at least 1.
/// @param positions of the coarse mesh, vertices x 3
/// @param fine      receives levels->vertex_count x 3 positions
/// @param fallback  receives the number of coarse edges without a frame plus the number of half-flaps with an output that is
/// not finite. These displace nothing, so their new vertices are midpoints
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_inference_refine(const mesh_inference *network, const mesh_levels *levels, int threads,
                                 const real *positions, real *fine, size_t *fallback, bat_error *error);

#endif
