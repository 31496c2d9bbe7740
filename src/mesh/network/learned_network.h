#pragma once

#include "batten/mesh_refine.h"
#include "learn/model.h"
#include "learn/packed.h"
#include "mesh/network/flap.h"

/// @file
/// The geometry of one level for the network of learned_network.h: features of edges and vertices, and the candidate
/// vectors that the network combines.
///
/// Features do not change under rigid motions, reflections, scaling and renumbering, nor where all faces are turned over.
/// Candidates turn with the mesh. Each is a sum of differences of vertices, or such a sum projected on a normal. So on a
/// plane they lie in the plane.

enum
{
    LEARNED_EDGE_FEATURES = 16,
    LEARNED_VERTEX_FEATURES = 12, ///< of the vertex itself
    /// Of the vertex, then mean and maximum of its edges' features.
    LEARNED_VERTEX_INPUTS = LEARNED_VERTEX_FEATURES + 2 * LEARNED_EDGE_FEATURES,
    LEARNED_RING_NUMBERS = 4,    ///< of the vertex's features, those of its edges' directions and lengths
    LEARNED_VERTEX_NUMBERS = 10, ///< in learned_geometry::memory, for each vertex
    LEARNED_EDGE_NUMBERS = 6,    ///< the same for each edge
    LEARNED_RINGS = 2, ///< weighted sums over the ring of a vertex: one moves the vertex, one its edges' new vertices
    LEARNED_VERTEX_CANDIDATES = 6,
    LEARNED_EDGE_CANDIDATES = 9
};

/// The geometry of a level.
typedef struct learned_geometry
{
    const mesh_flaps *flaps;
    const double *positions;    ///< vertices x 3
    double (*umbrella)[3];      ///< vertices: mean of the neighbours minus the vertex
    double (*second)[3];        ///< vertices: mean of the neighbours' umbrellas
    double (*vertex_normal)[3]; ///< vertices: unit, or 0
    double (*edge_normal)[3];   ///< edges: unit, or 0
    double (*star)[3];          ///< edges: the butterfly rule of irregular vertices, mean of both ends, minus the middle
    real *edge_features;        ///< edges x LEARNED_EDGE_FEATURES
    double *size;               ///< vertices: mean length of the edges
    real *bend;                 ///< edges: height of the opposite vertices over the edge's middle, along the normal
    real (*ring)[LEARNED_RING_NUMBERS]; ///< vertices
} learned_geometry;

/// The memory that a geometry takes, in bytes.
size_t learned_geometry_size(size_t vertices, size_t edges);
/// Compute the geometry in memory of learned_geometry_size() bytes, aligned to 8, which stays the caller's.
/// @param positions absolute values between 0 and about 1, so that no product overflows
learned_geometry learned_geometry_in(const mesh_flaps *flaps, const double *positions, int threads, void *memory);
/// Compute the inputs of a vertex.
/// @param old the first `old` vertices are those of the level before; 0 at the first level
/// @param row LEARNED_VERTEX_INPUTS
void learned_vertex_inputs(const learned_geometry *geometry, size_t old, size_t vertex, real *row);

/// Whether a vertex is on the boundary. Its half-flaps must be there.
bool learned_at_boundary(const mesh_flaps *flaps, size_t vertex);

/// The candidate vectors of a vertex. The last two are the sum over its ring and that sum's normal part.
/// @param ring the weighted sum of the differences to the neighbours
void learned_vertex_candidates(const learned_geometry *geometry, size_t vertex, const double ring[3],
                               double candidate[LEARNED_VERTEX_CANDIDATES][3]);
/// The candidate vectors of an edge's new vertex, from the edge's middle.
/// @param ring the mean of the weighted sums of both ends
void learned_edge_candidates(const learned_geometry *geometry, size_t edge, const double ring[3],
                             double candidate[LEARNED_EDGE_CANDIDATES][3]);

/// A move is shorter than this times the mean edge around it: a network that errs does not throw vertices far away. A fair
/// surface needs longer moves: 1/4 at fairness 0, the whole edge at fairness 1.
static inline double learned_reach(double fairness)
{
    return 0.25 / (1 - 0.75 * fairness);
}

/// The factors of moves that bound them: (1 + r^4)^(-1/4), where r is a move's length over `reach` times its size.
/// @param size the mean length of the edges around each
void learned_move_factors(size_t count, double reach, const double (*move)[3], const double *size, double *factor);
/// The mean of a geometry's sizes at both ends of an edge.
double learned_edge_size(const learned_geometry *geometry, size_t edge);

/// Four-point rule of a boundary edge, which depends on boundary vertices alone and not on their order.
void learned_boundary_point(const mesh_flaps *flaps, const double *positions, size_t edge, double point[3]);

// The network of the shipped mesh scheme. docs/algorithms/mesh-network.md describes it.
//
//     s   = relu(hidden relu(in [inputs of the vertex, state of the level before]))         each vertex
//     m   = mean of relu(self s_v + ring s_w + edge x_e)                                    its half-flaps v -> w
//     g   = relu(pool [mean s, mean m])                                                     the mesh, level 0 only
//     s'  = relu(update [s, m] + context [g, fairness])                                     each vertex
//     c_v = last relu(out s' + context)                                                     coefficients of a vertex
//     h   = relu(end (s'_i + s'_j) + opposite (s'_k + s'_l) + own x_e + context)            each edge
//     c_e = last relu(hidden h)                                                             coefficients of an edge
//
// Both levels have the same layers with weights of their own.

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

// Inference of the network in learned_network.h, without a tape. The results do not depend on the number of threads.

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

/// Pack weights with the layout of mesh_learned_make(). The result needs free() for its memory.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_learned_pack(const learn_parameters *parameters, mesh_learned *network, bat_error *error);

/// What the levels of a mesh share. Both pointers need free().
typedef struct mesh_learned_run
{
    real *state; ///< of the level before: vertices in whole tiles x LEARNED_WIDTH; null before the first; the last
                 ///< level overwrites it
    real context[LEARNED_CONTEXT];
    void *memory; ///< for the largest level: fresh memory costs more than what is computed in it
} mesh_learned_run;

/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_learned_begin(const mesh_levels *levels, mesh_learned_run *run, bat_error *error);

/// Refine a mesh by one level.
/// @param positions absolute values up to about 1
/// @param old       the number of vertices of the level before; 0 at level 0
/// @param fine      receives (vertices + edges) x 3 positions
/// @param failures  receives the number of vertices whose outputs are not finite: they stay, or lie in the edge's middle
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_learned_step(const mesh_learned *network, size_t level, const mesh_flaps *flaps, const double *positions,
                             size_t old, double fairness, int threads, mesh_learned_run *run, double *fine, size_t *failures,
                             bat_error *error);

// The learned scheme: levels by the network, boundaries by the four-point rule, creases and corners by Loop's rules.

/// The network as a row of learn/model.h, and its table.
extern const learn_network mesh_network_learned;
extern const learn_networks mesh_networks;

/// Read a model, a row's rule being a bat_mesh_rule whose context is the network.
bat_status mesh_model_read(const learn_networks *networks, const char *path, bat_mesh_model **model, bat_error *error);
