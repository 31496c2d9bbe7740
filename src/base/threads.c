#include "base/threads.h"

#if defined(_OPENMP)

#include <pthread.h>
#include <stdlib.h>

/// How many threads OpenMP has made for this one, and whether fork() has left them behind: it copies none but the thread
/// that calls it, and OpenMP would wait for the others for ever.
static _Thread_local int team;
static _Thread_local bool lost_team;

static void after_fork(void)
{
    if (team == 0)
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

/// Whether stacks of so many threads fit into the memory that the process may have. Without, OpenMP would end the process.
static bool has_room(int threads)
{
    static const size_t STACK = 9 << 20;                     // usual size and a reserve
    void *volatile stacks = malloc((size_t)threads * STACK); // volatile: compilers drop a block without a use
    free(stacks);
    return stacks != NULL;
}

int threads_of_team(int threads)
{
    static pthread_once_t watched = PTHREAD_ONCE_INIT;
    if (threads <= 1 || lost_team || (threads > team && !has_room(threads)))
        return 1;
    (void)pthread_once(&watched, watch_forks);
    team = threads > team ? threads : team;
    return threads;
}

#else

int threads_of_team(int threads)
{
    return 1;
}

#endif
