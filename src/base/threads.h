#ifndef BASE_THREADS_H
#define BASE_THREADS_H

#include <stdbool.h>
#include <stddef.h>

#if defined(_OPENMP)
#include <omp.h>
#endif

enum
{
    /// More threads than this are never made, unless the machine has more processors: they would gain nothing.
    THREADS_LIMIT = 64
};

/// The number of threads for `work` independent pieces: `wanted`, or as many as OpenMP gives when 0 or below, and no more than
/// pieces.
static inline int threads_for(int wanted, size_t work)
{
#if defined(_OPENMP)
    int threads = wanted > 0 ? wanted : omp_get_max_threads();
    int limit = omp_get_num_procs() > THREADS_LIMIT ? omp_get_num_procs() : THREADS_LIMIT;
    threads = threads > limit ? limit : threads;
    return (size_t)threads > work ? (int)(work > 0 ? work : 1) : threads;
#else
    (void)wanted;
    (void)work;
    return 1;
#endif
}

/// The number of this thread among those that share work, from 0.
static inline int threads_current(void)
{
#if defined(_OPENMP)
    return omp_get_thread_num();
#else
    return 0;
#endif
}

/// Whether this is the thread that made the call, the one that may report progress.
static inline bool threads_is_calling(void)
{
    return threads_current() == 0;
}

#endif
