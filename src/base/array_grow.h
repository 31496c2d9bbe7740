#ifndef BASE_ARRAY_GROW_H
#define BASE_ARRAY_GROW_H

#include "base/memory.h"

#include <stdlib.h>

/// Make room in a malloc() array for `needed` elements of `size` bytes, at least doubling it when it must move. False when
/// out of memory, the array then being as it was.
static inline bool array_grow(void **array, size_t *capacity, size_t needed, size_t size)
{
    enum
    {
        FIRST_CAPACITY = 16
    };
    if (needed <= *capacity)
        return true;
    size_t wanted = *capacity < FIRST_CAPACITY ? FIRST_CAPACITY : *capacity;
    while (wanted < needed)
    {
        if (wanted > SIZE_MAX / 2)
            return false;
        wanted *= 2;
    }
    size_t bytes;
    if (size_multiply_overflows(wanted, size, &bytes))
        return false;
    void *moved = realloc(*array, bytes);
    if (moved == NULL)
        return false;
    *array = moved;
    *capacity = wanted;
    return true;
}

#endif
