#pragma once

#include <stdbool.h>
#include <stddef.h>

/// @file
/// Bisection of ascending arrays.

// NOLINTBEGIN(bugprone-macro-parentheses): names of variables

/// Move `low` to the first place before `high` where a condition on `middle` does not hold, else to `high`. It holds at
/// every place before one where it holds.
#define BISECT(low, high, middle, condition)                                                                                \
    while ((low) < (high))                                                                                                  \
    {                                                                                                                       \
        size_t middle = (low) + ((high) - (low)) / 2;                                                                       \
        bool holds = (condition);                                                                                           \
        low = holds ? middle + 1 : low;                                                                                     \
        high = holds ? high : middle;                                                                                       \
    }
// NOLINTEND(bugprone-macro-parentheses)

/// The last place from `low` to `high` - 1 whose element is at most a value; `low` for none.
static inline size_t bisect_reals(const double *ascending, size_t low, size_t high, double value)
{
    size_t end = low + 1;
    BISECT(end, high, middle, ascending[middle] <= value)
    return end - 1;
}

/// The same of sizes.
static inline size_t bisect_sizes(const size_t *ascending, size_t low, size_t high, size_t value)
{
    size_t end = low + 1;
    BISECT(end, high, middle, ascending[middle] <= value)
    return end - 1;
}
