#include "mesh/refine/sharpness.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/mesh_refine.h"

#include <string.h>

/// @file
/// Limit normals at vertices of every kind, by the tangents of a scheme.

// Limit positions of creases and corners.

typedef struct limit_job
{
    const mesh_rows *rows;
    void (*inner)(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp);
} limit_job;

static void limit_range(const void *context, size_t begin, size_t end)
{
    const limit_job *job = context;
    const mesh_rows *rows = job->rows;
    size_t dim = rows->dim;
    for (uint32_t v = (uint32_t)begin; v < end; v++)
    {
        const double *from = rows->from + v * dim;
        double *restrict to = rows->to + v * dim;
        sharp_vertex sharp = {.kind = SHARP_CORNER};
        if (rows->level->links->first[v] != BAT_MESH_NONE)
            sharpness_around(rows->level, v, &sharp, NULL, NULL);
        if (sharp.kind < SHARP_CREASE)
        {
            job->inner(rows, v, &sharp);
            continue;
        }
        const double *p = rows->from + sharp.ends[0] * dim, *q = rows->from + sharp.ends[1] * dim;
        for (size_t i = 0; i < dim; i++)
            to[i] = sharp.kind == SHARP_CORNER ? from[i] : (4 * from[i] + p[i] + q[i]) / 6;
    }
}

void limit_rows(const mesh_rows *rows, void (*inner)(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp),
                int threads)
{
    const limit_job job = {rows, inner};
    mesh_share(limit_range, &job, rows->level->links->vertex_count, threads);
}

/// Scale a vector to unit length. False, with the vector unchanged, when its length is 0 or not finite.
static bool normalize(double vector[3])
{
    return isfinite(vector3_length(vector)) && vector3_normalize(vector);
}

void normal_add_way(const normal_job *job, double weight, uint32_t from, uint32_t to, double sum[3])
{
    const double *p = job->positions + 3 * (size_t)from, *q = job->positions + 3 * (size_t)to;
    for (int i = 0; i < 3; i++)
        sum[i] += weight * (q[i] - p[i]);
}

/// The mean normal of the faces around a vertex, weighted by area at the vertex.
static void face_normals(const normal_job *job, uint32_t vertex, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t first = level->links->first[vertex], h = first;
    double sum[3] = {0};
    do
    {
        double a[3] = {0}, b[3] = {0}, area[3];
        normal_add_way(job, 1, vertex, level->faces[sides_next(&level->sides, h)], a);
        normal_add_way(job, 1, vertex, level->faces[sides_previous(&level->sides, h)], b);
        vector3_cross(a, b, area);
        vector_add(3, 1, area, sum);
        h = sides_next_around(level, h);
    } while (h != BAT_MESH_NONE && h != first);
    memcpy(normal, sum, sizeof sum);
}

/// The normal of a vertex on a crease: the mean of both sides. A boundary vertex has one side.
static void crease_normal(const normal_job *job, uint32_t vertex, const sharp_vertex *sharp, double normal[3])
{
    const mesh_level *level = job->level;
    bool boundary = mesh_at_boundary(level->links, level->links->first[vertex]);
    double sum[3] = {0};
    for (int s = 0; s < (boundary ? 1 : 2); s++)
    {
        uint32_t h = mesh_half_edge_to(level, vertex, sharp->ends[s]);
        double one[3];
        unsigned faces = 1; // counter-clockwise to the other end
        for (uint32_t i = h; level->faces[sides_previous(&level->sides, i)] != sharp->ends[1 - s]; faces++)
            i = sides_next_around(level, i);
        job->rules->side(job, h, faces, one);
        (void)normalize(one);
        vector_add(3, 1, one, sum);
    }
    memcpy(normal, sum, sizeof sum);
}

/// A dart, or any vertex for the other rules.
static void finish_normal(const normal_job *job, uint32_t vertex)
{
    double *normal = job->normals + 3 * (size_t)vertex;
    if (normalize(normal))
        return;
    face_normals(job, vertex, normal);
    if (!normalize(normal))
        memset(normal, 0, 3 * sizeof *normal);
}

static void normal_range(const void *context, size_t begin, size_t end)
{
    const normal_job *job = context;
    for (uint32_t v = (uint32_t)begin; v < end; v++)
    {
        double *normal = job->normals + 3 * (size_t)v;
        memset(normal, 0, 3 * sizeof *normal);
        if (job->level->links->first[v] == BAT_MESH_NONE)
            continue;
        sharp_vertex sharp;
        sharpness_around(job->level, v, &sharp, NULL, NULL);
        if (sharp.kind == SHARP_SMOOTH)
            job->rules->smooth(job, v, normal);
        else if (sharp.kind == SHARP_CREASE)
            crease_normal(job, v, &sharp, normal);
        if (sharp.kind != SHARP_DART)
            finish_normal(job, v);
    }
}

// A dart's tangents: the subdivision matrix is symmetric about the sharp edge, and its largest eigenvalues below 1 have one
// left eigenvector that is symmetric and one that is antisymmetric. Both come by iteration.

/// Make a row symmetric or, with sign -1, antisymmetric about the sharp edge, with the sum 0.
static void project(const normal_rules *rules, unsigned valence, double sign, double *row)
{
    for (unsigned i = 1; 2 * i <= valence; i++)
    {
        double *a = &row[1 + i], *b = &row[1 + valence - i], mean = (*a + sign * *b) / 2;
        *a = mean;
        *b = sign * mean;
    }
    for (unsigned i = 0; rules->quads && 2 * i < valence; i++)
    {
        double *a = &row[1 + valence + i], *b = &row[1 + 2 * valence - 1 - i], mean = (*a + sign * *b) / 2;
        *a = mean;
        *b = sign * mean;
    }
    if (sign < 0)
        row[1] = 0;
    row[0] = 0;
    for (unsigned i = 1; i <= (rules->quads ? 2 : 1) * valence; i++)
        row[0] -= sign > 0 ? row[i] : 0;
}

/// Iterate to the left eigenvector of the largest eigenvalue below 1. `room` holds as many numbers as the row.
static void find_tangent(const normal_rules *rules, unsigned valence, double sign, double *row, double *room)
{
    static const int MAX_STEPS = 10000;
    size_t size = 1 + (rules->quads ? 2 : 1) * (size_t)valence;
    for (unsigned i = 0; i < valence; i++)
    {
        double angle = ANGLE_TURN * i / valence;
        row[1 + i] = sign > 0 ? cos(angle) : sin(angle);
        if (rules->quads)
            row[1 + valence + i] = 0;
    }
    project(rules, valence, sign, row);
    double change = 1;
    for (int step = 0; step < MAX_STEPS && change > 1e-15; step++)
    {
        rules->multiply(valence, row, room);
        project(rules, valence, sign, room);
        double largest = vector_largest(size, room);
        change = 0;
        for (size_t i = 0; i < size; i++)
        {
            change = fmax(change, fabs(room[i] / largest - row[i]));
            row[i] = room[i] / largest;
        }
    }
}

/// Apply a tangent's row to the vertices around.
static void apply_tangent(const normal_job *job, uint32_t vertex, uint32_t half_edge, unsigned valence, const double *row,
                          double tangent[3])
{
    const mesh_level *level = job->level;
    uint32_t h = half_edge;
    memset(tangent, 0, 3 * sizeof *tangent);
    for (unsigned i = 0; i < valence; i++)
    {
        uint32_t next = sides_next(&level->sides, h);
        normal_add_way(job, row[1 + i], vertex, level->faces[next], tangent);
        if (job->rules->quads)
            normal_add_way(job, row[1 + valence + i], vertex, level->faces[sides_next(&level->sides, next)], tangent);
        h = sides_next_around(level, h);
    }
}

/// Compute the normals at the darts, of which there are few.
static bat_status dart_normals(const normal_job *job, bat_error *error)
{
    const mesh_level *level = job->level;
    const bat_mesh_connectivity *links = level->links;
    for (uint32_t h = 0; level->edge_sharpness != NULL && h < sides_corners(&level->sides, links->face_count); h++)
    {
        if (!(level->edge_sharpness[links->edge[h]] > 0))
            continue;
        // Inside the mesh, where darts are, every edge has a half-edge from either end.
        sharp_vertex sharp;
        uint32_t vertex = level->faces[h];
        sharpness_around(level, vertex, &sharp, NULL, NULL);
        if (sharp.kind != SHARP_DART)
            continue;
        unsigned valence = mesh_valence(level, vertex);
        size_t size = 1 + 2 * (size_t)valence;
        double along[3], across[3], *row = memory_array(size, 2 * sizeof *row);
        if (row == NULL)
            return error_memory(error, size * 2 * sizeof *row);
        uint32_t first = mesh_half_edge_to(level, vertex, sharp.ends[0]);
        find_tangent(job->rules, valence, 1, row, row + size);
        apply_tangent(job, vertex, first, valence, row, along);
        find_tangent(job->rules, valence, -1, row, row + size);
        apply_tangent(job, vertex, first, valence, row, across);
        vector3_cross(along, across, job->normals + 3 * (size_t)vertex);
        finish_normal(job, vertex);
        free(row);
    }
    return BAT_OK;
}

bat_status normals_compute(const bat_mesh *mesh, const mesh_sides *sides, const normal_rules *rules, int threads,
                           double *normals, bat_error *error)
{
    double *edges = NULL, *vertices = NULL;
    bat_mesh_connectivity links = {0};
    mesh_level level = {.faces = mesh->faces, .sides = *sides, .links = &links, .coarse_count = mesh->vertex_count};
    normal_job job = {&level, mesh->positions, normals, rules};
    for (uint32_t f = 0; rules->quads && f < mesh->face_count; f++)
        if (sides_begin(sides, f + 1) - sides_begin(sides, f) != 4)
            return error_set(error, BAT_UNSUPPORTED, f, 0, "face %u is no quad: limit normals need a level of refinement",
                             f);
    bat_status status = sides_connect(sides, mesh->faces, mesh->face_count, mesh->vertex_count, &links, error);
    if (status == BAT_OK)
        status = sharpness_of_edges(&level, mesh, 0, &edges, error);
    if (status == BAT_OK)
        status = sharpness_of_vertices(&level, mesh, mesh->rules.boundary == BAT_MESH_BOUNDARY_CORNERS, &vertices, error);
    if (status == BAT_OK)
    {
        level.edge_sharpness = edges;
        level.vertex_sharpness = vertices;
        mesh_share(normal_range, &job, links.vertex_count, threads);
        status = dart_normals(&job, error);
    }
    bat_mesh_connectivity_free(&links);
    free(edges);
    free(vertices);
    return status;
}

bat_status bat_mesh_limit_normals(const bat_mesh *mesh, int threads, double *normals, bat_error *error)
{
    mesh_sides sides;
    uint32_t *face = NULL;
    bat_status status = bat_mesh_check(mesh, error);
    if (status == BAT_OK)
        status = sides_of_mesh(mesh, &sides, &face, error);
    if (status == BAT_OK)
        status = normals_compute(mesh, &sides, mesh->offsets != NULL ? &catmull_clark_normals : &loop_normals, threads,
                                 normals, error);
    free(face);
    return status;
}
