#include "mesh/refine/level.h"

#include "base/threads.h"

#include <string.h>

/// @file
/// Distribution of loops over threads, and linear interpolation on split meshes.

void mesh_share(mesh_range *range, const void *job, size_t count, int threads)
{
    enum
    {
        MIN_ELEMENTS = 16384, ///< elements for which another thread pays
        RANGES_A_THREAD = 8
    };
    int team = threads_for(threads, count / MIN_ELEMENTS + 1);
    size_t ranges = team == 1 ? 1 : (size_t)team * RANGES_A_THREAD;
    size_t each = count / ranges, rest = count % ranges;
#pragma omp parallel for num_threads(team) schedule(dynamic)
    for (size_t i = 0; i < ranges; i++)
    {
        size_t begin = i * each + (i < rest ? i : rest);
        range(job, begin, begin + each + (i < rest));
    }
}

/// Compute the midpoints of the edges that some faces own.
static void middle_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    const mesh_level *level = rows->level;
    const bat_mesh_connectivity *links = level->links;
    const mesh_sides *sides = &level->sides;
    size_t dim = rows->dim;
    uint32_t last = sides_begin(sides, (uint32_t)end);
    for (uint32_t h = sides_begin(sides, (uint32_t)begin); h < last; h++)
    {
        if (!mesh_owns(links->twin, h))
            continue;
        const double *a = rows->from + level->faces[h] * dim, *b = rows->from + level->faces[sides_next(sides, h)] * dim;
        middle_row(a, b, rows->to + (links->vertex_count + links->edge[h]) * dim, dim);
    }
}

void midpoint_rule(const mesh_rows *rows, int threads)
{
    const bat_mesh_connectivity *links = rows->level->links;
    memcpy(rows->to, rows->from, links->vertex_count * rows->dim * sizeof *rows->to);
    mesh_share(middle_range, rows, links->face_count, threads);
}
