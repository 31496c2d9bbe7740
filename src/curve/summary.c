#include "batten/measure.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bat_status bat_summarize(const double *values, size_t count, bat_summary *summary, bat_error *error)
{
    if (count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there are no numbers to summarize");
    double sum = 0, squares = 0;
    for (size_t i = 0; i < count; i++)
    {
        if (isnan(values[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "number %zu of the set is not a number", i);
        sum += values[i];
    }
    double mean = sum / (double)count;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] - mean) * (values[i] - mean);
    double *sorted = memory_array(count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, count * sizeof *sorted);
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_numbers);
    *summary = (bat_summary){.count = count,
                             .mean = mean,
                             .deviation = sqrt(squares / (double)count),
                             .median = (sorted[(count - 1) / 2] + sorted[count / 2]) / 2,
                             .least = sorted[0],
                             .greatest = sorted[count - 1]};
    free(sorted);
    return BAT_OK;
}
