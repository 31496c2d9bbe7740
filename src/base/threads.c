#include "base/threads.h"

#if defined(_OPENMP)

#include <pthread.h>

/// Whether OpenMP has made threads that work for this one, and whether fork() has left them behind: it copies none but the
/// thread that calls it, and OpenMP would wait for the others for ever.
static _Thread_local bool has_team, lost_team;

static void after_fork(void)
{
    if (!has_team)
        return;
    lost_team = true;
    // For libraries that ask OpenMP for the number of threads.
    omp_set_num_threads(1);
    omp_set_max_active_levels(0);
}

static void watch_forks(void)
{
    (void)pthread_atfork(NULL, NULL, after_fork);
}

int threads_of_team(int threads)
{
    static pthread_once_t watched = PTHREAD_ONCE_INIT;
    if (threads <= 1 || lost_team)
        return 1;
    (void)pthread_once(&watched, watch_forks);
    has_team = true;
    return threads;
}

#else

int threads_of_team(int threads)
{
    return 1;
}

#endif
