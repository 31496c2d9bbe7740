#include "mesh/refine/scheme.h"

#include "base/error.h"
#include "base/memory.h"

/// @file
/// A vertex of valence n becomes (1 - a) v + a / n sum_i v_i with a = (4 - 2 cos(2 pi / n)) / 9; the new vertex of a face is
/// its centroid. A trisection moves boundary vertices by (4, 19, 4) / 27 and adds (1, 16, 10) / 27 and (10, 16, 1) / 27.

/// One level of square-root-three subdivision.
typedef struct sqrt3_plan
{
    const uint32_t *faces;
    const bat_mesh_connectivity *links;
    uint32_t *new_vertex; ///< for each face: its first new vertex
    size_t vertex_count;  ///< the number of vertices of the next level
    bool cut;             ///< whether boundary edges are trisected
} sqrt3_plan;

/// The boundary half-edge of a face whose edge is trisected; BAT_MESH_NONE for a face that gets an interior vertex.
static uint32_t cut_edge(const sqrt3_plan *plan, uint32_t face)
{
    for (uint32_t h = 3 * face; plan->cut && h < 3 * face + 3; h++)
        if (mesh_at_boundary(plan->links, h))
            return h;
    return BAT_MESH_NONE;
}

static bat_status sqrt3_plan_make(const uint32_t *faces, const bat_mesh_connectivity *links, bool cut, sqrt3_plan *plan,
                                  bat_error *error)
{
    *plan = (sqrt3_plan){.faces = faces, .links = links, .cut = cut};
    if (array_make(&plan->new_vertex, links->face_count, sizeof *plan->new_vertex, error) != BAT_OK)
        return BAT_NO_MEMORY;
    size_t next = links->vertex_count;
    for (uint32_t f = 0; f < links->face_count; f++)
    {
        plan->new_vertex[f] = (uint32_t)next;
        next += cut_edge(plan, f) == BAT_MESH_NONE ? 1 : 2;
    }
    plan->vertex_count = next;
    return BAT_OK;
}

/// The new vertex in the face of a half-edge, at the end of the edge that crosses it.
static uint32_t new_vertex_beside(const sqrt3_plan *plan, uint32_t half_edge)
{
    uint32_t made = plan->new_vertex[half_edge / 3], cut = cut_edge(plan, half_edge / 3);
    return cut != BAT_MESH_NONE && half_edge == bat_mesh_next(cut) ? made + 1 : made;
}

typedef struct faces_job
{
    const sqrt3_plan *plan;
    uint32_t *fine;
} faces_job;

static void faces_range(const void *context, size_t begin, size_t end)
{
    const faces_job *job = context;
    const sqrt3_plan *plan = job->plan;
    for (uint32_t h = (uint32_t)(3 * begin); h < 3 * end; h++)
    {
        uint32_t *corner = job->fine + 3 * (size_t)h, twin = plan->links->twin[h], beside = new_vertex_beside(plan, h);
        corner[0] = plan->faces[h];
        corner[2] = beside;
        if (twin != BAT_MESH_NONE)
            corner[1] = new_vertex_beside(plan, twin);
        else if (!plan->cut)
            corner[1] = mesh_end(plan->faces, h);
        else
        {
            corner[0] = beside;
            corner[1] = beside + 1;
            corner[2] = mesh_opposite(plan->faces, h);
        }
    }
}

typedef struct rows_job
{
    const sqrt3_plan *plan;
    const double *from;
    double *to;
    size_t dim;
} rows_job;

/// The boundary vertices before and after a boundary half-edge.
static void boundary_around(const sqrt3_plan *plan, uint32_t half_edge, uint32_t *before, uint32_t *after)
{
    uint32_t last = half_edge;
    for (uint32_t h = half_edge; h != BAT_MESH_NONE; h = bat_mesh_next_around(plan->links, h))
        last = h;
    *before = mesh_opposite(plan->faces, last);
    *after = mesh_end(plan->faces, plan->links->first[mesh_end(plan->faces, half_edge)]);
}

/// Compute a boundary vertex; a trisection moves it to a cubic B-spline.
static void boundary_row(const rows_job *job, uint32_t vertex)
{
    const sqrt3_plan *plan = job->plan;
    uint32_t first = plan->links->first[vertex], before, after;
    boundary_around(plan, first, &before, &after);
    const double *own = job->from + vertex * job->dim, *p = job->from + before * job->dim,
                 *q = job->from + mesh_end(plan->faces, first) * job->dim;
    for (size_t i = 0; i < job->dim; i++)
        job->to[vertex * job->dim + i] = plan->cut ? (4 * (p[i] + q[i]) + 19 * own[i]) / 27 : own[i];
}

/// Compute an interior vertex.
static void inner_row(const rows_job *job, uint32_t vertex)
{
    const sqrt3_plan *plan = job->plan;
    size_t dim = job->dim;
    const double *own = job->from + vertex * dim;
    double *restrict to = job->to + vertex * dim;
    uint32_t first = plan->links->first[vertex], h = first;
    unsigned valence = 0;
    for (size_t i = 0; i < dim; i++)
        to[i] = 0;
    do
    {
        vector_add(dim, 1, job->from + mesh_end(plan->faces, h) * dim, to);
        valence++;
        h = bat_mesh_next_around(plan->links, h);
    } while (h != first);
    double share = (4 - 2 * cos(2 * ANGLE_PI / valence)) / 9;
    for (size_t i = 0; i < dim; i++)
        to[i] = (1 - share) * own[i] + share / valence * to[i];
}

static void vertex_range(const void *context, size_t begin, size_t end)
{
    const rows_job *job = context;
    const bat_mesh_connectivity *links = job->plan->links;
    for (uint32_t v = (uint32_t)begin; v < end; v++)
    {
        if (links->first[v] == BAT_MESH_NONE)
            for (size_t i = 0; i < job->dim; i++)
                job->to[v * job->dim + i] = job->from[v * job->dim + i];
        else if (mesh_at_boundary(links, links->first[v]))
            boundary_row(job, v);
        else
            inner_row(job, v);
    }
}

/// Compute the two new vertices on a trisected boundary edge.
static void cut_rows(const rows_job *job, uint32_t half_edge)
{
    const sqrt3_plan *plan = job->plan;
    size_t dim = job->dim;
    uint32_t before, after, made = plan->new_vertex[half_edge / 3];
    boundary_around(plan, half_edge, &before, &after);
    const double *p = job->from + before * dim, *a = job->from + plan->faces[half_edge] * dim,
                 *b = job->from + mesh_end(plan->faces, half_edge) * dim, *q = job->from + after * dim;
    double *to = job->to + made * dim;
    for (size_t i = 0; i < dim; i++)
    {
        to[i] = (p[i] + 16 * a[i] + 10 * b[i]) / 27;
        to[dim + i] = (10 * a[i] + 16 * b[i] + q[i]) / 27;
    }
}

static void face_range(const void *context, size_t begin, size_t end)
{
    const rows_job *job = context;
    const sqrt3_plan *plan = job->plan;
    size_t dim = job->dim;
    for (uint32_t f = (uint32_t)begin; f < end; f++)
    {
        uint32_t cut = cut_edge(plan, f);
        if (cut != BAT_MESH_NONE)
        {
            cut_rows(job, cut);
            continue;
        }
        const uint32_t *corner = plan->faces + 3 * (size_t)f;
        const double *a = job->from + corner[0] * dim, *b = job->from + corner[1] * dim, *c = job->from + corner[2] * dim;
        for (size_t i = 0; i < dim; i++)
            job->to[plan->new_vertex[f] * dim + i] = (a[i] + b[i] + c[i]) / 3;
    }
}

/// Compute the values at the vertices of the next level.
static void sqrt3_rule(const sqrt3_plan *plan, const double *from, double *to, size_t dim, int threads)
{
    rows_job job = {plan, from, to, dim};
    mesh_share(vertex_range, &job, plan->links->vertex_count, threads);
    mesh_share(face_range, &job, plan->links->face_count, threads);
}

bat_status sqrt3_refine(const bat_mesh *mesh, const bat_mesh_connectivity *links, bool cut, int threads, bat_mesh *fine,
                        bat_error *error)
{
    size_t channels = mesh->channel_count;
    sqrt3_plan plan;
    bat_status status = sqrt3_plan_make(mesh->faces, links, cut, &plan, error);
    if (status != BAT_OK)
        return status;
    fine->vertex_count = plan.vertex_count;
    fine->face_count = 3 * mesh->face_count;
    fine->positions = memory_array(plan.vertex_count, 3 * sizeof *fine->positions);
    fine->faces = memory_array(fine->face_count, 3 * sizeof *fine->faces);
    if (channels > 0)
        fine->channels = memory_array(plan.vertex_count, channels * sizeof *fine->channels);
    if (fine->positions == NULL || fine->faces == NULL || (channels > 0 && fine->channels == NULL))
        status = error_memory(error, fine->face_count * 3 * sizeof *fine->faces);
    else
    {
        sqrt3_rule(&plan, mesh->positions, fine->positions, 3, threads);
        if (channels > 0)
            sqrt3_rule(&plan, mesh->channels, fine->channels, channels, threads);
        faces_job job = {&plan, fine->faces};
        mesh_share(faces_range, &job, plan.links->face_count, threads);
    }
    free(plan.new_vertex);
    return status;
}
