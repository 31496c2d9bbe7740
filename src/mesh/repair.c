#include "batten/mesh.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/check.h"
#include "mesh/repair_steps.h"

#include <stdlib.h>
#include <string.h>

static void work_free(repair_work *work)
{
    free(work->faces);
    free(work->sources);
    free(work->sorted);
    free(work->twin);
    free(work->fan);
    free(work->origins);
    free(work->copies);
}

static bool work_begin(const bat_mesh *broken, repair_work *work)
{
    size_t half_edges = 3 * broken->face_count;
    *work = (repair_work){.mesh = broken,
                          .faces = memory_array(half_edges, sizeof *work->faces),
                          .sources = memory_array(broken->face_count, sizeof *work->sources),
                          .sorted = memory_array(half_edges, sizeof *work->sorted),
                          .twin = memory_array(half_edges, sizeof *work->twin),
                          .fan = memory_array(half_edges, sizeof *work->fan)};
    return work->faces != NULL && work->sources != NULL && work->sorted != NULL && work->twin != NULL && work->fan != NULL;
}

/// Texture coordinates stay as they are; their corners follow the faces.
static bool carry_texture(const repair_work *work, bat_mesh *made)
{
    const bat_mesh *mesh = work->mesh;
    if (mesh->texture_faces == NULL)
        return true;
    made->texture_count = mesh->texture_count;
    made->texture = memory_array(mesh->texture_count, 2 * sizeof *made->texture);
    made->texture_faces = memory_array(work->face_count, 3 * sizeof *made->texture_faces);
    if (made->texture == NULL || made->texture_faces == NULL)
        return false;
    memcpy(made->texture, mesh->texture, mesh->texture_count * 2 * sizeof *made->texture);
    for (size_t f = 0; f < work->face_count; f++)
    {
        const uint32_t *from = mesh->texture_faces + 3 * (size_t)work->sources[f];
        bool flipped = work->faces[3 * f + 1] != mesh->faces[3 * (size_t)work->sources[f] + 1];
        made->texture_faces[3 * f] = from[0];
        made->texture_faces[3 * f + 1] = from[flipped ? 2 : 1];
        made->texture_faces[3 * f + 2] = from[flipped ? 1 : 2];
    }
    return true;
}

static bool carry_channels(const repair_work *work, bat_mesh *made)
{
    const bat_mesh *mesh = work->mesh;
    size_t count = mesh->channel_count, size = count * sizeof *made->channels;
    if (count == 0)
        return true;
    made->channel_names = calloc(count, sizeof *made->channel_names);
    made->channel_count = made->channel_names != NULL ? count : 0;
    made->channels = memory_array(work->vertex_count, size);
    bool copied = made->channel_names != NULL && made->channels != NULL;
    for (size_t i = 0; i < count && copied; i++)
    {
        made->channel_names[i] = strdup(mesh->channel_names[i]);
        copied = made->channel_names[i] != NULL;
    }
    for (size_t v = 0; v < work->vertex_count && copied; v++)
        memcpy(made->channels + v * count, mesh->channels + work->origins[v] * count, size);
    return copied;
}

static bool carry_vertices(const repair_work *work, bat_mesh *made)
{
    made->vertex_count = work->vertex_count;
    made->face_count = work->face_count;
    made->positions = memory_array(work->vertex_count, 3 * sizeof *made->positions);
    made->faces = memory_array(work->face_count, 3 * sizeof *made->faces);
    if (made->positions == NULL || made->faces == NULL)
        return false;
    for (size_t v = 0; v < work->vertex_count; v++)
        memcpy(made->positions + 3 * v, work->mesh->positions + 3 * (size_t)work->origins[v], 3 * sizeof *made->positions);
    memcpy(made->faces, work->copies, work->face_count * 3 * sizeof *made->faces);
    return true;
}

static int compare_creases(const void *a, const void *b)
{
    const bat_mesh_crease *x = a, *y = b;
    if (x->a != y->a)
        return x->a < y->a ? -1 : 1;
    return (x->b > y->b) - (x->b < y->b);
}

/// The sharpest mark of every vertex, -1 for none. Null when out of memory.
static double *sharpness_of_vertices(const bat_mesh *mesh)
{
    double *sharpness = memory_array(mesh->vertex_count, sizeof *sharpness);
    for (size_t v = 0; v < mesh->vertex_count && sharpness != NULL; v++)
        sharpness[v] = -1.0;
    for (size_t i = 0; i < mesh->corner_count && sharpness != NULL; i++)
        if (mesh->corners[i].sharpness > sharpness[mesh->corners[i].vertex])
            sharpness[mesh->corners[i].vertex] = mesh->corners[i].sharpness;
    return sharpness;
}

static bool carry_corners(const repair_work *work, bat_mesh *made)
{
    if (work->mesh->corner_count == 0)
        return true;
    double *sharpness = sharpness_of_vertices(work->mesh);
    if (sharpness == NULL)
        return false;
    size_t count = 0;
    for (size_t v = 0; v < work->vertex_count; v++)
        count += sharpness[work->origins[v]] >= 0;
    made->corners = memory_array(count, sizeof *made->corners);
    for (size_t v = 0; v < work->vertex_count && made->corners != NULL; v++)
        if (sharpness[work->origins[v]] >= 0)
            made->corners[made->corner_count++] = (bat_mesh_corner){(uint32_t)v, sharpness[work->origins[v]]};
    free(sharpness);
    return made->corners != NULL;
}

/// The first place in work->sorted, whose half-edges are in the order of their edges, of an edge at or after the one of a
/// and b.
static size_t first_of_edge(const repair_work *work, uint32_t a, uint32_t b)
{
    size_t low = 0, high = 3 * work->face_count;
    while (low < high)
    {
        size_t middle = low + (high - low) / 2;
        repair_edge edge = repair_edge_of(work, work->sorted[middle]);
        if (edge.low < a || (edge.low == a && edge.high < b))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/// Append the creases that a crease becomes, one for every half-edge on it, or with `made` null only count them.
static size_t follow_crease(const repair_work *work, const bat_mesh_crease *crease, bat_mesh *made)
{
    uint32_t a = crease->a < crease->b ? crease->a : crease->b, b = crease->a < crease->b ? crease->b : crease->a;
    size_t count = 0;
    for (size_t i = first_of_edge(work, a, b); i < 3 * work->face_count; i++, count++)
    {
        uint32_t h = work->sorted[i];
        repair_edge edge = repair_edge_of(work, h);
        if (edge.low != a || edge.high != b)
            break;
        uint32_t from = work->copies[h], to = work->copies[bat_mesh_next(h)];
        if (made != NULL)
            made->creases[made->crease_count++] =
                (bat_mesh_crease){from < to ? from : to, from < to ? to : from, crease->sharpness};
    }
    return count;
}

/// Creases follow to all copies of their edges. The sharpest of several on one edge stays.
static bool carry_creases(const repair_work *work, bat_mesh *made)
{
    const bat_mesh *mesh = work->mesh;
    size_t count = 0, kept = 0;
    for (size_t i = 0; i < mesh->crease_count; i++)
        count += follow_crease(work, &mesh->creases[i], NULL);
    if (count == 0)
        return true;
    made->creases = memory_array(count, sizeof *made->creases);
    if (made->creases == NULL)
        return false;
    for (size_t i = 0; i < mesh->crease_count; i++)
        (void)follow_crease(work, &mesh->creases[i], made);
    bat_mesh_crease *creases = made->creases;
    qsort(creases, count, sizeof *creases, compare_creases);
    for (size_t i = 0; i < count; i++)
    {
        if (kept == 0 || compare_creases(&creases[kept - 1], &creases[i]) != 0)
            creases[kept++] = creases[i];
        else if (creases[i].sharpness > creases[kept - 1].sharpness)
            creases[kept - 1].sharpness = creases[i].sharpness;
    }
    made->crease_count = kept;
    return true;
}

static bat_status carry_all(const repair_work *work, bat_mesh *repaired, bat_error *error)
{
    bat_mesh made = {0};
    if (carry_vertices(work, &made) && carry_texture(work, &made) && carry_channels(work, &made) &&
        carry_corners(work, &made) && carry_creases(work, &made))
    {
        *repaired = made;
        return BAT_OK;
    }
    bat_mesh_free(&made);
    return error_memory(error, work->face_count * 3 * sizeof *made.faces);
}

bat_status bat_mesh_repair(const bat_mesh *broken, bat_mesh_repair_report *report, bat_mesh *repaired, bat_error *error)
{
    bat_mesh_repair_report done = {0};
    repair_work work = {0};
    bat_status status = mesh_check_but_degenerate(broken, error);
    if (status != BAT_OK)
        return status;
    bool room = work_begin(broken, &work) && repair_drop_faces(&work, &done);
    if (room && work.face_count == 0)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "every face has the same vertex twice");
    else if (!room || !repair_join_faces(&work, &done) || !repair_orient_faces(&work, &done) ||
             !repair_split_vertices(&work, &done))
        status = error_memory(error, 3 * broken->face_count * sizeof(uint32_t));
    if (status == BAT_OK && work.vertex_count >= BAT_MESH_NONE)
        status = error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the repaired mesh has more than %zu vertices",
                           (size_t)BAT_MESH_NONE);
    if (status == BAT_OK)
        status = carry_all(&work, repaired, error);
    if (status == BAT_OK && report != NULL)
        *report = done;
    work_free(&work);
    return status;
}

size_t bat_mesh_repair_places(const bat_mesh_repair_report *report)
{
    return report->degenerate_faces + report->duplicate_faces + report->flipped_faces + report->crowded_edges +
           report->opposed_edges + report->split_vertices;
}
