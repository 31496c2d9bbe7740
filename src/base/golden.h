#pragma once

#include <stdbool.h>

/// @file
/// The minimum of a function by golden sections.

/// A bracket, and the place in it whose value is wanted next.
typedef struct golden_search
{
    double low, high, at;
    double places[2], values[2]; ///< inside
    int known, next;             ///< values that are there; which of both is wanted
} golden_search;

static inline double golden_place(const golden_search *search, int which)
{
    static const double GOLDEN = 0.6180339887498949;
    double part = GOLDEN * (search->high - search->low);
    return which == 0 ? search->high - part : search->low + part;
}

static inline golden_search golden_begin(double low, double high)
{
    golden_search search = {.low = low, .high = high};
    search.places[0] = search.at = golden_place(&search, 0);
    search.places[1] = golden_place(&search, 1);
    return search;
}

/// Tell the value at the place: the bracket shrinks from the second value on.
static inline void golden_tell(golden_search *search, double value)
{
    search->values[search->next] = value;
    if (++search->known == 1)
    {
        search->next = 1;
        search->at = search->places[1];
        return;
    }
    int better = search->values[0] <= search->values[1] ? 0 : 1, other = 1 - better;
    *(better == 0 ? &search->high : &search->low) = search->places[other];
    search->places[other] = search->places[better];
    search->values[other] = search->values[better];
    search->places[better] = search->at = golden_place(search, better);
    search->next = better;
}
