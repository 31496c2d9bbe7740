#include "surface/network/surface_first_layer.h"

#include "base/lanes.h"
#include "learn/row_statistics.h"

#include <math.h>

enum
{
    W = SURFACE_WIDTH
};

// Moments

void surface_moments_edges(const real place[3], const real *sources, size_t seen, const uint64_t *bits, size_t words,
                           surface_moments *moments)
{
    double count = 0, sum[SURFACE_SEEN] = {0};
    for (size_t w = 0; w < words; w++)
        for (uint64_t word = bits[w]; word != 0; word &= word - 1)
        {
            const real *source = sources + (w * SURFACE_WORD + (size_t)__builtin_ctzll(word)) * seen;
            count++;
            for (size_t a = 0; a < seen; a++)
            {
                sum[a] += (double)source[a];
                for (size_t b = 0; b <= a; b++)
                    moments->second[3 + a][3 + b] += (double)source[a] * (double)source[b];
            }
        }
    moments->count += count;
    for (size_t a = 0; a < 3; a++)
    {
        moments->first[a] += count * (double)place[a];
        for (size_t b = 0; b <= a; b++)
            moments->second[a][b] += count * (double)place[a] * (double)place[b];
    }
    for (size_t a = 0; a < seen; a++)
    {
        moments->first[3 + a] += sum[a];
        for (size_t b = 0; b < 3; b++)
            moments->second[3 + a][b] += sum[a] * (double)place[b];
    }
}

void surface_moments_add(const surface_moments *more, surface_moments *moments)
{
    moments->count += more->count;
    for (size_t a = 0; a < SURFACE_SIGHT; a++)
    {
        moments->first[a] += more->first[a];
        for (size_t b = 0; b <= a; b++)
            moments->second[a][b] += more->second[a][b];
    }
}

/// The mean of e over all edges, and its covariance; zero without edges.
static void find_covariance(const surface_moments *moments, double mean[SURFACE_SIGHT],
                            double covariance[SURFACE_SIGHT][SURFACE_SIGHT])
{
    double share = moments->count > 0 ? 1 / moments->count : 0;
    for (size_t a = 0; a < SURFACE_SIGHT; a++)
        mean[a] = share * moments->first[a];
    for (size_t a = 0; a < SURFACE_SIGHT; a++)
        for (size_t b = 0; b <= a; b++)
            covariance[a][b] = covariance[b][a] = share * moments->second[a][b] - mean[a] * mean[b];
}

// The layer

void surface_first_fold(const surface_first_layer *layer, const surface_moments *moments, surface_first_folded *folded)
{
    size_t sight = 3 + layer->seen;
    double mean[SURFACE_SIGHT], covariance[SURFACE_SIGHT][SURFACE_SIGHT];
    find_covariance(moments, mean, covariance);
    for (size_t c = 0; c < W; c++)
    {
        const real *weight = layer->weight + c * sight;
        double w[SURFACE_SIGHT], middle = 0, variance = 0;
        for (size_t a = 0; a < sight; a++)
        {
            w[a] = (double)weight[a] - (a < 3 ? (double)weight[a + 3] : 0);
            middle += w[a] * mean[a];
            for (size_t b = 0; b < a; b++)
                variance += 2 * w[a] * covariance[a][b] * w[b];
            variance += w[a] * covariance[a][a] * w[a];
        }
        double rate = (double)layer->gain[c] / sqrt(fmax(variance, 0) + (double)NORMALIZATION_EPSILON);
        folded->begin[c] = (double)layer->shift[c] - rate * middle;
        for (size_t a = 0; a < sight; a++)
            folded->shares[a][c] = rate * w[a];
    }
}

LANES_CLONES
static void add_share(double number, const double *restrict shares, double *restrict sum)
{
    for (size_t c = 0; c < W; c++)
        sum[c] += number * shares[c];
}

void surface_first_spread(const surface_first_folded *folded, const real *sources, size_t count, size_t seen, real *near)
{
    for (size_t j = 0; j < count; j++)
    {
        double sum[W] = {0};
        for (size_t a = 0; a < seen; a++)
            add_share((double)sources[j * seen + a], folded->shares[3 + a], sum);
        for (size_t c = 0; c < W; c++)
            near[j * W + c] = (real)sum[c];
    }
}

/// The sum over neighbours of max(0, begin + near_j).
LANES_CLONES
static void sum_messages(const uint64_t *bits, size_t words, const real *near, const real *begin, real *sum)
{
    surface_lanes total[SURFACE_VECTORS], own[SURFACE_VECTORS];
    for (size_t v = 0; v < SURFACE_VECTORS; v++)
    {
        total[v] = (surface_lanes){0};
        own[v] = *(const surface_lanes *)(begin + v * SURFACE_LANES);
    }
    for (size_t w = 0; w < words; w++)
        for (uint64_t word = bits[w]; word != 0; word &= word - 1)
        {
            const real *row = near + (w * SURFACE_WORD + (size_t)__builtin_ctzll(word)) * W;
            for (size_t v = 0; v < SURFACE_VECTORS; v++)
            {
                surface_lanes z = own[v] + *(const surface_lanes *)(row + v * SURFACE_LANES);
                total[v] += (surface_lanes)((z > (surface_lanes){0}) & (surface_mask)z);
            }
        }
    for (size_t v = 0; v < SURFACE_VECTORS; v++)
        *(surface_lanes *)(sum + v * SURFACE_LANES) = total[v];
}

void surface_first_mean(const surface_first_folded *folded, const real place[3], const real *near, const uint64_t *bits,
                        size_t words, uint32_t degree, real *mean)
{
    double own[W];
    real begin[W];
    for (size_t c = 0; c < W; c++)
        own[c] = folded->begin[c];
    for (size_t a = 0; a < 3; a++)
        add_share((double)place[a], folded->shares[a], own);
    for (size_t c = 0; c < W; c++)
        begin[c] = (real)own[c];
    sum_messages(bits, words, near, begin, mean);
    for (size_t c = 0; c < W && degree > 0; c++)
        mean[c] /= (real)degree;
}
