#pragma once

#include "base/memory.h"

#include <stdint.h>
#include <string.h>

/// The index of something with a score.
typedef struct scored
{
    double score;
    size_t index;
} scored;

/// The order of decreasing scores, for qsort(); of equal ones the lesser index is first.
static inline int larger_first(const void *a, const void *b)
{
    const scored *x = a, *y = b;
    return x->score != y->score ? ORDER_OF(y->score, x->score) : ORDER_OF(x->index, y->index);
}

/// The key of a number.
typedef size_t sort_key(const void *context, uint32_t item);

/// Sort numbers by keys below `key_count`; those of equal keys keep their order.
/// @param items  null: the numbers from 0 to count - 1
/// @param starts key_count + 1 numbers: receives where those of each key begin, and the count
static inline void counting_sort(const uint32_t *items, size_t count, sort_key *key, const void *context, size_t key_count,
                                 size_t *starts, uint32_t *sorted)
{
    memset(starts, 0, (key_count + 1) * sizeof *starts);
    for (size_t i = 0; i < count; i++)
        starts[key(context, items != NULL ? items[i] : (uint32_t)i) + 1]++;
    for (size_t k = 0; k < key_count; k++)
        starts[k + 1] += starts[k];
    for (size_t i = 0; i < count; i++)
    {
        uint32_t item = items != NULL ? items[i] : (uint32_t)i;
        sorted[starts[key(context, item)]++] = item;
    }
    // Each start has moved to the next one's place.
    memmove(starts + 1, starts, key_count * sizeof *starts);
    starts[0] = 0;
}
