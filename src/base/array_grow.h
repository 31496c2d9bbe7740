#pragma once

#include "base/memory.h"

#include <string.h>

/// Make room in a malloc() array for `needed` elements of `size` bytes, doubling it where it moves. False: it is as it was.
static inline bool array_grow(void **array, size_t *capacity, size_t needed, size_t size)
{
    static const int FIRST_CAPACITY = 16;
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

/// array_grow() for the address of a pointer to any type; all pointers to objects have one size in POSIX.
static inline bool array_grow_at(void *pointer, size_t *capacity, size_t needed, size_t size)
{
    void *array;
    memcpy(&array, pointer, sizeof array);
    bool grown = array_grow(&array, capacity, needed, size);
    memcpy(pointer, &array, sizeof array);
    return grown;
}

/// Make room for `needed` elements in the array that the variable `array` points to. False when out of memory.
#define ARRAY_GROW(array, capacity, needed) array_grow_at(&(array), &(capacity), needed, sizeof *(array))

/// Append an element to an array of `count` elements. False when out of memory.
#define ARRAY_ADD(array, capacity, count, ...)                                                                              \
    (ARRAY_GROW(array, capacity, (count) + 1) && ((array)[(count)++] = __VA_ARGS__, true))
