#include "base/ascending.h"
#include "batten/curve_measure.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The power of two that the numbers are summed up with, so that neither sums nor squares leave the range.
static double scale_for(const double *values, size_t count)
{
    double largest = 0;
    int exponent;
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(values[i]));
    if (!isfinite(largest))
        return 1;
    (void)frexp(largest, &exponent);
    return ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

bat_status bat_curve_summarize(const double *values, size_t count, bat_curve_summary *summary, bat_error *error)
{
    if (count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there are no numbers to summarize");
    for (size_t i = 0; i < count; i++)
        if (isnan(values[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "number %zu of the set is not a number", i);
    double sum = 0, squares = 0, scale = scale_for(values, count);
    for (size_t i = 0; i < count; i++)
        sum += values[i] * scale;
    double mean = sum / (double)count;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] * scale - mean) * (values[i] * scale - mean);
    double *sorted = memory_array(count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, count * sizeof *sorted);
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, ascending);
    *summary = (bat_curve_summary){.count = count,
                                   .mean = mean / scale,
                                   .deviation = sqrt(squares / (double)count) / scale,
                                   .median = sorted[(count - 1) / 2] / 2 + sorted[count / 2] / 2,
                                   .least = sorted[0],
                                   .greatest = sorted[count - 1]};
    free(sorted);
    return BAT_OK;
}
