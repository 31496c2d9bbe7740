#include "batten/mesh.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/check.h"
#include "mesh/point_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Merging of vertices that coincide or, with a distance, lie near an earlier vertex that remains.

/// Find the welded vertex of every vertex. `kept` receives the vertices that remain.
static bool find_targets(const bat_mesh *mesh, double distance, uint32_t *target, uint32_t *kept, size_t *kept_count)
{
    point_table table = {.points = mesh->positions, .cell = distance};
    bool room = point_table_reserve(&table, mesh->vertex_count);
    *kept_count = 0;
    for (uint32_t v = 0; v < mesh->vertex_count && room; v++)
    {
        const double *position = mesh->positions + 3 * (size_t)v;
        uint32_t other = distance > 0 ? point_table_near(&table, position) : point_table_find(&table, position);
        if (other != BAT_MESH_NONE)
        {
            target[v] = target[other];
            continue;
        }
        target[v] = (uint32_t)*kept_count;
        kept[(*kept_count)++] = v;
        room = point_table_add(&table, v);
    }
    point_table_free(&table);
    return room;
}

/// Replace the vertices of a copied mesh, in place. The remaining vertices keep their order.
static void move_vertices(bat_mesh *mesh, const uint32_t *target, const uint32_t *kept, size_t kept_count)
{
    size_t channels = mesh->channel_count;
    for (size_t v = 0; v < kept_count; v++)
    {
        memmove(mesh->positions + 3 * v, mesh->positions + 3 * (size_t)kept[v], 3 * sizeof *mesh->positions);
        if (channels > 0)
            memmove(mesh->channels + channels * v, mesh->channels + channels * kept[v], channels * sizeof *mesh->channels);
    }
    mesh->vertex_count = kept_count;
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        mesh->faces[i] = target[mesh->faces[i]];
    for (size_t i = 0; i < mesh->corner_count; i++)
        mesh->corners[i].vertex = target[mesh->corners[i].vertex];
    size_t creases = 0;
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        bat_mesh_crease crease = mesh->creases[i];
        uint32_t a = target[crease.a], b = target[crease.b];
        if (a != b)
            mesh->creases[creases++] = (bat_mesh_crease){a, b, crease.sharpness};
    }
    mesh->crease_count = creases;
}

bat_status bat_mesh_weld(const bat_mesh *mesh, double distance, size_t *merged, bat_mesh *welded, bat_error *error)
{
    if (!(distance >= 0) || !isfinite(distance))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the distance of welding is %g", distance);
    bat_status status = mesh_check_except_degenerate(mesh, error);
    if (status != BAT_OK)
        return status;
    size_t count = mesh->vertex_count, kept_count = 0;
    uint32_t *target = memory_array(count, sizeof *target), *kept = memory_array(count, sizeof *kept);
    bat_mesh made = {0};
    if (target == NULL || kept == NULL || !find_targets(mesh, distance, target, kept, &kept_count))
        status = error_memory(error, count * sizeof *target);
    if (status == BAT_OK)
        status = bat_mesh_copy(mesh, &made, error);
    if (status == BAT_OK)
    {
        move_vertices(&made, target, kept, kept_count);
        *welded = made;
        if (merged != NULL)
            *merged = count - kept_count;
    }
    free(target);
    free(kept);
    return status;
}
