#pragma once

#include <stdbool.h>
#include <stddef.h>

#if defined(_OPENMP)
#include <omp.h>
#endif

enum
{
    /// More threads than this are never made, unless the machine has more processors: they would gain nothing.
    THREADS_LIMIT = 64,
    /// Arithmetic operations, some milliseconds of them, that are worth a thread.
    THREADS_WORTH = 5000000
};

/// The number of threads that this thread can share work with, when it asks for `threads`: 1 without memory for their
/// stacks, and in a process made by fork(), if the thread had shared work before. Any parallel region must take its number
/// from here, by threads_for().
int threads_of_team(int threads);

/// The number of threads for `work` independent pieces: `wanted`, or OpenMP's where this is 0 or below; at most `work`.
static inline int threads_for(int wanted, size_t work)
{
#if defined(_OPENMP)
    int threads = wanted > 0 ? wanted : omp_get_max_threads();
    if (threads > THREADS_LIMIT && threads > omp_get_num_procs()) // which asks the system
        threads = omp_get_num_procs() > THREADS_LIMIT ? omp_get_num_procs() : THREADS_LIMIT;
    return threads_of_team((size_t)threads > work ? (int)(work > 0 ? work : 1) : threads);
#else
    (void)wanted;
    (void)work;
    return 1;
#endif
}

/// The number of threads for pieces that take so many arithmetic operations in all, roughly. Who wants a number gets it as
/// from threads_for(). Otherwise short work is not shared: threads wait for each other by spinning, and where other programs
/// have the processors they wait for a time slice, which is longer than the work.
static inline int threads_worth(int wanted, size_t pieces, double operations)
{
    double most = operations / THREADS_WORTH;
    if (wanted <= 0 && most < (double)pieces)
        pieces = most > 1 ? (size_t)most : 1;
    return threads_for(wanted, pieces);
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
