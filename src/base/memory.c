// For madvise().
// NOLINTNEXTLINE(bugprone-reserved-identifier): the C library's own switch
#define _DEFAULT_SOURCE

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

#if defined(__linux__)
#include <sys/mman.h>
#endif
#if defined(__SSE2__)
#include <immintrin.h>
#endif

/// A large array in large pages where the system has them: entering a page costs about as much as writing it.
static void *large_array(size_t bytes)
{
    enum
    {
        LARGE_PAGE = 2 << 20
    };
    void *memory = bytes <= SIZE_MAX - LARGE_PAGE
                       ? aligned_alloc(LARGE_PAGE, (bytes + LARGE_PAGE - 1) / LARGE_PAGE * LARGE_PAGE)
                       : NULL;
#if defined(MADV_HUGEPAGE)
    if (memory != NULL)
        (void)madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return memory;
}

void *memory_array(size_t count, size_t size)
{
    enum
    {
        CACHE_LINE = 64,
        LARGE = 2 << 20 ///< bytes
    };
    size_t bytes;
    if (size_multiply_overflows(count, size, &bytes) || bytes > SIZE_MAX - CACHE_LINE)
        return NULL;
    bytes = (bytes + CACHE_LINE) / CACHE_LINE * CACHE_LINE;
    return bytes < LARGE ? aligned_alloc(CACHE_LINE, bytes) : large_array(bytes);
}

#if defined(__SSE2__)
/// Whole cache lines, `count` a multiple of 8, `to` aligned to 64 bytes.
__attribute__((target("avx512f"))) static void stream_lines_512(double *restrict to, const double *restrict from,
                                                                size_t count)
{
    for (size_t i = 0; i < count; i += 8)
        _mm512_stream_pd(to + i, _mm512_loadu_pd(from + i));
}

static void stream_lines_128(double *restrict to, const double *restrict from, size_t count)
{
    for (size_t i = 0; i < count; i += 2)
        _mm_stream_pd(to + i, _mm_loadu_pd(from + i));
}
#endif

void memory_stream(double *restrict to, const double *restrict from, size_t count)
{
    size_t done = 0;
#if defined(__SSE2__)
    while (done < count && ((uintptr_t)(to + done) & 63) != 0)
    {
        to[done] = from[done];
        done++;
    }
    size_t lines = (count - done) / 8 * 8;
    if (__builtin_cpu_supports("avx512f"))
        stream_lines_512(to + done, from + done, lines);
    else
        stream_lines_128(to + done, from + done, lines);
    done += lines;
#endif
    memcpy(to + done, from + done, (count - done) * sizeof *to);
}

void memory_stream_end(void)
{
#if defined(__SSE2__)
    _mm_sfence();
#endif
}
