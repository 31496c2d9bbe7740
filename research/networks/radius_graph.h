#ifndef RESEARCH_NETWORKS_RADIUS_GRAPH_H
#define RESEARCH_NETWORKS_RADIUS_GRAPH_H

#include "learn/packed.h"

#include <stdbool.h>
#include <stdint.h>

/// @file
/// Exact radius graphs of points in space or of feature vectors: the *sources* y_j with |x_i - y_j| <= r for every *target*
/// x_i. The neighbours of a target are a row of bits; their number is not bounded.
///
/// Distances come from a matrix product, |x - y|^2 = |x|^2 + |y|^2 - 2 x.y. Where rounding could decide, the sum of squared
/// differences in double precision decides instead, so that the graph is that of the given numbers.

enum
{
    SURFACE_WIDTH = 64, ///< width of a feature vector
    SURFACE_WORD = 64   ///< sources for each word of bits
};

/// A vector of features for SIMD arithmetic; the compiler maps it to the registers of the machine.
typedef real surface_lanes __attribute__((vector_size(64), aligned(sizeof(real)), may_alias));
/// The result of a comparison of vectors: all bits of a lane set, or none.
typedef __typeof__((surface_lanes){0} > (surface_lanes){0}) surface_mask;
enum
{
    SURFACE_LANES = sizeof(surface_lanes) / sizeof(real),
    SURFACE_VECTORS = SURFACE_WIDTH / SURFACE_LANES ///< vectors for one feature vector
};

static inline size_t surface_words(size_t sources)
{
    return (sources + SURFACE_WORD - 1) / SURFACE_WORD;
}

/// Sources packed for the matrix product. Each panel (learn/packed.h) has a bounding ball; targets beyond the radius of the
/// ball skip the panel. Sources in a spatially coherent order are therefore faster.
typedef struct surface_sources
{
    const real *points; ///< count x width, not copied
    size_t count, width;
    learn_packed product; ///< x.y - |y|^2 / 2
    double longest;       ///< the largest norm of a source
    const real *centres;  ///< panels x width: centres of the bounding balls
    const real *reaches;  ///< panels: their radii
} surface_sources;

/// The size of the memory for sources, in numbers.
size_t surface_sources_size(size_t count, size_t width);
/// Pack sources.
/// @param width  at most SURFACE_WIDTH
/// @param memory surface_sources_size() numbers, aligned to 64 bytes
surface_sources surface_sources_make(const real *points, size_t count, size_t width, real *memory);

/// Find the neighbours of consecutive targets.
/// @param targets rows x sources->width
/// @param bits    receives rows x surface_words(sources->count); bits beyond the last source are 0
/// @param degrees receives the number of neighbours of each target
void surface_neighbours(const surface_sources *sources, const real *targets, size_t rows, double radius, uint64_t *bits,
                        uint32_t *degrees);

/// Sums of the feature vectors of every word of sources, for surface_sum().
/// @param features count x SURFACE_WIDTH
/// @param sums     receives words x SURFACE_WIDTH
void surface_word_sums(const real *features, size_t count, real *sums);
/// The sum of the feature vectors of a target's neighbours. If most bits of a word are set, the missing ones are subtracted
/// from the sum of the word.
/// @param sum receives SURFACE_WIDTH numbers
void surface_sum(const uint64_t *bits, const real *features, size_t count, const real *word_sums, real *sum);

#endif
