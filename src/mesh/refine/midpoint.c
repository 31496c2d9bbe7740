#include "mesh/refine/level.h"

#include <string.h>

/// The new vertices of some faces' edges.
static void middle_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    const mesh_level *level = rows->level;
    const bat_mesh_connectivity *links = level->links;
    size_t dim = rows->dim;
    for (uint32_t h = (uint32_t)(3 * begin); h < 3 * end; h++)
    {
        if (!mesh_owns(links->twin, h))
            continue;
        const double *a = rows->from + level->faces[h] * dim, *b = rows->from + mesh_end(level->faces, h) * dim;
        double *to = rows->to + (links->vertex_count + links->edge[h]) * dim;
        for (size_t i = 0; i < dim; i++)
            to[i] = 0.5 * (a[i] + b[i]);
    }
}

void midpoint_rule(const mesh_rows *rows, int threads)
{
    const bat_mesh_connectivity *links = rows->level->links;
    memcpy(rows->to, rows->from, links->vertex_count * rows->dim * sizeof *rows->to);
    mesh_share(middle_range, rows, links->face_count, threads);
}
