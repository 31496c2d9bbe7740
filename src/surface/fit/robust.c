/// @file
/// Tukey's biweight; see robust.h.

#include "surface/fit/robust.h"

#include "base/ascending.h"
#include "batten/surface_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
