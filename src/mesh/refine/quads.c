#include "mesh/refine/quads.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>

/// @file
/// Children of polygons, half-edges and edges, in parallel and without search.

typedef struct quads_job
{
    mesh_sides sides;
    const uint32_t *faces;
    const bat_mesh_connectivity *links;
    uint32_t *fine_faces;
    bat_mesh_connectivity *fine;
} quads_job;

static inline void face_quads(const quads_job *job, uint32_t face, uint32_t begin, uint32_t count)
{
    const uint32_t *edge = job->links->edge + begin;
    uint32_t first_edge = (uint32_t)job->links->vertex_count;
    uint32_t centre = first_edge + (uint32_t)job->links->edge_count + face;
    uint32_t *fine = job->fine_faces + 4 * (size_t)begin;
    for (uint32_t c = 0; c < count; c++)
    {
        fine[4 * c] = job->faces[begin + c];
        fine[4 * c + 1] = first_edge + edge[c];
        fine[4 * c + 2] = centre;
        fine[4 * c + 3] = first_edge + edge[c > 0 ? c - 1 : count - 1];
    }
}

static void faces_range(const void *context, size_t begin, size_t end)
{
    const quads_job *job = context;
    for (uint32_t f = (uint32_t)begin; f < end; f++)
        if (job->sides.quads)
            face_quads(job, f, 4 * f, 4);
        else
            face_quads(job, f, sides_begin(&job->sides, f), sides_begin(&job->sides, f + 1) - sides_begin(&job->sides, f));
}

void quads_faces(const mesh_sides *sides, const uint32_t *faces, const bat_mesh_connectivity *links, int threads,
                 uint32_t *fine)
{
    quads_job job = {.sides = *sides, .faces = faces, .links = links, .fine_faces = fine};
    mesh_share(faces_range, &job, links->face_count, threads);
}

/// The first half-edges of the face's vertex and of the vertices on the edges that it owns, as sides_connect() chooses them.
static inline void write_first(const quads_job *job, uint32_t face, uint32_t begin, uint32_t count)
{
    const bat_mesh_connectivity *links = job->links;
    uint32_t *first = job->fine->first + links->vertex_count;
    first[links->edge_count + face] = 4 * begin + 2;
    for (uint32_t h = begin; h < begin + count; h++)
    {
        uint32_t next = h + 1 < begin + count ? h + 1 : begin, other = links->twin[h];
        if (other > h)
            first[links->edge[h]] = other == BAT_MESH_NONE || next < h ? 4 * next + 3 : 4 * h + 1;
    }
}

/// The half-edge of the next level along the far half of a half-edge.
static inline uint32_t far_half(const mesh_sides *sides, uint32_t half_edge, bool quads)
{
    if (quads)
        return 4 * (half_edge % 4 == 3 ? half_edge - 3 : half_edge + 1) + 3;
    return 4 * sides_next(sides, half_edge) + 3;
}

/// Write the twins of the half-edges in the quads of a face.
static inline void face_twins(const quads_job *job, uint32_t begin, uint32_t count, bool quads)
{
    const uint32_t *twin = job->links->twin + begin;
    uint32_t *restrict fine = job->fine->twin + 4 * (size_t)begin;
    for (uint32_t c = 0; c < count; c++)
    {
        uint32_t previous = c > 0 ? c - 1 : count - 1, other = twin[c], before = twin[previous];
        fine[4 * c] = other == BAT_MESH_NONE ? other : far_half(&job->sides, other, quads);
        fine[4 * c + 1] = 4 * (begin + (c + 1 < count ? c + 1 : 0)) + 2;
        fine[4 * c + 2] = 4 * (begin + previous) + 1;
        fine[4 * c + 3] = before == BAT_MESH_NONE ? before : 4 * before;
    }
}

/// Number the edges in the quads of a face by their smaller half-edges, on both sides of those that the face owns. Before
/// them come the inner edges of earlier faces, one for each corner, and both halves of the `*owned` edges that those own.
static inline void face_edges(const quads_job *job, uint32_t begin, uint32_t count, uint32_t *owned, bool quads)
{
    const uint32_t *twin = job->links->twin;
    uint32_t *restrict fine = job->fine->edge;
    uint32_t number = begin + 2 * *owned, last = begin + count - 1;
    for (uint32_t h = begin; h <= last; h++)
    {
        uint32_t previous = h > begin ? h - 1 : last, other = twin[h], before = twin[previous];
        if (other > h)
        {
            if (other != BAT_MESH_NONE)
                fine[far_half(&job->sides, other, quads)] = number;
            fine[4 * (size_t)h] = number++;
            ++*owned;
        }
        if (h < last)
            fine[4 * (size_t)h + 1] = fine[4 * (size_t)h + 6] = number++;
        if (h == begin)
            fine[4 * (size_t)h + 2] = fine[4 * (size_t)last + 1] = number++;
        if (before > previous)
        {
            if (before != BAT_MESH_NONE)
                fine[4 * (size_t)before] = number;
            fine[4 * (size_t)h + 3] = number++;
        }
    }
}

static inline void face_links(const quads_job *job, uint32_t face, uint32_t *owned, bool quads)
{
    uint32_t begin = quads ? 4 * face : sides_begin(&job->sides, face);
    uint32_t count = quads ? 4 : sides_begin(&job->sides, face + 1) - begin;
    face_twins(job, begin, count, quads);
    face_edges(job, begin, count, owned, quads);
    if (job->fine->first != NULL)
        write_first(job, face, begin, count);
}

/// The number of edges that the faces before a face own.
static uint32_t owned_before_face(const quads_job *job, size_t face)
{
    const bat_mesh_connectivity *links = job->links;
    uint32_t corners = sides_corners(&job->sides, links->face_count);
    for (uint32_t h = sides_begin(&job->sides, (uint32_t)face); h < corners; h++)
        if (mesh_owns(links->twin, h))
            return links->edge[h];
    return (uint32_t)links->edge_count;
}

static void links_range(const void *context, size_t begin, size_t end)
{
    const quads_job *job = context;
    uint32_t owned = owned_before_face(job, begin);
    for (uint32_t f = (uint32_t)begin; f < end; f++)
        if (job->sides.quads)
            face_links(job, f, &owned, true);
        else
            face_links(job, f, &owned, false);
}

static void first_range(const void *context, size_t begin, size_t end)
{
    const quads_job *job = context;
    for (size_t v = begin; v < end; v++)
    {
        uint32_t first = job->links->first[v];
        job->fine->first[v] = first == BAT_MESH_NONE ? first : 4 * first;
    }
}

bat_status quads_links(const mesh_sides *sides, const bat_mesh_connectivity *links, int threads, bat_mesh_connectivity *fine,
                       bat_error *error)
{
    size_t corners = sides_corners(sides, links->face_count);
    bat_mesh_connectivity made = {
        .twin = memory_array(4 * corners, sizeof *made.twin),
        .edge = memory_array(4 * corners, sizeof *made.edge),
        .vertex_count = links->vertex_count + links->edge_count + links->face_count,
        .face_count = corners,
        .edge_count = 2 * links->edge_count + corners,
        .boundary_edge_count = 2 * links->boundary_edge_count,
    };
    if (links->first != NULL)
        made.first = memory_array(made.vertex_count, sizeof *made.first);
    if (made.twin == NULL || made.edge == NULL || (links->first != NULL && made.first == NULL))
    {
        bat_mesh_connectivity_free(&made);
        return error_memory(error, 4 * corners * sizeof *made.twin);
    }
    quads_job job = {.sides = *sides, .links = links, .fine = &made};
    mesh_share(links_range, &job, links->face_count, threads);
    if (links->first != NULL)
        mesh_share(first_range, &job, links->vertex_count, threads);
    *fine = made;
    return BAT_OK;
}
