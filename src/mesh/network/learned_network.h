#ifndef MESH_NETWORK_LEARNED_NETWORK_H
#define MESH_NETWORK_LEARNED_NETWORK_H

#include "learn/parameters.h"
#include "mesh/network/learned_geometry.h"

/// @file
/// The network of the shipped mesh scheme. docs/algorithms/mesh-network.md describes it.
///
///     s   = relu(hidden relu(in [inputs of the vertex, state of the level before]))         each vertex
///     m   = mean of relu(self s_v + ring s_w + edge x_e)                                    its half-flaps v -> w
///     g   = relu(pool [mean s, mean m])                                                     the mesh, level 0 only
///     s'  = relu(update [s, m] + context [g, fairness])                                     each vertex
///     c_v = last relu(out s' + context)                                                     coefficients of a vertex
///     h   = relu(end (s'_i + s'_j) + opposite (s'_k + s'_l) + own x_e + context)            each edge
///     c_e = last relu(hidden h)                                                             coefficients of an edge
///
/// Both levels have the same layers with weights of their own.

enum
{
    LEARNED_LEVELS_OF_MESH = 2,
    LEARNED_WIDTH = 32,
    LEARNED_POOL = 16,
    LEARNED_CONTEXT = LEARNED_POOL + 2 ///< the pooled numbers, the fairness and its square
};

/// The parameters of a level, in their order.
typedef enum learned_parameter
{
    LEARNED_VERTEX_IN,
    LEARNED_VERTEX_IN_BIAS,
    LEARNED_VERTEX_HIDDEN,
    LEARNED_VERTEX_HIDDEN_BIAS,
    LEARNED_MESSAGE_SELF,
    LEARNED_MESSAGE_SELF_BIAS,
    LEARNED_MESSAGE_RING,
    LEARNED_MESSAGE_EDGE,
    LEARNED_RING_LAST, ///< the weights of the ring sums
    LEARNED_RING_LAST_BIAS,
    LEARNED_UPDATE_SELF,
    LEARNED_UPDATE_MESSAGE,
    LEARNED_UPDATE_BIAS,
    LEARNED_VERTEX_OUT,
    LEARNED_VERTEX_OUT_BIAS,
    LEARNED_VERTEX_LAST,
    LEARNED_VERTEX_LAST_BIAS,
    LEARNED_EDGE_END,
    LEARNED_EDGE_OPPOSITE,
    LEARNED_EDGE_OWN,
    LEARNED_EDGE_OWN_BIAS,
    LEARNED_EDGE_HIDDEN,
    LEARNED_EDGE_HIDDEN_BIAS,
    LEARNED_EDGE_LAST,
    LEARNED_EDGE_LAST_BIAS,
    LEARNED_CONTEXT_UPDATE,
    LEARNED_CONTEXT_VERTEX,
    LEARNED_CONTEXT_EDGE,
    LEARNED_LEVEL_PARAMETERS
} learned_parameter;

/// After the levels' parameters.
enum
{
    LEARNED_POOL_WEIGHT = LEARNED_LEVELS_OF_MESH * LEARNED_LEVEL_PARAMETERS,
    LEARNED_POOL_BIAS,
    LEARNED_PARAMETERS
};

/// The index of a level's parameter.
static inline size_t learned_parameter_of(size_t level, learned_parameter which)
{
    return level * LEARNED_LEVEL_PARAMETERS + (size_t)which;
}

/// The weights' names and shapes, all zero.
/// @param parameters all zero before the call; release it with learn_parameters_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_learned_make(learn_parameters *parameters, bat_error *error);

/// A coefficient from a network's output: middle + reach tanh(output).
typedef struct learned_bound
{
    real middle, reach;
} learned_bound;

extern const learned_bound learned_vertex_bound[LEARNED_VERTEX_CANDIDATES];
extern const learned_bound learned_edge_bound[LEARNED_EDGE_CANDIDATES];
/// A ring sum is this times the sum of tanh(weight) times the difference to the neighbour.
#define LEARNED_RING_SHARE 0.5

#endif
