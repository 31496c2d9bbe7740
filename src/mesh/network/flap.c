#include "mesh/network/flap.h"

#include "mesh/refine/level.h"

#include <assert.h>
#include <string.h>

/// @file
/// Half-flaps from connectivity, on a mesh and on its refinements.

// Half-flaps of one mesh

static mesh_flap flap_along(const uint32_t *faces, const bat_mesh_connectivity *connectivity, uint32_t half_edge)
{
    uint32_t twin = connectivity->twin[half_edge], k = mesh_opposite(faces, half_edge);
    bool whole = twin != BAT_MESH_NONE;
    return (mesh_flap){{faces[half_edge], faces[bat_mesh_next(half_edge)], k, whole ? mesh_opposite(faces, twin) : k},
                       connectivity->edge[half_edge],
                       whole ? MESH_FLAP_WHOLE : MESH_FLAP_NO_RIGHT};
}

/// The half-flap opposite to a boundary half-edge, which has no left face.
static mesh_flap flap_against(const uint32_t *faces, const bat_mesh_connectivity *connectivity, uint32_t half_edge)
{
    uint32_t opposite = mesh_opposite(faces, half_edge);
    return (mesh_flap){{faces[bat_mesh_next(half_edge)], faces[half_edge], opposite, opposite},
                       connectivity->edge[half_edge],
                       MESH_FLAP_NO_LEFT};
}

/// Write the half-flaps that begin at a vertex; returns their number.
static uint32_t flaps_around(const uint32_t *faces, const bat_mesh_connectivity *connectivity, size_t vertex,
                             mesh_flap *flap)
{
    uint32_t first = connectivity->first[vertex], h = first, count = 0;
    if (first == BAT_MESH_NONE)
        return 0;
    for (;;)
    {
        flap[count++] = flap_along(faces, connectivity, h);
        uint32_t next = bat_mesh_next_around(connectivity, h);
        if (next == BAT_MESH_NONE)
            flap[count++] = flap_against(faces, connectivity, bat_mesh_previous(h));
        if (next == BAT_MESH_NONE || next == first)
            return count;
        h = next;
    }
}

/// Find the half-flaps of a mesh, in arrays of the pool.
/// @return BAT_OK or BAT_NO_MEMORY; `flaps` is untouched on failure
static bat_status mesh_flaps_make(const uint32_t *faces, const bat_mesh_connectivity *connectivity, memory_pool *pool,
                                  mesh_flaps *flaps, bat_error *error)
{
    size_t vertices = connectivity->vertex_count, edges = connectivity->edge_count, count = 2 * edges;
    mesh_flaps made = {.vertex_count = vertices,
                       .edge_count = edges,
                       .count = count,
                       .flap = memory_pool_array(pool, count, sizeof *made.flap),
                       .first = memory_pool_array(pool, vertices + 1, sizeof *made.first),
                       .of_edge = memory_pool_array(pool, edges, sizeof *made.of_edge)};
    bat_status status = memory_pool_check(pool, error);
    if (status != BAT_OK)
        return status;
    made.first[0] = 0;
    for (size_t v = 0; v < vertices; v++)
        made.first[v + 1] = made.first[v] + flaps_around(faces, connectivity, v, made.flap + made.first[v]);
    assert(made.first[vertices] == count);
    memset(made.of_edge, 0xff, made.edge_count * sizeof *made.of_edge);
    for (uint32_t f = 0; f < made.count; f++)
    {
        uint32_t *pair = made.of_edge[made.flap[f].edge];
        pair[pair[0] == BAT_MESH_NONE ? 0 : 1] = f;
    }
    *flaps = made;
    return BAT_OK;
}

// Levels

bat_status mesh_levels_make(const uint32_t *faces, const bat_mesh_connectivity *connectivity, size_t count, int threads,
                            mesh_levels *levels, bat_error *error)
{
    mesh_levels made = {.count = count};
    made.level = memory_pool_array(&made.pool, count, sizeof *made.level);
    split_mesh now = {0};
    bat_status status = memory_pool_check(&made.pool, error);
    if (status == BAT_OK)
        status = mesh_flaps_make(faces, connectivity, &made.pool, &made.level[0], error);
    for (size_t i = 1; i < count && status == BAT_OK; i++)
    {
        status = split_mesh_make(faces, connectivity, threads, &now, error);
        faces = now.faces;
        connectivity = &now.links;
        if (status == BAT_OK)
            status = mesh_flaps_make(faces, connectivity, &made.pool, &made.level[i], error);
    }
    split_mesh_free(&now);
    if (status != BAT_OK)
    {
        mesh_levels_free(&made);
        return status;
    }
    made.vertex_count = made.level[count - 1].vertex_count + made.level[count - 1].edge_count;
    *levels = made;
    return BAT_OK;
}

void mesh_levels_free(mesh_levels *levels)
{
    memory_pool_free(&levels->pool);
    *levels = (mesh_levels){0};
}
