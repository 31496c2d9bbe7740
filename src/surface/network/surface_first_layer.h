#ifndef SURFACE_NETWORK_SURFACE_FIRST_LAYER_H
#define SURFACE_NETWORK_SURFACE_FIRST_LAYER_H

#include "surface/network/surface_graph.h"

/// @file
/// The first layers of src/surface/network/surface_network.h for inference: linear layer, batch normalization over all
/// edges, ReLU, and the mean over a point's edges.
///
/// Along an edge the layer says z = (W_a - W_b) x_i + W_b x_j + W_u u_j. That is linear in the numbers e = (x_i, x_j, u_j),
/// so that mean and variance of z over all edges follow from those of e. With them z normalized is a share of the target's
/// and one of the source's.

enum
{
    SURFACE_SEEN = 5,                ///< numbers of a source, at most: its place, and a boundary point's parameters
    SURFACE_SIGHT = 3 + SURFACE_SEEN ///< of an edge
};

/// The layer's parameters.
typedef struct surface_first_layer
{
    size_t seen;              ///< numbers of a source: 3 or 5
    const real *weight;       ///< SURFACE_WIDTH x (3 + seen): of x_i, x_j - x_i, u_j
    const real *gain, *shift; ///< SURFACE_WIDTH
} surface_first_layer;

/// Sums over edges of e and of its products: of `second` the lower triangle.
typedef struct surface_moments
{
    double count, first[SURFACE_SIGHT], second[SURFACE_SIGHT][SURFACE_SIGHT];
} surface_moments;

/// Add a target's edges.
/// @param sources count x seen
void surface_moments_edges(const real place[3], const real *sources, size_t seen, const uint64_t *bits, size_t words,
                           surface_moments *moments);
void surface_moments_add(const surface_moments *more, surface_moments *moments);

/// The layer with its normalization: shares . e + begin.
typedef struct surface_first_folded
{
    double shares[SURFACE_SIGHT][SURFACE_WIDTH];
    double begin[SURFACE_WIDTH];
} surface_first_folded;

/// @param moments of all edges
void surface_first_fold(const surface_first_layer *layer, const surface_moments *moments, surface_first_folded *folded);
/// What sources give.
/// @param sources count x seen
/// @param near    receives count x SURFACE_WIDTH
void surface_first_spread(const surface_first_folded *folded, const real *sources, size_t count, size_t seen, real *near);
/// The mean over a target's neighbours, 0 without any.
/// @param mean receives SURFACE_WIDTH numbers
void surface_first_mean(const surface_first_folded *folded, const real place[3], const real *near, const uint64_t *bits,
                        size_t words, uint32_t degree, real *mean);

#endif
