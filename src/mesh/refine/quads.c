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

/// The numbers of the edges in the children of one face of `count` corners. Edges are numbered by their smaller half-edges.
/// Before them come the inner edges of earlier faces, one for each corner, and both halves of the edges that those own.
typedef struct child_edges
{
    const uint32_t *twin; ///< of the face's half-edges
    uint32_t begin, count, before;
} child_edges;

/// The number of the `corner` first half-edges of the face that own their edges.
static inline uint32_t owned_until(const child_edges *made, uint32_t corner)
{
    uint32_t owned = 0;
    for (uint32_t c = 0; c < corner; c++)
        owned += made->twin[c] > made->begin + c;
    return owned;
}

/// The number of the near half of an owned half-edge.
static inline uint32_t near_edge(const child_edges *made, uint32_t corner)
{
    if (corner == 0)
        return made->before;
    uint32_t last = made->count - 1;
    return made->before + owned_until(made, corner) + corner + 1 + owned_until(made, corner - 1) +
           (made->twin[last] > made->begin + last);
}

static inline uint32_t far_edge(const child_edges *made, uint32_t corner)
{
    uint32_t last = made->count - 1, next = corner + 1;
    if (corner == last)
        return made->before + (made->twin[0] > made->begin) + 2;
    return near_edge(made, next) + (made->twin[next] > made->begin + next) + (next < last);
}

/// The number of the edge between the quads of a corner and of the next one.
static inline uint32_t inner_edge(const child_edges *made, uint32_t corner)
{
    uint32_t first = made->before + (made->twin[0] > made->begin);
    if (corner == made->count - 1)
        return first + 1;
    return corner == 0 ? first : near_edge(made, corner) + (made->twin[corner] > made->begin + corner);
}

/// The children of the face of a half-edge that owns its edge.
static inline child_edges children_of_owner(const quads_job *job, uint32_t half_edge, bool quads)
{
    const mesh_sides *sides = &job->sides;
    uint32_t face = quads ? half_edge / 4 : sides_face(sides, half_edge);
    uint32_t begin = quads ? 4 * face : sides_begin(sides, face), end = quads ? begin + 4 : sides_begin(sides, face + 1);
    child_edges made = {job->links->twin + begin, begin, end - begin, 0};
    made.before = begin + 2 * (job->links->edge[half_edge] - owned_until(&made, half_edge - begin));
    return made;
}

/// Write the twins and edges of both halves of a half-edge, and of the inner edge after it.
static inline void write_children(const quads_job *job, const child_edges *own, uint32_t corner, bool quads)
{
    const uint32_t *twin = job->links->twin;
    bat_mesh_connectivity *fine = job->fine;
    uint32_t h = own->begin + corner, next = corner + 1 < own->count ? h + 1 : own->begin, other = twin[h];
    uint32_t near = 4 * h, far = 4 * next + 3;
    fine->twin[near + 1] = 4 * next + 2;
    fine->twin[4 * next + 2] = near + 1;
    fine->edge[near + 1] = fine->edge[4 * next + 2] = inner_edge(own, corner);
    if (other == BAT_MESH_NONE)
        fine->twin[near] = fine->twin[far] = BAT_MESH_NONE;
    else
    {
        uint32_t after = quads ? (other % 4 == 3 ? other - 3 : other + 1) : sides_next(&job->sides, other);
        fine->twin[near] = 4 * after + 3;
        fine->twin[far] = 4 * other;
    }
    if (other > h)
    {
        fine->edge[near] = near_edge(own, corner);
        fine->edge[far] = far_edge(own, corner);
        return;
    }
    child_edges owner = children_of_owner(job, other, quads);
    fine->edge[near] = far_edge(&owner, other - owner.begin);
    fine->edge[far] = near_edge(&owner, other - owner.begin);
}

/// Write the first half-edges of the face's vertex and of the vertices on the edges that it owns, as sides_connect() chooses
/// them.
static inline void write_first(const quads_job *job, const child_edges *own, uint32_t face)
{
    const bat_mesh_connectivity *links = job->links;
    uint32_t *first = job->fine->first + links->vertex_count;
    first[links->edge_count + face] = 4 * own->begin + 2;
    for (uint32_t c = 0; c < own->count; c++)
    {
        uint32_t h = own->begin + c, next = c + 1 < own->count ? h + 1 : own->begin;
        if (own->twin[c] > h)
            first[links->edge[h]] = own->twin[c] == BAT_MESH_NONE || next < h ? 4 * next + 3 : 4 * h + 1;
    }
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

static inline void face_links(const quads_job *job, uint32_t face, uint32_t *owned, bool quads)
{
    uint32_t begin = quads ? 4 * face : sides_begin(&job->sides, face);
    uint32_t count = quads ? 4 : sides_begin(&job->sides, face + 1) - begin;
    child_edges own = {job->links->twin + begin, begin, count, begin + 2 * *owned};
    for (uint32_t c = 0; c < count; c++)
        write_children(job, &own, c, quads);
    if (job->fine->first != NULL)
        write_first(job, &own, face);
    *owned += owned_until(&own, count);
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
