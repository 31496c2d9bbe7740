#include "base/memory.h"

#include <stdlib.h>

void *memory_array(size_t count, size_t size)
{
    enum
    {
        CACHE_LINE = 64
    };
    size_t bytes;
    if (size_multiply_overflows(count, size, &bytes) || bytes > SIZE_MAX - CACHE_LINE)
        return NULL;
    bytes = (bytes + CACHE_LINE) / CACHE_LINE * CACHE_LINE;
    return aligned_alloc(CACHE_LINE, bytes);
}
