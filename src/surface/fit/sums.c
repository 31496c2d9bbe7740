/// @file
/// Sums over the points of all processes of a fit; see points.h. All of it is collection on rank 0 and broadcast from there,
/// so that every sum has one order.

#include "surface/fit/points.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "batten/surface_fit.h"
#include "surface/fit/loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bat_status fit_sum_rows(const bat_group *group, const double *rows, size_t count, size_t width, double *sums,
                        bat_error *error)
{
    size_t *sizes = NULL, all_rows = count;
    char *all = NULL;
    bat_status status = BAT_OK;
    memset(sums, 0, width * sizeof *sums);
    if (group_count(group) > 1)
    {
        all_rows = 0;
        status = group_gather(group, rows, count * width * sizeof *rows, &sizes, &all, error);
        for (size_t rank = 0; status == BAT_OK && all != NULL && rank < group_count(group); rank++)
            all_rows += sizes[rank] / (width * sizeof *rows);
        rows = (const double *)(const void *)all;
    }
    for (size_t row = 0; status == BAT_OK && row < all_rows; row++)
        for (size_t k = 0; k < width; k++)
            sums[k] += rows[row * width + k];
    free(sizes);
    free(all);
    return status == BAT_OK ? group_broadcast(group, 0, sums, width * sizeof *sums, error) : status;
}

bat_status fit_sum_points(const bat_group *group, size_t points, fit_terms *terms, const void *context, size_t width,
                          int threads, double *sums, bat_error *error)
{
    size_t blocks = fit_blocks(points);
    double *rows = calloc(blocks * width + 1, sizeof *rows);
    if (rows == NULL)
        return error_memory(error, blocks * width * sizeof *rows);
#pragma omp parallel for schedule(static) num_threads(threads_worth(threads, blocks, 10 * (double)points))
    for (size_t block = 0; block < blocks; block++)
    {
        double own[FIT_TERMS] = {0};
        size_t begin = block * BAT_SURFACE_FIT_BLOCK, end = begin + BAT_SURFACE_FIT_BLOCK;
        for (size_t row = begin; row < end && row < points; row++)
            terms(context, row, own);
        memcpy(rows + block * width, own, width * sizeof *own);
    }
    bat_status status = fit_sum_rows(group, rows, blocks, width, sums, error);
    free(rows);
    return status;
}

bat_status fit_select(const bat_group *group, const double *values, size_t count, uint64_t place, double *selected,
                      bat_error *error)
{
    enum
    {
        DIGIT = 16, ///< bits that one pass decides
        SIZE = 1 << DIGIT
    };
    // The bits of doubles that are not negative have the order of their values.
    uint64_t known = 0, *counts = memory_array(SIZE, sizeof *counts);
    if (counts == NULL)
        return error_memory(error, SIZE * sizeof *counts);
    bat_status status = BAT_OK;
    for (int shift = 64 - DIGIT; shift >= 0 && status == BAT_OK; shift -= DIGIT)
    {
        memset(counts, 0, SIZE * sizeof *counts);
        for (size_t i = 0; i < count; i++)
        {
            uint64_t bits;
            memcpy(&bits, &values[i], sizeof bits);
            if (shift == 64 - DIGIT || bits >> (shift + DIGIT) == known)
                counts[bits >> shift & (SIZE - 1)]++;
        }
        status = group_sum_counts(group, counts, SIZE, error);
        uint64_t digit = 0;
        while (digit < SIZE - 1 && place >= counts[digit])
            place -= counts[digit++];
        known = known << DIGIT | digit;
    }
    memcpy(selected, &known, sizeof known);
    free(counts);
    return status;
}

// Tukey's biweight.

enum
{
    NEIGHBOURS = 48 ///< consecutive points in Morton order that share a scale
};

// Ratio of the standard deviation to the median absolute value of a normal distribution.
static const double NORMAL_SCALE = 1.4826;
// Tuning constant of Tukey's biweight: 95 per cent efficiency for normally distributed noise.
static const double TUKEY_REACH = 4.685;
// Lower bound of the scale, as a fraction of the size of the point set: residuals of rounding size are no outliers.
static const double MIN_SCALE = 1e-12;

/// The upper median. Sorts the values.
static double median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, ascending);
    return values[count / 2];
}

static double biweight(double distance, double scale)
{
    double share = distance / (TUKEY_REACH * scale), left = 1 - share * share;
    return share < 1 ? left * left : 0;
}

bat_status fit_robust_weights(fit_points *points, double size, size_t *outliers, bat_error *error)
{
    double sorted[NEIGHBOURS], middle;
    bat_status status = fit_select(points->group, points->distance, points->count, points->total / 2, &middle, error);
    if (status != BAT_OK)
        return status;
    double global = fmax(NORMAL_SCALE * middle, MIN_SCALE * size);
    uint64_t found = 0;
    for (size_t begin = 0; begin < points->count; begin += NEIGHBOURS)
    {
        size_t end = begin + NEIGHBOURS < points->count ? begin + NEIGHBOURS : points->count;
        memcpy(sorted, points->distance + begin, (end - begin) * sizeof *sorted);
        double scale = fmax(NORMAL_SCALE * median(sorted, end - begin), global);
        for (size_t row = begin; row < end; row++)
        {
            if (points->number[row] >= points->own)
                continue;
            points->weight[row] = scale > 0 ? biweight(points->distance[row], scale) : 1;
            found += points->weight[row] == 0;
        }
    }
    status = group_sum_counts(points->group, &found, 1, error);
    *outliers = (size_t)found;
    return status;
}

_Static_assert(BAT_SURFACE_FIT_BLOCK % NEIGHBOURS == 0, "neighbours are of one block");
