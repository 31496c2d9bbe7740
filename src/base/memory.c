#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

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

void memory_stream(double *restrict to, const double *restrict from, size_t count)
{
#if defined(__SSE2__)
    size_t i = 0;
    for (; i < count && ((uintptr_t)(to + i) & 15) != 0; i++)
        to[i] = from[i];
    for (; i + 2 <= count; i += 2)
        _mm_stream_pd(to + i, _mm_loadu_pd(from + i));
    for (; i < count; i++)
        to[i] = from[i];
    _mm_sfence();
#else
    memcpy(to, from, count * sizeof *to);
#endif
}
