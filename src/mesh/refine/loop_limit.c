#include "mesh/refine/loop.h"

#include "mesh/refine/sharpness.h"

#include <math.h>

// Limit positions are the left eigenvectors to the eigenvalue 1 of the matrices that take a vertex and its neighbours to
// those of the next level (Loop 1987; at creases, cubic B-splines).

/// How much of their sum each neighbour has in the limit of a smooth vertex.
static double limit_ring_weight(unsigned valence)
{
    return 1 / (valence + 3 / (8 * loop_ring_weight(valence)));
}

/// Limit weights around a dart, whose sharp edge leads to neighbour 0. With b = loop_ring_weight() the eigenvector obeys
/// 5 w_i - w_(i-1) - w_(i+1) = 8 b for 0 < i < n without w_0 and w_n, and w_0 = 2 b + (w_1 + w_(n-1)) / 4, where the vertex
/// has 1.
typedef struct dart_weights
{
    unsigned valence;
    double ring, total;
} dart_weights;

static double dart_weight(const dart_weights *dart, unsigned i)
{
    const double root = (5 - sqrt(21)) / 2;
    if (i == 0)
        return 2 * dart->ring + dart_weight(dart, 1) / 2;
    double there = pow(root, i), back = pow(root, dart->valence - i), around = pow(root, dart->valence);
    return 8 * dart->ring / 3 * (1 - (there + back) / (1 + around));
}

static dart_weights dart_make(unsigned valence)
{
    dart_weights dart = {valence, loop_ring_weight(valence), 1};
    for (unsigned i = 0; i < valence; i++)
        dart.total += dart_weight(&dart, i);
    return dart;
}

static unsigned valence_of(const bat_mesh_connectivity *links, uint32_t vertex)
{
    uint32_t first = links->first[vertex], h = first;
    unsigned valence = 0;
    do
    {
        valence++;
        h = bat_mesh_next_around(links, h);
    } while (h != BAT_MESH_NONE && h != first);
    return valence;
}

/// The half-edge from a vertex to a neighbour of it.
static uint32_t half_edge_to(const mesh_level *level, uint32_t vertex, uint32_t neighbour)
{
    uint32_t h = level->links->first[vertex];
    while (mesh_end(level->faces, h) != neighbour)
        h = bat_mesh_next_around(level->links, h);
    return h;
}

static void inner_limit(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp)
{
    const mesh_level *level = rows->level;
    size_t dim = rows->dim;
    bool is_dart = sharp->kind == SHARP_DART;
    unsigned valence = valence_of(level->links, vertex);
    dart_weights dart = is_dart ? dart_make(valence) : (dart_weights){0};
    double ring = is_dart ? 0 : limit_ring_weight(valence);
    double own = is_dart ? 1 / dart.total : 1 - valence * ring;
    uint32_t h = is_dart ? half_edge_to(level, vertex, sharp->ends[0]) : level->links->first[vertex];
    const double *from = rows->from + vertex * dim;
    double *restrict to = rows->to + vertex * dim;
    for (size_t i = 0; i < dim; i++)
        to[i] = own * from[i];
    for (unsigned n = 0; n < valence; n++)
    {
        const double *neighbour = rows->from + mesh_end(level->faces, h) * dim;
        double weight = is_dart ? dart_weight(&dart, n) / dart.total : ring;
        for (size_t i = 0; i < dim; i++)
            to[i] += weight * neighbour[i];
        h = bat_mesh_next_around(level->links, h);
    }
}

static void limit_row(const mesh_rows *rows, uint32_t vertex)
{
    size_t dim = rows->dim;
    const double *from = rows->from + vertex * dim;
    double *restrict to = rows->to + vertex * dim;
    sharp_vertex sharp = {.kind = SHARP_CORNER};
    if (rows->level->links->first[vertex] != BAT_MESH_NONE)
        sharpness_around(rows->level, vertex, &sharp, NULL, NULL);
    if (sharp.kind < SHARP_CREASE)
    {
        inner_limit(rows, vertex, &sharp);
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

void loop_limit(const mesh_rows *rows, int threads)
{
    mesh_share(limit_range, rows, rows->level->links->vertex_count, threads);
}
