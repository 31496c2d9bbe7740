// For madvise() and the number of pages.
// NOLINTBEGIN(bugprone-reserved-identifier): the C libraries' own switches
#define _DEFAULT_SOURCE
#define _DARWIN_C_SOURCE
// NOLINTEND(bugprone-reserved-identifier)

#include "base/array_grow.h"
#include "base/error.h"

#include <stdio.h>

#if defined(_WIN32)
#include <windows.h>
// What aligned_alloc() would give there, free() cannot take. The alignment serves speed alone.
#define aligned_alloc(alignment, bytes) malloc(bytes)
#else
#include <sys/mman.h>
#include <unistd.h>
#endif
#if defined(__SSE2__)
#include <immintrin.h>
#endif

void *memory_array(size_t count, size_t size)
{
    // A large array is in large pages where the system has them: entering a page costs about as much as writing it.
    static const size_t CACHE_LINE = 64, LARGE_PAGE = 2 << 20;
    size_t bytes;
    if (size_multiply_overflows(count, size, &bytes) || bytes > SIZE_MAX - LARGE_PAGE)
        return NULL;
    size_t unit = bytes < LARGE_PAGE ? CACHE_LINE : LARGE_PAGE;
    void *memory = aligned_alloc(unit, (bytes + unit) / unit * unit);
#if defined(MADV_HUGEPAGE)
    if (unit == LARGE_PAGE && memory != NULL)
        (void)madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return memory;
}

static bat_status array_set(void *pointer, void *made, size_t bytes, bat_error *error)
{
    memcpy(pointer, &made, sizeof made);
    return made != NULL ? BAT_OK : error_memory(error, bytes);
}

bat_status array_make(void *pointer, size_t count, size_t size, bat_error *error)
{
    return array_set(pointer, memory_array(count, size), count * size, error);
}

bat_status array_zeros(void *pointer, size_t count, size_t size, bat_error *error)
{
    return array_set(pointer, calloc(count > 0 ? count : 1, size), count * size, error);
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

// The system's figures: /proc/meminfo and cgroup v2 of Linux, GlobalMemoryStatusEx() of Windows, elsewhere sysconf().

/// The number after `key` at the begin of a line of a file, times `unit`; SIZE_MAX for none.
static size_t number_in_file(const char *path, const char *key, size_t unit)
{
    char line[256];
    size_t found = SIZE_MAX;
    FILE *file = fopen(path, "r");
    while (file != NULL && found == SIZE_MAX && fgets(line, sizeof line, file) != NULL)
    {
        if (strncmp(line, key, strlen(key)) != 0)
            continue;
        const char *digits = line + strlen(key);
        digits += strspn(digits, " ");
        if (*digits < '0' || *digits > '9')
            continue;
        unsigned long long number = strtoull(digits, NULL, 10);
        found = number < SIZE_MAX / unit ? (size_t)number * unit : SIZE_MAX - 1;
    }
    if (file != NULL)
        (void)fclose(file);
    return found;
}

size_t memory_available(void)
{
#if defined(__wasm__)
    // What the heap may grow to is a constant of the link.
    return SIZE_MAX - (size_t)__builtin_wasm_memory_size(0) * (1 << 16);
#endif
    static const int KIBIBYTE = 1024;
    size_t free = number_in_file("/proc/meminfo", "MemAvailable:", KIBIBYTE);
    size_t most = number_in_file("/sys/fs/cgroup/memory.max", "", 1);
    size_t used = number_in_file("/sys/fs/cgroup/memory.current", "", 1);
    if (most != SIZE_MAX && used != SIZE_MAX)
    {
        size_t left = used < most ? most - used : 0;
        free = left < free ? left : free;
    }
    if (free != SIZE_MAX)
        return free;
#if defined(_WIN32)
    MEMORYSTATUSEX status = {.dwLength = sizeof status};
    return GlobalMemoryStatusEx(&status) ? (size_t)status.ullAvailPhys : 0;
#else
    long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    return pages > 0 && size > 0 && (size_t)pages <= SIZE_MAX / (size_t)size ? (size_t)pages * (size_t)size : 0;
#endif
}

void *memory_pool_array(memory_pool *pool, size_t count, size_t size)
{
    void *arrays = pool->arrays, *made = NULL;
    bool grown = array_grow(&arrays, &pool->capacity, pool->count + 1, sizeof *pool->arrays);
    pool->arrays = arrays;
    if (grown)
        made = pool->arrays[pool->count++] = memory_array(count, size);
    if (made == NULL && pool->missing == 0)
        pool->missing = count * size > 0 ? count * size : SIZE_MAX;
    return made;
}

void *memory_pool_zeros(memory_pool *pool, size_t count, size_t size)
{
    void *made = memory_pool_array(pool, count, size);
    if (made != NULL)
        memset(made, 0, count * size);
    return made;
}

bat_status memory_pool_check(const memory_pool *pool, bat_error *error)
{
    return pool->missing == 0 ? BAT_OK : error_memory(error, pool->missing);
}

void memory_pool_free(memory_pool *pool)
{
    for (size_t k = 0; k < pool->count; k++)
        free(pool->arrays[k]);
    free(pool->arrays);
    *pool = (memory_pool){0};
}
