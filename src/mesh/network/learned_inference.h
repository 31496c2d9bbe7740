#ifndef MESH_NETWORK_LEARNED_INFERENCE_H
#define MESH_NETWORK_LEARNED_INFERENCE_H

#include "learn/packed.h"
#include "mesh/network/learned_network.h"

/// @file
/// Inference of the network in learned_network.h, without a tape. The results do not depend on the number of threads.

/// The layers of a level.
typedef struct learned_layers
{
    learn_packed in, in_state, hidden; ///< `in_state` of later levels only
    learn_packed message_self, message_ring, message_edge;
    learn_packed update_self, update_message, out, last;
    learn_packed end, opposite; ///< of a vertex, for its edges
    learn_packed edge_own, edge_hidden, edge_last;
    const real *ring, *ring_bias;             ///< LEARNED_RINGS x LEARNED_WIDTH
    const real *context[3], *context_bias[3]; ///< of update, vertex and edge
} learned_layers;

typedef struct mesh_learned
{
    learned_layers level[LEARNED_LEVELS_OF_MESH];
    const real *pool, *pool_bias;
    real *memory; ///< packed weights, then the parameters
} mesh_learned;

/// Pack weights with the layout of mesh_learned_make(). Release the result with mesh_learned_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_learned_pack(const learn_parameters *parameters, mesh_learned *network, bat_error *error);
void mesh_learned_free(mesh_learned *network);

/// What the levels of a mesh share. Release it with mesh_learned_end().
typedef struct mesh_learned_run
{
    real *state; ///< of the level before: vertices in whole tiles x LEARNED_WIDTH; null before the first; the last
                 ///< level overwrites it
    real context[LEARNED_CONTEXT];
    void *memory; ///< for the largest level: fresh memory costs more than what is computed in it
} mesh_learned_run;

/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_learned_begin(const mesh_levels *levels, mesh_learned_run *run, bat_error *error);
void mesh_learned_end(mesh_learned_run *run);

/// Refine a mesh by one level.
/// @param positions absolute values up to about 1
/// @param old       the number of vertices of the level before; 0 at level 0
/// @param fine      receives (vertices + edges) x 3 positions
/// @param failures  receives the number of vertices whose outputs are not finite: they stay, or lie in the edge's middle
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_learned_step(const mesh_learned *network, size_t level, const mesh_flaps *flaps, const double *positions,
                             size_t old, double fairness, int threads, mesh_learned_run *run, double *fine, size_t *failures,
                             bat_error *error);

#endif
