#pragma once

#include <stdbool.h>
#include <stddef.h>

/// @file
/// Bisection of ascending arrays: the last place from `low` to `high` - 1 whose element is at most a value; `low` for none.

static inline size_t bisect_reals(const double *ascending, size_t low, size_t high, double value)
{
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        bool after = ascending[middle] <= value;
        low = after ? middle : low;
        high = after ? high : middle;
    }
    return low;
}

static inline size_t bisect_sizes(const size_t *ascending, size_t low, size_t high, size_t value)
{
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        bool after = ascending[middle] <= value;
        low = after ? middle : low;
        high = after ? high : middle;
    }
    return low;
}
