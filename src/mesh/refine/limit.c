#include "mesh/refine/limit.h"

/// @file
/// Limit positions of creases and corners.

typedef struct limit_job
{
    const mesh_rows *rows;
    void (*inner)(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp);
} limit_job;

static void limit_row(const limit_job *job, uint32_t vertex)
{
    const mesh_rows *rows = job->rows;
    size_t dim = rows->dim;
    const double *from = rows->from + vertex * dim;
    double *restrict to = rows->to + vertex * dim;
    sharp_vertex sharp = {.kind = SHARP_CORNER};
    if (rows->level->links->first[vertex] != BAT_MESH_NONE)
        sharpness_around(rows->level, vertex, &sharp, NULL, NULL);
    if (sharp.kind < SHARP_CREASE)
    {
        job->inner(rows, vertex, &sharp);
        return;
    }
    const double *p = rows->from + sharp.ends[0] * dim, *q = rows->from + sharp.ends[1] * dim;
    for (size_t i = 0; i < dim; i++)
        to[i] = sharp.kind == SHARP_CORNER ? from[i] : (4 * from[i] + p[i] + q[i]) / 6;
}

static void limit_range(const void *context, size_t begin, size_t end)
{
    for (size_t v = begin; v < end; v++)
        limit_row(context, (uint32_t)v);
}

void limit_rows(const mesh_rows *rows, void (*inner)(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp),
                int threads)
{
    const limit_job job = {rows, inner};
    mesh_share(limit_range, &job, rows->level->links->vertex_count, threads);
}
