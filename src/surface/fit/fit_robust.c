#include "surface/fit/fit_robust.h"
#include "base/ascending.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    NEIGHBOURS = 48 ///< points that share a scale
};

// The median of absolute values times this is the standard deviation of a normal distribution.
static const double NORMAL_SCALE = 1.4826;
// Where Tukey's biweight reaches zero, in scales: 95 per cent as efficient as least squares on normal noise.
static const double TUKEY_REACH = 4.685;
// No scale is below this part of the points' size: points that are met to rounding are no outliers.
static const double LEAST_SCALE = 1e-12;

/// The upper median; sorts the values.
static double median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, ascending);
    return values[count / 2];
}

static double size_of(const fit_points *points)
{
    double largest = 0;
    for (size_t k = 0; k < points->count * points->dimension; k++)
        largest = fmax(largest, fabs(points->position[k]));
    return largest;
}

static double biweight(double distance, double scale)
{
    double share = distance / (TUKEY_REACH * scale), left = 1 - share * share;
    return share < 1 ? left * left : 0;
}

bat_status fit_robust_weigh(fit_points *points, size_t *outliers, bat_error *error)
{
    double *sorted = memory_array(points->count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, points->count * sizeof *sorted);
    memcpy(sorted, points->distance, points->count * sizeof *sorted);
    double whole = fmax(NORMAL_SCALE * median(sorted, points->count), LEAST_SCALE * size_of(points));
    *outliers = 0;
    for (size_t begin = 0; begin < points->count; begin += NEIGHBOURS)
    {
        size_t end = begin + NEIGHBOURS < points->count ? begin + NEIGHBOURS : points->count;
        memcpy(sorted, points->distance + begin, (end - begin) * sizeof *sorted);
        double scale = fmax(NORMAL_SCALE * median(sorted, end - begin), whole);
        for (size_t row = begin; row < end; row++)
        {
            points->weight[row] = scale > 0 ? biweight(points->distance[row], scale) : 1;
            *outliers += points->weight[row] == 0;
        }
    }
    free(sorted);
    return BAT_OK;
}
