#include "mesh/refine/level.h"

#include "base/error.h"
#include "base/memory.h"

/// @file
/// Children of faces, half-edges and edges, in parallel and without search.

typedef struct split_job
{
    mesh_sides sides; ///< of the faces that become quads; all zero where triangles become triangles
    const uint32_t *faces;
    const bat_mesh_connectivity *links;
    uint32_t *fine_faces;
    bat_mesh_connectivity *fine;
    bool polygons; ///< whether faces become quads
} split_job;

static void triangles_range(const void *context, size_t begin, size_t end)
{
    const split_job *job = context;
    uint32_t first_edge = (uint32_t)job->links->vertex_count;
    for (size_t f = begin; f < end; f++)
    {
        const uint32_t *corner = job->faces + 3 * f, *edge = job->links->edge + 3 * f;
        uint32_t *fine = job->fine_faces + 12 * f;
        uint32_t middle[3] = {first_edge + edge[0], first_edge + edge[1], first_edge + edge[2]};
        for (size_t c = 0; c < 3; c++)
        {
            fine[3 * c] = corner[c];
            fine[3 * c + 1] = middle[c];
            fine[3 * c + 2] = middle[(c + 2) % 3];
            fine[9 + c] = middle[c];
        }
    }
}

/// The number of edges that the faces before a face own.
static uint32_t owned_before_face(const split_job *job, size_t face)
{
    const bat_mesh_connectivity *links = job->links;
    uint32_t corners = sides_corners(&job->sides, links->face_count);
    for (uint32_t h = sides_begin(&job->sides, (uint32_t)face); h < corners; h++)
        if (mesh_owns(links->twin, h))
            return links->edge[h];
    return (uint32_t)links->edge_count;
}

/// The first half-edges of the vertices that stay.
static void first_range(const void *context, size_t begin, size_t end)
{
    const split_job *job = context;
    for (size_t v = begin; v < end; v++)
    {
        uint32_t first = job->links->first[v], near = job->polygons ? 4 * first : split_near(first);
        job->fine->first[v] = first == BAT_MESH_NONE ? first : near;
    }
}

/// Make the connectivity of the next level.
/// @param made  its counts
/// @param range makes the children of some faces
static bat_status make_links(const split_job *job, size_t half_edges, bat_mesh_connectivity made, mesh_range *range,
                             int threads, bat_mesh_connectivity *fine, bat_error *error)
{
    const bat_mesh_connectivity *links = job->links;
    split_job whole = *job;
    whole.fine = &made;
    made.boundary_edge_count = 2 * links->boundary_edge_count;
    made.twin = memory_array(half_edges, sizeof *made.twin);
    made.edge = memory_array(half_edges, sizeof *made.edge);
    made.first = links->first != NULL ? memory_array(made.vertex_count, sizeof *made.first) : NULL;
    if (made.twin == NULL || made.edge == NULL || (links->first != NULL && made.first == NULL))
    {
        bat_mesh_connectivity_free(&made);
        return error_memory(error, half_edges * sizeof *made.twin);
    }
    mesh_share(range, &whole, links->face_count, threads);
    if (links->first != NULL)
        mesh_share(first_range, &whole, links->vertex_count, threads);
    *fine = made;
    return BAT_OK;
}

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
    return twin[half_edge] == BAT_MESH_NONE || half_edge % 3 == 2 ? split_far(half_edge) : split_near(half_edge) + 1;
}

/// Join the half-edges in the children of a face, on both sides of the edges that it owns. Edges are numbered by their
/// smaller half-edges. Before them come three inner edges for each earlier face, and both halves of the `*owned` edges that
/// earlier faces own.
static inline void triangle_links(const split_job *job, uint32_t face, uint32_t *owned)
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

static void triangle_links_range(const void *context, size_t begin, size_t end)
{
    const split_job *job = context;
    uint32_t owned = owned_before_face(job, begin);
    for (uint32_t f = (uint32_t)begin; f < end; f++)
        triangle_links(job, f, &owned);
}

// Quads of polygons.

static inline void face_quads(const split_job *job, uint32_t face, uint32_t begin, uint32_t count)
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
    const split_job *job = context;
    for (uint32_t f = (uint32_t)begin; f < end; f++)
        if (job->sides.quads)
            face_quads(job, f, 4 * f, 4);
        else
            face_quads(job, f, sides_begin(&job->sides, f), sides_begin(&job->sides, f + 1) - sides_begin(&job->sides, f));
}

void split_faces(const mesh_sides *polygons, const uint32_t *faces, const bat_mesh_connectivity *links, int threads,
                 uint32_t *fine)
{
    split_job job = {.faces = faces, .links = links, .fine_faces = fine};
    if (polygons != NULL)
        job.sides = *polygons;
    mesh_share(polygons != NULL ? faces_range : triangles_range, &job, links->face_count, threads);
}

/// The first half-edges of the face's vertex and of the vertices on the edges that it owns, as sides_connect() chooses them.
static inline void write_first(const split_job *job, uint32_t face, uint32_t begin, uint32_t count)
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
static inline void face_twins(const split_job *job, uint32_t begin, uint32_t count, bool quads)
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
static inline void face_edges(const split_job *job, uint32_t begin, uint32_t count, uint32_t *owned, bool quads)
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

static inline void face_links(const split_job *job, uint32_t face, uint32_t *owned, bool quads)
{
    uint32_t begin = quads ? 4 * face : sides_begin(&job->sides, face);
    uint32_t count = quads ? 4 : sides_begin(&job->sides, face + 1) - begin;
    face_twins(job, begin, count, quads);
    face_edges(job, begin, count, owned, quads);
    if (job->fine->first != NULL)
        write_first(job, face, begin, count);
}

static void links_range(const void *context, size_t begin, size_t end)
{
    const split_job *job = context;
    uint32_t owned = owned_before_face(job, begin);
    for (uint32_t f = (uint32_t)begin; f < end; f++)
        if (job->sides.quads)
            face_links(job, f, &owned, true);
        else
            face_links(job, f, &owned, false);
}

bat_status split_links(const mesh_sides *polygons, const bat_mesh_connectivity *links, int threads,
                       bat_mesh_connectivity *fine, bat_error *error)
{
    split_job job = {.links = links, .polygons = polygons != NULL};
    if (polygons != NULL)
        job.sides = *polygons;
    size_t corners = sides_corners(&job.sides, links->face_count);
    size_t centres = polygons != NULL ? links->face_count : 0, faces = polygons != NULL ? corners : 4 * links->face_count;
    const bat_mesh_connectivity made = {.vertex_count = links->vertex_count + links->edge_count + centres,
                                        .face_count = faces,
                                        .edge_count = 2 * links->edge_count + corners};
    return make_links(&job, 4 * corners, made, polygons != NULL ? links_range : triangle_links_range, threads, fine, error);
}

void split_mesh_free(split_mesh *mesh)
{
    free(mesh->faces);
    bat_mesh_connectivity_free(&mesh->links);
    *mesh = (split_mesh){0};
}

bat_status split_mesh_make(const uint32_t *faces, const bat_mesh_connectivity *links, int threads, split_mesh *fine,
                           bat_error *error)
{
    if (links->face_count > BAT_MESH_MAX_FACES / 4 || links->vertex_count + links->edge_count >= BAT_MESH_NONE)
        return ERROR_TOO_LARGE(error, "the refined mesh would have more than %zu faces", BAT_MESH_MAX_FACES);
    split_mesh made = {.faces = memory_array(links->face_count, 12 * sizeof *made.faces)};
    if (made.faces == NULL)
        return error_memory(error, links->face_count * 12 * sizeof *made.faces);
    bat_status status = split_links(NULL, links, threads, &made.links, error);
    if (status != BAT_OK)
    {
        free(made.faces);
        return status;
    }
    split_faces(NULL, faces, links, threads, made.faces);
    split_mesh_free(fine);
    *fine = made;
    return BAT_OK;
}
