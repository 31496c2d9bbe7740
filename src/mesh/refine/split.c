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

/// The numbers of the edges in the children of one face: by corner, where the half-edge owns its edge.
typedef struct child_edges
{
    uint32_t near[3], inner[3], far[3];
} child_edges;

/// Number the edges in the children of one face. Edges are numbered by their smaller half-edges. Before the children of face
/// f come three inner edges for each earlier face. The halves of the `owned_before` edges that earlier faces own come before
/// them as well.
static child_edges number_children(const uint32_t *twin, uint32_t face, uint32_t owned_before)
{
    child_edges made;
    uint32_t next = 3 * face + 2 * owned_before;
    for (uint32_t c = 0; c < 3; c++)
    {
        uint32_t previous = (c + 2) % 3;
        made.near[c] = next;
        next += mesh_owns(twin, 3 * face + c);
        made.inner[c] = next++;
        made.far[previous] = next;
        next += mesh_owns(twin, 3 * face + previous);
    }
    return made;
}

/// The number of edges that the faces before the face of a half-edge own. The half-edge owns its edge.
static uint32_t owned_before(const uint32_t *twin, const uint32_t *edge, uint32_t half_edge)
{
    uint32_t count = edge[half_edge];
    for (uint32_t h = half_edge / 3 * 3; h < half_edge; h++)
        count -= mesh_owns(twin, h);
    return count;
}

/// The same for the first face of a range, which may own no edge.
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

/// Write the twins and edges of both halves of a half-edge; `own` belongs to its face.
static void write_halves(const links_job *job, uint32_t half_edge, const child_edges *own)
{
    const uint32_t *twin = job->links->twin;
    uint32_t c = half_edge % 3, other = twin[half_edge], near = split_near(half_edge), far = split_far(half_edge);
    bat_mesh_connectivity *fine = job->fine;
    if (other == BAT_MESH_NONE)
        fine->twin[near] = fine->twin[far] = BAT_MESH_NONE;
    else
    {
        fine->twin[near] = split_far(other);
        fine->twin[far] = split_near(other);
    }
    if (mesh_owns(twin, half_edge))
    {
        fine->edge[near] = own->near[c];
        fine->edge[far] = own->far[c];
        return;
    }
    child_edges owner = number_children(twin, other / 3, owned_before(twin, job->links->edge, other));
    fine->edge[near] = owner.far[other % 3];
    fine->edge[far] = owner.near[other % 3];
}

/// The first half-edge at the vertex on an edge, as bat_mesh_connect() chooses it.
static uint32_t first_of_middle(const uint32_t *twin, uint32_t half_edge)
{
    if (twin[half_edge] == BAT_MESH_NONE || half_edge % 3 == 2)
        return split_far(half_edge);
    return split_near(half_edge) + 1;
}

static void links_range(const void *context, size_t begin, size_t end)
{
    const links_job *job = context;
    const bat_mesh_connectivity *links = job->links;
    uint32_t owned = owned_before_face(links, begin);
    for (uint32_t f = (uint32_t)begin; f < end; f++)
    {
        child_edges own = number_children(links->twin, f, owned);
        for (uint32_t c = 0; c < 3; c++)
        {
            uint32_t h = 3 * f + c, inside = split_near(h) + 1, middle = 12 * f + 9 + (c + 2) % 3;
            write_halves(job, h, &own);
            job->fine->twin[inside] = middle;
            job->fine->twin[middle] = inside;
            job->fine->edge[inside] = job->fine->edge[middle] = own.inner[c];
            if (!mesh_owns(links->twin, h))
                continue;
            owned++;
            if (links->first != NULL)
                job->fine->first[links->vertex_count + links->edge[h]] = first_of_middle(links->twin, h);
        }
    }
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
