#include "mesh/refine/level.h"

#include "base/threads.h"

void mesh_share(mesh_range *range, const void *job, size_t count, int threads)
{
    enum
    {
        LEAST = 16384, ///< elements a thread that are worth waking one
        RANGES_A_THREAD = 8
    };
    int team = threads_for(threads, count / LEAST + 1);
    size_t ranges = team == 1 ? 1 : (size_t)team * RANGES_A_THREAD;
    size_t each = count / ranges, rest = count % ranges;
#pragma omp parallel for num_threads(team) schedule(dynamic)
    for (size_t i = 0; i < ranges; i++)
    {
        size_t begin = i * each + (i < rest ? i : rest);
        range(job, begin, begin + each + (i < rest));
    }
}
