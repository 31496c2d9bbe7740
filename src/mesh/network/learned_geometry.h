#ifndef MESH_NETWORK_LEARNED_GEOMETRY_H
#define MESH_NETWORK_LEARNED_GEOMETRY_H

#include "learn/real.h"
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

/// The geometry of a level. Release it with learned_geometry_free().
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
    void *memory;                       ///< of all, or null where it is another's
} learned_geometry;

/// Compute the geometry.
/// @param positions absolute values between 0 and about 1, so that no product overflows
/// @return BAT_OK or BAT_NO_MEMORY; `geometry` is untouched on failure
bat_status learned_geometry_make(const mesh_flaps *flaps, const double *positions, int threads, learned_geometry *geometry,
                                 bat_error *error);
/// The memory that a geometry takes, in bytes.
size_t learned_geometry_size(size_t vertices, size_t edges);
/// Compute the geometry in memory of learned_geometry_size() bytes, aligned to 8, which stays the caller's.
learned_geometry learned_geometry_in(const mesh_flaps *flaps, const double *positions, int threads, void *memory);
/// Compute the inputs of a vertex.
/// @param old the first `old` vertices are those of the level before; 0 at the first level
/// @param row LEARNED_VERTEX_INPUTS
void learned_vertex_inputs(const learned_geometry *geometry, size_t old, size_t vertex, real *row);
void learned_geometry_free(learned_geometry *geometry);

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

/// The factors of moves that bound them: (1 + r^4)^(-1/4), where r is a move's length over `reach` times its size. Moves of
/// half that length lose a hundredth.
/// @param size the mean length of the edges around each
void learned_move_factors(size_t count, double reach, const double (*move)[3], const double *size, double *factor);
/// The mean of a geometry's sizes at both ends of an edge.
double learned_edge_size(const learned_geometry *geometry, size_t edge);

/// Four-point rule of a boundary edge, which depends on boundary vertices alone and not on their order.
void learned_boundary_point(const mesh_flaps *flaps, const double *positions, size_t edge, double point[3]);

#endif
