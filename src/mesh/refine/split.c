#include "mesh/refine/split.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/refine/level.h"

#include <stdlib.h>

/// @file
/// Children of faces, half-edges and edges, in parallel and without search.

typedef struct faces_job
{
    const uint32_t *faces, *edge;
    uint32_t vertex_count;
    uint32_t *fine;
} faces_job;

static void faces_range(const void *context, size_t begin, size_t end)
{
    const faces_job *job = context;
    for (size_t f = begin; f < end; f++)
    {
        const uint32_t *corner = job->faces + 3 * f, *edge = job->edge + 3 * f;
        uint32_t *fine = job->fine + 12 * f;
        uint32_t middle[3] = {job->vertex_count + edge[0], job->vertex_count + edge[1], job->vertex_count + edge[2]};
        for (size_t c = 0; c < 3; c++)
        {
            fine[3 * c] = corner[c];
            fine[3 * c + 1] = middle[c];
            fine[3 * c + 2] = middle[(c + 2) % 3];
            fine[9 + c] = middle[c];
        }
    }
}

void split_faces(const uint32_t *faces, const bat_mesh_connectivity *links, int threads, uint32_t *fine)
{
    faces_job job = {faces, links->edge, (uint32_t)links->vertex_count, fine};
    mesh_share(faces_range, &job, links->face_count, threads);
}

/// The number of edges that the faces before a face own.
static uint32_t owned_before_face(const bat_mesh_connectivity *links, size_t face)
{
    for (size_t h = 3 * face; h < 3 * links->face_count; h++)
        if (mesh_owns(links->twin, (uint32_t)h))
            return links->edge[h];
    return (uint32_t)links->edge_count;
}

typedef struct links_job
{
    const bat_mesh_connectivity *links;
    bat_mesh_connectivity *fine;
} links_job;

/// Join two half-edges of the next level along an edge of this number.
static inline void join(bat_mesh_connectivity *fine, uint32_t half_edge, uint32_t twin, uint32_t edge)
{
    fine->twin[half_edge] = twin;
    fine->edge[half_edge] = edge;
    if (twin == BAT_MESH_NONE)
        return;
    fine->twin[twin] = half_edge;
    fine->edge[twin] = edge;
}

/// The first half-edge at the vertex on an edge, as bat_mesh_connect() chooses it.
static uint32_t first_of_middle(const uint32_t *twin, uint32_t half_edge)
{
    if (twin[half_edge] == BAT_MESH_NONE || half_edge % 3 == 2)
        return split_far(half_edge);
    return split_near(half_edge) + 1;
}

/// Join the half-edges in the children of a face, on both sides of the edges that it owns. Edges are numbered by their
/// smaller half-edges. Before them come three inner edges for each earlier face, and both halves of the `*owned` edges that
/// earlier faces own.
static inline void face_links(const links_job *job, uint32_t face, uint32_t *owned)
{
    const uint32_t *twin = job->links->twin;
    uint32_t number = 3 * face + 2 * *owned, begin = 3 * face;
    for (uint32_t c = 0; c < 3; c++)
    {
        uint32_t h = begin + c, previous = begin + (c + 2) % 3, other = twin[h], before = twin[previous];
        if (other > h)
        {
            join(job->fine, split_near(h), other != BAT_MESH_NONE ? split_far(other) : other, number++);
            ++*owned;
            if (job->links->first != NULL)
                job->fine->first[job->links->vertex_count + job->links->edge[h]] = first_of_middle(twin, h);
        }
        join(job->fine, split_near(h) + 1, 12 * face + 9 + (c + 2) % 3, number++);
        if (before > previous)
            join(job->fine, split_far(previous), before != BAT_MESH_NONE ? split_near(before) : before, number++);
    }
}

static void links_range(const void *context, size_t begin, size_t end)
{
    const links_job *job = context;
    uint32_t owned = owned_before_face(job->links, begin);
    for (uint32_t f = (uint32_t)begin; f < end; f++)
        face_links(job, f, &owned);
}

static void first_range(const void *context, size_t begin, size_t end)
{
    const links_job *job = context;
    for (size_t v = begin; v < end; v++)
    {
        uint32_t first = job->links->first[v];
        job->fine->first[v] = first == BAT_MESH_NONE ? first : split_near(first);
    }
}

bat_status split_links(const bat_mesh_connectivity *links, int threads, bat_mesh_connectivity *fine, bat_error *error)
{
    size_t half_edges = 12 * links->face_count;
    bat_mesh_connectivity made = {
        .twin = memory_array(half_edges, sizeof *made.twin),
        .edge = memory_array(half_edges, sizeof *made.edge),
        .vertex_count = links->vertex_count + links->edge_count,
        .face_count = 4 * links->face_count,
        .edge_count = 2 * links->edge_count + 3 * links->face_count,
        .boundary_edge_count = 2 * links->boundary_edge_count,
    };
    if (links->first != NULL)
        made.first = memory_array(made.vertex_count, sizeof *made.first);
    if (made.twin == NULL || made.edge == NULL || (links->first != NULL && made.first == NULL))
    {
        bat_mesh_connectivity_free(&made);
        return error_memory(error, half_edges * sizeof *made.twin);
    }
    links_job job = {links, &made};
    mesh_share(links_range, &job, links->face_count, threads);
    if (links->first != NULL)
        mesh_share(first_range, &job, links->vertex_count, threads);
    *fine = made;
    return BAT_OK;
}
