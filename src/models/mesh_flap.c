#include "models/mesh_flap.h"

#include "base/error.h"
#include "base/memory.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// Half-flaps of one mesh

static uint32_t apex(const uint32_t *faces, uint32_t half_edge)
{
    return faces[bat_mesh_previous(half_edge)];
}

static mesh_flap flap_along(const uint32_t *faces, const bat_mesh_connectivity *connectivity, uint32_t half_edge)
{
    uint32_t twin = connectivity->twin[half_edge], k = apex(faces, half_edge);
    bool whole = twin != BAT_MESH_NONE;
    return (mesh_flap){{faces[half_edge], faces[bat_mesh_next(half_edge)], k, whole ? apex(faces, twin) : k},
                       connectivity->edge[half_edge],
                       whole ? MESH_FLAP_WHOLE : MESH_FLAP_NO_RIGHT};
}

/// The half-flap that runs against a boundary's half-edge, where there is no face to the left.
static mesh_flap flap_against(const uint32_t *faces, const bat_mesh_connectivity *connectivity, uint32_t half_edge)
{
    uint32_t opposite = apex(faces, half_edge);
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

static void find_pairs(mesh_flaps *flaps)
{
    memset(flaps->of_edge, 0xff, flaps->edge_count * sizeof *flaps->of_edge);
    for (uint32_t f = 0; f < flaps->count; f++)
    {
        uint32_t *pair = flaps->of_edge[flaps->flap[f].edge];
        pair[pair[0] == BAT_MESH_NONE ? 0 : 1] = f;
    }
}

bat_status mesh_flaps_make(const uint32_t *faces, const bat_mesh_connectivity *connectivity, mesh_flaps *flaps,
                           bat_error *error)
{
    size_t vertices = connectivity->vertex_count, edges = connectivity->edge_count, count = 2 * edges;
    mesh_flaps made = {.vertex_count = vertices,
                       .edge_count = edges,
                       .count = count,
                       .flap = memory_array(count, sizeof *made.flap),
                       .first = memory_array(vertices + 1, sizeof *made.first),
                       .of_edge = memory_array(edges, sizeof *made.of_edge)};
    if (made.flap == NULL || made.first == NULL || made.of_edge == NULL)
    {
        mesh_flaps_free(&made);
        return error_memory(error, count * sizeof *made.flap);
    }
    made.first[0] = 0;
    for (size_t v = 0; v < vertices; v++)
        made.first[v + 1] = made.first[v] + flaps_around(faces, connectivity, v, made.flap + made.first[v]);
    assert(made.first[vertices] == count);
    find_pairs(&made);
    *flaps = made;
    return BAT_OK;
}

void mesh_flaps_free(mesh_flaps *flaps)
{
    free(flaps->flap);
    free(flaps->first);
    free(flaps->of_edge);
    *flaps = (mesh_flaps){0};
}

// Splitting every face in four

/// Faces with their neighbours.
typedef struct surface
{
    uint32_t *faces;
    bat_mesh_connectivity connectivity;
} surface;

static void surface_free(surface *s)
{
    free(s->faces);
    bat_mesh_connectivity_free(&s->connectivity);
    s->faces = NULL;
}

static bool surface_allocate(size_t vertices, size_t faces, surface *s)
{
    *s = (surface){.faces = memory_array(faces, 3 * sizeof *s->faces),
                   .connectivity = {.twin = memory_array(faces, 3 * sizeof(uint32_t)),
                                    .first = memory_array(vertices, sizeof(uint32_t)),
                                    .edge = memory_array(faces, 3 * sizeof(uint32_t)),
                                    .vertex_count = vertices,
                                    .face_count = faces}};
    return s->faces != NULL && s->connectivity.twin != NULL && s->connectivity.first != NULL && s->connectivity.edge != NULL;
}

static uint32_t other_corner(uint32_t corner, uint32_t turns)
{
    return (corner + turns) % 3;
}

static void split_face(const surface *coarse, uint32_t f, surface *fine)
{
    const uint32_t *corner = coarse->faces + 3 * f, *edge = coarse->connectivity.edge + 3 * f;
    uint32_t vertices = (uint32_t)coarse->connectivity.vertex_count, middle = 4 * f + 3;
    uint32_t *faces = fine->faces + 12 * f, *twin = fine->connectivity.twin + 12 * f;
    for (uint32_t c = 0; c < 3; c++)
    {
        uint32_t before = other_corner(c, 2);
        uint32_t ahead = coarse->connectivity.twin[3 * f + c], behind = coarse->connectivity.twin[3 * f + before];
        faces[3 * c] = corner[c];
        faces[3 * c + 1] = vertices + edge[c];
        faces[3 * c + 2] = vertices + edge[before];
        faces[9 + c] = vertices + edge[c];
        // The first half of an edge is the last of the twin's two halves, which ends at this corner, and the other way round.
        twin[3 * c] = ahead == BAT_MESH_NONE ? ahead : 3 * (4 * (ahead / 3) + other_corner(ahead % 3, 1)) + 2;
        twin[3 * c + 1] = 3 * middle + before;
        twin[3 * c + 2] = behind == BAT_MESH_NONE ? behind : 3 * (4 * (behind / 3) + behind % 3);
        twin[9 + before] = 3 * (4 * f + c) + 1;
    }
}

/// Number edges and choose first half-edges as bat_mesh_connect() does.
static void number_edges(surface *s)
{
    bat_mesh_connectivity *to = &s->connectivity;
    uint32_t edges = 0;
    memset(to->first, 0xff, to->vertex_count * sizeof *to->first);
    to->boundary_edge_count = 0;
    for (uint32_t h = 0; h < 3 * to->face_count; h++)
    {
        uint32_t twin = to->twin[h], *first = &to->first[s->faces[h]];
        to->edge[h] = twin < h ? to->edge[twin] : edges++;
        to->boundary_edge_count += twin == BAT_MESH_NONE;
        if (*first == BAT_MESH_NONE || twin == BAT_MESH_NONE)
            *first = h;
    }
    to->edge_count = edges;
}

static bat_status split(const surface *coarse, surface *fine, bat_error *error)
{
    const bat_mesh_connectivity *from = &coarse->connectivity;
    size_t vertices = from->vertex_count + from->edge_count;
    if (from->face_count > BAT_MESH_MOST_FACES / 4 || vertices >= BAT_MESH_NONE)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the refined mesh would have more than %zu faces",
                         BAT_MESH_MOST_FACES);
    if (!surface_allocate(vertices, 4 * from->face_count, fine))
    {
        surface_free(fine);
        return error_memory(error, 12 * from->face_count * sizeof(uint32_t));
    }
    for (uint32_t f = 0; f < from->face_count; f++)
        split_face(coarse, f, fine);
    number_edges(fine);
    return BAT_OK;
}

bat_status mesh_levels_make(const bat_mesh *mesh, const bat_mesh_connectivity *connectivity, size_t count,
                            mesh_levels *levels, bat_error *error)
{
    mesh_levels made = {.count = count, .level = calloc(count, sizeof *made.level)};
    if (made.level == NULL)
        return error_memory(error, count * sizeof *made.level);
    surface given = {mesh->faces, *connectivity}, now = given, next;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        status = mesh_flaps_make(now.faces, &now.connectivity, &made.level[i], error);
        if (status == BAT_OK)
            status = split(&now, &next, error);
        if (i > 0)
            surface_free(&now);
        if (status == BAT_OK)
            now = next;
    }
    if (status != BAT_OK)
    {
        mesh_levels_free(&made);
        return status;
    }
    made.vertex_count = now.connectivity.vertex_count;
    made.face_count = now.connectivity.face_count;
    made.faces = now.faces;
    bat_mesh_connectivity_free(&now.connectivity);
    *levels = made;
    return BAT_OK;
}

void mesh_levels_free(mesh_levels *levels)
{
    for (size_t i = 0; i < levels->count && levels->level != NULL; i++)
        mesh_flaps_free(&levels->level[i]);
    free(levels->level);
    free(levels->faces);
    *levels = (mesh_levels){0};
}
