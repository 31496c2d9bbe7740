#ifndef SURFACE_NETWORK_RADIUS_GRAPH_H
#define SURFACE_NETWORK_RADIUS_GRAPH_H

#include "learn/packed.h"

#include <stdbool.h>
#include <stdint.h>

/// @file
/// Exact radius graphs of points in space or of rows of features: which *sources* lie within a radius of which *targets*,
/// the radius itself included, without a bound on neighbours. A target's neighbours are a row of bits.
///
/// Distances come from a matrix product, |x - y|^2 = |x|^2 + |y|^2 - 2 x.y. Where its rounding could decide, the differences
/// are squared and summed in double precision instead, so that the graph is that of the numbers as they are.

enum
{
    SURFACE_WIDTH = 64, ///< of features
    SURFACE_WORD = 64   ///< sources in a word of bits
};

/// A few features at once: compilers make what the machine has of it.
typedef real surface_lanes __attribute__((vector_size(64), aligned(sizeof(real)), may_alias));
/// What comparisons of them give: all bits of a lane or none.
typedef __typeof__((surface_lanes){0} > (surface_lanes){0}) surface_mask;
enum
{
    SURFACE_LANES = sizeof(surface_lanes) / sizeof(real),
    SURFACE_VECTORS = SURFACE_WIDTH / SURFACE_LANES ///< of a row of features
};

static inline size_t surface_words(size_t sources)
{
    return (sources + SURFACE_WORD - 1) / SURFACE_WORD;
}

/// Sources laid out for the product. Those of a panel (learn/packed.h) lie in a ball; targets that it is too far from are
/// not compared with them, so that sources in an order in which near ones follow each other are looked at faster.
typedef struct surface_sources
{
    const real *points; ///< count x width, not copied
    size_t count, width;
    learn_packed product; ///< x.y - |y|^2 / 2
    double longest;       ///< the largest norm
    const real *centres;  ///< panels x width
    const real *reaches;  ///< of the balls: one a panel
} surface_sources;

/// Numbers that hold sources.
size_t surface_sources_size(size_t count, size_t width);
/// @param width  at most SURFACE_WIDTH
/// @param memory surface_sources_size() numbers, aligned to 64 bytes
surface_sources surface_sources_make(const real *points, size_t count, size_t width, real *memory);

/// The neighbours of a run of targets.
/// @param targets rows x sources->width
/// @param bits    receives rows x surface_words(sources->count); bits behind the last source are 0
/// @param degrees receives how many neighbours each has
void surface_neighbours(const surface_sources *sources, const real *targets, size_t rows, double radius, uint64_t *bits,
                        uint32_t *degrees);

/// Sums of features by words, for surface_sum(): words x SURFACE_WIDTH.
/// @param features count x SURFACE_WIDTH
void surface_word_sums(const real *features, size_t count, real *sums);
/// The sum of the features of one target's neighbours. Where most of a word's bits are set, what is not is taken off the
/// word's sum.
/// @param sum receives SURFACE_WIDTH numbers
void surface_sum(const uint64_t *bits, const real *features, size_t count, const real *word_sums, real *sum);

#endif
