#include "mesh/measure/edge_groups.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static uint32_t lesser_end(const uint32_t *faces, uint32_t half_edge)
{
    uint32_t a = faces[half_edge], b = faces[bat_mesh_next(half_edge)];
    return a < b ? a : b;
}

static uint32_t greater_end(const uint32_t *faces, uint32_t half_edge)
{
    uint32_t a = faces[half_edge], b = faces[bat_mesh_next(half_edge)];
    return a < b ? b : a;
}

/// Sort half-edges by one of their ends, keeping the order of those at the same vertex (counting sort). `from` null stands
/// for the order of their numbers; `room` has space for a number for each vertex and one more.
static void sort_by(uint32_t (*end)(const uint32_t *, uint32_t), const bat_mesh *mesh, const uint32_t *from, uint32_t *to,
                    uint32_t *room)
{
    uint32_t count = (uint32_t)(3 * mesh->face_count);
    memset(room, 0, (mesh->vertex_count + 1) * sizeof *room);
    for (uint32_t h = 0; h < count; h++)
        room[end(mesh->faces, h) + 1]++;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        room[v + 1] += room[v];
    for (uint32_t i = 0; i < count; i++)
    {
        uint32_t h = from == NULL ? i : from[i];
        to[room[end(mesh->faces, h)]++] = h;
    }
}

/// Where edges begin in the sorted half-edges.
static void mark_edges(const bat_mesh *mesh, edge_groups *groups)
{
    uint32_t count = (uint32_t)(3 * mesh->face_count), edges = 0;
    for (uint32_t i = 0; i < count; i++)
    {
        uint32_t h = groups->order[i], before = i > 0 ? groups->order[i - 1] : h;
        if (i == 0 || lesser_end(mesh->faces, h) != lesser_end(mesh->faces, before) ||
            greater_end(mesh->faces, h) != greater_end(mesh->faces, before))
            groups->begin[edges++] = i;
    }
    groups->begin[edges] = count;
    groups->count = edges;
}

bat_status edge_groups_make(const bat_mesh *mesh, edge_groups *groups, bat_error *error)
{
    size_t half_edges = 3 * mesh->face_count;
    edge_groups made = {.order = memory_array(half_edges, sizeof *made.order),
                        .begin = memory_array(half_edges + 1, sizeof *made.begin)};
    uint32_t *room = memory_array(mesh->vertex_count + 1, sizeof *room);
    if (made.order == NULL || made.begin == NULL || room == NULL)
    {
        free(room);
        edge_groups_free(&made);
        return error_memory(error, half_edges * sizeof *made.order);
    }
    sort_by(greater_end, mesh, NULL, made.begin, room);
    sort_by(lesser_end, mesh, made.begin, made.order, room);
    mark_edges(mesh, &made);
    free(room);
    *groups = made;
    return BAT_OK;
}

void edge_groups_free(edge_groups *groups)
{
    free(groups->order);
    free(groups->begin);
    *groups = (edge_groups){0};
}

void sets_begin(uint32_t *parent, size_t count)
{
    for (size_t i = 0; i < count; i++)
        parent[i] = (uint32_t)i;
}

uint32_t sets_find(uint32_t *parent, uint32_t item)
{
    while (parent[item] != item)
    {
        parent[item] = parent[parent[item]];
        item = parent[item];
    }
    return item;
}

void sets_join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = sets_find(parent, a);
    b = sets_find(parent, b);
    // The lesser number leads its set.
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}
