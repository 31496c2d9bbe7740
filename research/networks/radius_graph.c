/// @file
/// Exact radius graphs by blocked matrix products; see radius_graph.h.
///
/// With p_j = x.y_j - |y_j|^2 / 2, the test |x - y_j| <= r is  p_j >= (|x|^2 - r^2) / 2.  In floating point the test is
/// decided by p_j outside an interval that bounds the rounding error, and by a sum in double precision inside it.

#include "research/networks/radius_graph.h"

#include "base/lanes.h"
#include "research/learn/functions.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

// Sources

/// The mean of some rows, and the largest distance of a row from it.
LANES_CLONES
static void enclose(const real *rows, size_t count, size_t width, real *centre, real *reach)
{
    real farthest = 0;
    memset(centre, 0, width * sizeof *centre);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < width; c++)
            centre[c] += rows[i * width + c];
    for (size_t c = 0; c < width; c++)
        centre[c] /= (real)count;
    for (size_t i = 0; i < count; i++)
    {
        real square = 0;
#pragma omp simd reduction(+ : square)
        for (size_t c = 0; c < width; c++)
            square += (rows[i * width + c] - centre[c]) * (rows[i * width + c] - centre[c]);
        farthest = square > farthest ? square : farthest;
    }
    *reach = real_sqrt(farthest);
}

size_t surface_sources_size(size_t count, size_t width)
{
    size_t panels = learn_whole_panels(count) / LEARN_PANEL;
    return learn_packed_size(width, count) + count + panels * (width + 1);
}

surface_sources surface_sources_make(const real *points, size_t count, size_t width, real *memory)
{
    assert(width <= SURFACE_WIDTH);
    size_t columns = learn_whole_panels(count), panels = columns / LEARN_PANEL;
    real *packed_bias = memory + width * columns, *bias = memory + learn_packed_size(width, count);
    real *centres = bias + count, *reaches = centres + panels * width;
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
    // The padding of the last panel is beyond any radius.
    for (size_t j = count; j < columns; j++)
        packed_bias[j] = (real)-HUGE_VAL;
    for (size_t p = 0; p < panels; p++)
    {
        size_t first = p * LEARN_PANEL, own = count - first < LEARN_PANEL ? count - first : LEARN_PANEL;
        enclose(points + first * width, own, width, centres + p * width, &reaches[p]);
    }
    return (surface_sources){points, count, width, product, sqrt(longest), centres, reaches};
}

// Products

enum
{
    CHUNK = 1024, ///< number of sources compared at a time, so that sources and targets fit in the first caches
    PANELS = CHUNK / LEARN_PANEL
};

/// Bit mask of the products of a panel that are at least `bound`.
static inline uint32_t compare(const real *products, real bound)
{
    uint32_t bits = 0;
    for (uint32_t b = 0; b < LEARN_PANEL; b++)
        bits |= (uint32_t)(products[b] >= bound) << b;
    return bits;
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

/// Bounds of the products: at or above `surely` a source is a neighbour, below `perhaps` it is not.
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
    // The error of an inner product of n terms is at most n units of roundoff times the norms (Higham 2002, section 3.1).
    // The remaining terms bound the errors of the bias and of the bounds.
    double norm = sqrt(square), longest = sources->longest;
    double slack = epsilon * ((double)(sources->width + 2) * norm * longest + longest * longest + square + radius * radius);
    double bound = 0.5 * (square - radius * radius);
    return (bounds){(real)(bound + slack), (real)(bound - slack)};
}

/// Set the bits of one target for consecutive panels; returns the number of neighbours.
LANES_CLONES
static uint32_t find(const surface_sources *sources, const real *target, double radius, bounds b, size_t panel,
                     size_t panels, const real *products, uint64_t *bits)
{
    uint32_t degree = 0;
    for (size_t end = panel + panels; panel < end; panel++, products += LEARN_PANEL)
    {
        uint32_t open = compare(products, b.perhaps);
        if (open == 0)
            continue;
        uint32_t sure = compare(products, b.surely);
        for (open &= ~sure; open != 0; open &= open - 1)
        {
            uint32_t bit = (uint32_t)__builtin_ctz(open);
            sure |= (uint32_t)is_near(sources, target, panel * LEARN_PANEL + bit, radius) << bit;
        }
        bits[panel / 2] |= (uint64_t)sure << (panel % 2 * LEARN_PANEL);
        degree += (uint32_t)__builtin_popcount(sure);
    }
    return degree;
}

/// Which panels may contain neighbours of targets in a given ball, by their bounding balls.
LANES_CLONES
static void reach(const surface_sources *sources, const real *centre, real own_reach, double radius, size_t panel,
                  size_t panels, bool *reached)
{
    // Far above the rounding errors of distances and radii.
    const double careful = 1 + 1e-3, slack = 1e-4 * sources->longest;
    for (size_t p = 0; p < panels; p++)
    {
        const real *other = sources->centres + (panel + p) * sources->width;
        real square = 0;
#pragma omp simd reduction(+ : square)
        for (size_t c = 0; c < sources->width; c++)
            square += (centre[c] - other[c]) * (centre[c] - other[c]);
        double bound = careful * (radius + (double)own_reach + (double)sources->reaches[panel + p]) + slack;
        // NaN counts as reached.
        reached[p] = !((double)square > bound * bound);
    }
}

/// A tile of targets.
typedef struct target_tile
{
    const real *x; ///< LEARN_TILE rows, of which the first `rows` are in use
    size_t rows;
    uint64_t *bits; ///< rows x words
    uint32_t *degrees;
    bounds of[LEARN_TILE];
} target_tile;

/// Compare with the sources of consecutive panels.
static void compare_panels(const surface_sources *sources, const target_tile *tile, double radius, size_t panel,
                           size_t panels)
{
    _Alignas(64) real products[LEARN_TILE * CHUNK];
    size_t words = surface_words(sources->count), columns = panels * LEARN_PANEL;
    learn_packed part = sources->product;
    part.weight += panel * part.panel_stride;
    part.bias += panel * LEARN_PANEL;
    part.columns = columns;
    learn_packed_linear(&part, LEARN_TILE, tile->x, sources->width, products);
    for (size_t r = 0; r < tile->rows; r++)
        tile->degrees[r] += find(sources, tile->x + r * sources->width, radius, tile->of[r], panel, panels,
                                 products + r * columns, tile->bits + r * words);
}

/// Compare with the sources of a chunk whose bounding balls are within reach.
static void compare_chunk(const surface_sources *sources, const target_tile *tile, double radius, size_t panel,
                          size_t panels)
{
    real centre[SURFACE_WIDTH], own_reach;
    bool reached[PANELS];
    enclose(tile->x, tile->rows, sources->width, centre, &own_reach);
    reach(sources, centre, own_reach, radius, panel, panels, reached);
    for (size_t begin = 0, end; begin < panels; begin = end)
    {
        for (end = begin + 1; end < panels && reached[end] == reached[begin];)
            end++;
        if (reached[begin])
            compare_panels(sources, tile, radius, panel + begin, end - begin);
    }
}

void surface_neighbours(const surface_sources *sources, const real *targets, size_t rows, double radius, uint64_t *bits,
                        uint32_t *degrees)
{
    size_t width = sources->width, words = surface_words(sources->count);
    size_t panels = sources->product.columns / LEARN_PANEL;
    _Alignas(64) real last[LEARN_TILE * SURFACE_WIDTH] = {0};
    memset(bits, 0, rows * words * sizeof *bits);
    memset(degrees, 0, rows * sizeof *degrees);
    for (size_t panel = 0; panel < panels; panel += PANELS)
        for (size_t begin = 0; begin < rows; begin += LEARN_TILE)
        {
            size_t left = rows - begin;
            target_tile tile = {.x = targets + begin * width,
                                .rows = left < LEARN_TILE ? left : LEARN_TILE,
                                .bits = bits + begin * words,
                                .degrees = degrees + begin};
            if (left < LEARN_TILE)
                tile.x = memcpy(last, tile.x, left * width * sizeof *last);
            for (size_t r = 0; r < tile.rows; r++)
                tile.of[r] = bounds_of(sources, tile.x + r * width, radius);
            compare_chunk(sources, &tile, radius, panel, panels - panel < PANELS ? panels - panel : PANELS);
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
