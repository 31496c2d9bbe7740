#include "models/surface_graph.h"

#include "base/lanes.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

// Products

size_t surface_sources_size(size_t count, size_t width)
{
    return learn_packed_size(width, count) + count;
}

surface_sources surface_sources_make(const real *points, size_t count, size_t width, real *memory)
{
    assert(width <= SURFACE_WIDTH);
    size_t columns = learn_whole_panels(count);
    real *bias = memory + learn_packed_size(width, count), *packed_bias = memory + width * columns;
    double longest = 0;
    for (size_t j = 0; j < count; j++)
    {
        double square = 0;
        for (size_t c = 0; c < width; c++)
            square += (double)points[j * width + c] * (double)points[j * width + c];
        bias[j] = (real)(-0.5 * square);
        longest = fmax(longest, square);
    }
    learn_packed product = learn_pack(width, count, points, width, bias, memory);
    // Nothing is near what fills up the last panel.
    for (size_t j = count; j < columns; j++)
        packed_bias[j] = (real)-HUGE_VAL;
    return (surface_sources){points, count, width, product, sqrt(longest)};
}

enum
{
    CHUNK = 1024, ///< sources that targets are compared with together, so that both stay in the nearest caches
    CHUNK_WORDS = CHUNK / SURFACE_WORD
};

/// Which of the next `count` products, a multiple of 32, are not below a bound.
static inline void compare(size_t count, const real *restrict products, real bound, uint32_t *restrict bits)
{
    for (size_t begin = 0; begin < count; begin += 32)
    {
        uint32_t word = 0;
        for (uint32_t b = 0; b < 32; b++)
            word |= (uint32_t)(products[begin + b] >= bound) << b;
        bits[begin / 32] = word;
    }
}

static bool is_near(const surface_sources *sources, const real *target, size_t source, double radius)
{
    const real *point = sources->points + source * sources->width;
    double square = 0;
    for (size_t c = 0; c < sources->width; c++)
    {
        double difference = (double)target[c] - (double)point[c];
        square += difference * difference;
    }
    return square <= radius * radius;
}

/// Products from which a target's neighbours are to be told: all of `surely` and above are, none below `perhaps`.
typedef struct bounds
{
    real surely, perhaps;
} bounds;

static bounds bounds_of(const surface_sources *sources, const real *target, double radius)
{
    const double epsilon = sizeof(real) == sizeof(float) ? (double)FLT_EPSILON : DBL_EPSILON;
    double square = 0;
    for (size_t c = 0; c < sources->width; c++)
        square += (double)target[c] * (double)target[c];
    // The error of a sum of products is at most as many roundings of the norms' product (Higham 2002, section 3.1); then that of the bias
    // and of the bounds themselves.
    double norm = sqrt(square), longest = sources->longest;
    double slack = epsilon * ((double)(sources->width + 2) * norm * longest + longest * longest + square + radius * radius);
    double bound = 0.5 * (square - radius * radius);
    return (bounds){(real)(bound + slack), (real)(bound - slack)};
}

/// The bits of one target among a chunk's sources; returns how many.
LANES_CLONES
static uint32_t find(const surface_sources *sources, const real *target, double radius, size_t first, size_t columns,
                     const real *products, uint64_t *bits)
{
    bounds b = bounds_of(sources, target, radius);
    uint32_t degree = 0, surely[2 * CHUNK_WORDS] = {0}, perhaps[2 * CHUNK_WORDS] = {0};
    compare(columns, products, b.surely, surely);
    compare(columns, products, b.perhaps, perhaps);
    for (size_t w = 0; w < (columns + SURFACE_WORD - 1) / SURFACE_WORD; w++)
    {
        uint64_t sure = surely[2 * w] | (uint64_t)surely[2 * w + 1] << 32;
        uint64_t open = (perhaps[2 * w] | (uint64_t)perhaps[2 * w + 1] << 32) & ~sure;
        for (; open != 0; open &= open - 1)
        {
            size_t bit = (size_t)__builtin_ctzll(open);
            sure |= (uint64_t)is_near(sources, target, first + w * SURFACE_WORD + bit, radius) << bit;
        }
        bits[w] = sure;
        degree += (uint32_t)__builtin_popcountll(sure);
    }
    return degree;
}

/// The part of a layer that begins at a column, a multiple of the panel's.
static learn_packed columns_of(const learn_packed *layer, size_t first, size_t columns)
{
    learn_packed part = *layer;
    part.weight += first / LEARN_PANEL * layer->panel_stride;
    part.bias += first;
    part.columns = columns;
    return part;
}

void surface_neighbours(const surface_sources *sources, const real *targets, size_t rows, double radius, uint64_t *bits,
                        uint32_t *degrees)
{
    size_t width = sources->width, words = surface_words(sources->count), all = sources->product.columns;
    _Alignas(64) real tile[LEARN_TILE * SURFACE_WIDTH] = {0}, products[LEARN_TILE * CHUNK];
    memset(degrees, 0, rows * sizeof *degrees);
    for (size_t first = 0; first < all; first += CHUNK)
    {
        size_t columns = all - first < CHUNK ? all - first : CHUNK;
        learn_packed part = columns_of(&sources->product, first, columns);
        for (size_t begin = 0; begin < rows; begin += LEARN_TILE)
        {
            size_t count = rows - begin < LEARN_TILE ? rows - begin : LEARN_TILE;
            const real *x = targets + begin * width;
            if (count < LEARN_TILE)
                x = memcpy(tile, x, count * width * sizeof *tile);
            learn_packed_linear(&part, LEARN_TILE, x, width, products);
            for (size_t r = 0; r < count; r++)
                degrees[begin + r] += find(sources, x + r * width, radius, first, columns, products + r * columns,
                                           bits + (begin + r) * words + first / SURFACE_WORD);
        }
    }
}

// Sums of features

LANES_CLONES
static void word_sums_of(const real *features, size_t count, real *sums)
{
    memset(sums, 0, surface_words(count) * SURFACE_WIDTH * sizeof *sums);
    for (size_t j = 0; j < count; j++)
    {
        const real *restrict from = features + j * SURFACE_WIDTH;
        real *restrict to = sums + j / SURFACE_WORD * SURFACE_WIDTH;
        for (size_t c = 0; c < SURFACE_WIDTH; c++)
            to[c] += from[c];
    }
}

void surface_word_sums(const real *features, size_t count, real *sums)
{
    word_sums_of(features, count, sums);
}

LANES_CLONES
static void sum_of(const uint64_t *bits, const real *features, size_t count, const real *word_sums, real *sum)
{
    surface_lanes total[SURFACE_VECTORS];
    for (size_t v = 0; v < SURFACE_VECTORS; v++)
        total[v] = (surface_lanes){0};
    for (size_t w = 0; w < surface_words(count); w++)
    {
        const real *rows = features + w * SURFACE_WORD * SURFACE_WIDTH;
        uint64_t word = bits[w];
        if (__builtin_popcountll(word) <= SURFACE_WORD / 2 || (w + 1) * SURFACE_WORD > count)
        {
            for (; word != 0; word &= word - 1)
            {
                const real *row = rows + (size_t)__builtin_ctzll(word) * SURFACE_WIDTH;
                for (size_t v = 0; v < SURFACE_VECTORS; v++)
                    total[v] += *(const surface_lanes *)(row + v * SURFACE_LANES);
            }
            continue;
        }
        for (size_t v = 0; v < SURFACE_VECTORS; v++)
            total[v] += *(const surface_lanes *)(word_sums + w * SURFACE_WIDTH + v * SURFACE_LANES);
        for (word = ~word; word != 0; word &= word - 1)
        {
            const real *row = rows + (size_t)__builtin_ctzll(word) * SURFACE_WIDTH;
            for (size_t v = 0; v < SURFACE_VECTORS; v++)
                total[v] -= *(const surface_lanes *)(row + v * SURFACE_LANES);
        }
    }
    for (size_t v = 0; v < SURFACE_VECTORS; v++)
        *(surface_lanes *)(sum + v * SURFACE_LANES) = total[v];
}

void surface_sum(const uint64_t *bits, const real *features, size_t count, const real *word_sums, real *sum)
{
    sum_of(bits, features, count, word_sums, sum);
}
