#include "mesh/refine/brake.h"

#include "base/memory.h"

/// A plane of the lattice has this share of the root of the number of vertices, and this many.
static const double PLANE_SHARE = 0.2, PLANE_VERTICES = 4;
/// Shares of edges within a cell, of vertices with just two coordinates on planes, and with the third along each axis. Boxes
/// and stairs have three, height fields have one axis.
static const double NEARLY_ALL = 0.9, MOST = 0.6, SOME = 0.05;

typedef struct coordinate
{
    double value; // the first member: ascending() compares it
    uint32_t vertex;
} coordinate;

/// Find where vertices are along an axis.
/// @param sorted workspace, one for each vertex
/// @param slabs  three for each vertex; receives 2 i on plane i, 2 i + 1 between it and the next
static void find_slabs(const bat_mesh *mesh, size_t axis, double tolerance, coordinate *sorted, uint32_t *slabs)
{
    double least = fmax(PLANE_VERTICES, PLANE_SHARE * sqrt((double)mesh->vertex_count));
    uint32_t slab = 0, count = (uint32_t)mesh->vertex_count;
    for (uint32_t v = 0; v < count; v++)
        sorted[v] = (coordinate){mesh->positions[3 * (size_t)v + axis], v};
    qsort(sorted, count, sizeof *sorted, ascending);
    for (uint32_t begin = 0, i = 0; i < count; i++)
    {
        if (i + 1 < count && sorted[i + 1].value - sorted[i].value <= tolerance)
            continue;
        bool plane = i + 1 - begin >= least;
        slab += plane ? 2 : 0;
        for (; begin <= i; begin++)
            slabs[3 * (size_t)sorted[begin].vertex + axis] = slab + !plane;
    }
}

static bool is_marched(const bat_mesh *mesh, const uint32_t *slabs)
{
    double along[3] = {0}, within = 0, n = (double)mesh->vertex_count;
    for (const uint32_t *at = slabs; at < slabs + 3 * mesh->vertex_count; at += 3)
    {
        uint32_t off = at[0] % 2 + at[1] % 2 + at[2] % 2;
        along[at[0] % 2 ? 0 : at[1] % 2 ? 1 : 2] += off == 1;
    }
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
    {
        const uint32_t *a = slabs + 3 * (size_t)mesh->faces[h], *b = slabs + 3 * (size_t)mesh_end(mesh->faces, h);
        size_t c = 0;
        while (c < 3 && (a[c] < b[c] ? b[c] <= a[c] + 2 - a[c] % 2 : a[c] <= b[c] + 2 - b[c] % 2))
            c++;
        within += c == 3;
    }
    double two = along[0] + along[1] + along[2], least = fmin(along[0], fmin(along[1], along[2]));
    return two >= MOST * n && least >= SOME * n && within >= NEARLY_ALL * 3 * (double)mesh->face_count;
}

bat_status lattice_find(const bat_mesh *mesh, double equal, bool *found, bat_error *error)
{
    memory_pool pool = {0};
    coordinate *sorted = memory_pool_array(&pool, mesh->vertex_count, sizeof *sorted);
    uint32_t *slabs = memory_pool_array(&pool, mesh->vertex_count, 3 * sizeof *slabs);
    bat_status status = memory_pool_check(&pool, error);
    for (size_t axis = 0; axis < 3 && status == BAT_OK; axis++)
        find_slabs(mesh, axis, equal, sorted, slabs);
    *found = status == BAT_OK && is_marched(mesh, slabs);
    memory_pool_free(&pool);
    return status;
}
