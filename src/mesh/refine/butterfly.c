#include "mesh/refine/level.h"

#include <string.h>

/// @file
/// The modified butterfly scheme of Zorin, Schröder and Sweldens, "Interpolating subdivision for meshes with arbitrary
/// topology" (1996).
///
/// Regular edges use the eight-point rule: 1/2 for both ends, 1/8 for both opposite vertices, -1/16 for the four vertices
/// beyond. Rules at boundaries are those of Zorin and Schröder, "Subdivision for modeling and animation" (2000).

#define TABLED 16 ///< weights of smaller valences are tabulated

double butterfly_weight(unsigned valence, unsigned j)
{
    if (valence == 2)
        return j == 0 ? 3.0 / 8 : -1.0 / 8;
    if (valence == 3)
        return j == 0 ? 5.0 / 12 : -1.0 / 12;
    if (valence == 4)
        return j == 0 ? 3.0 / 8 : j == 2 ? -1.0 / 8 : 0;
    double angle = 2 * ANGLE_PI * j / valence;
    return (0.25 + cos(angle) + 0.5 * cos(2 * angle)) / valence;
}

/// The weight of neighbour j of an irregular boundary vertex for the new vertex on the edge to neighbour i.
static double boundary_weight(unsigned faces, unsigned i, unsigned j)
{
    double angle = ANGLE_PI / faces;
    if (j > 0 && j < faces)
        return (sin(i * angle) * sin(j * angle) + 0.5 * sin(2 * i * angle) * sin(2 * j * angle)) / faces;
    double weight =
        0.25 * cos(i * angle) - sin(2 * angle) * sin(2 * i * angle) / (4 * faces * (cos(angle) - cos(2 * angle)));
    return j == 0 ? weight : -weight;
}

typedef struct butterfly_job
{
    const mesh_rows *rows;
    double weights[TABLED][TABLED]; ///< butterfly_weight() by valence and neighbour
} butterfly_job;

static inline void add_row(const mesh_rows *rows, double weight, uint32_t vertex, double *restrict to, size_t dim)
{
    vector_add(dim, weight, rows->from + vertex * dim, to);
}

/// Add the vertex opposite a half-edge in the other face; at a boundary i + j - k replaces it.
static inline void add_beyond(const mesh_rows *rows, uint32_t half_edge, double weight, double *restrict to, size_t dim)
{
    const uint32_t *faces = rows->level->faces;
    uint32_t twin = rows->level->links->twin[half_edge];
    if (twin != BAT_MESH_NONE)
    {
        add_row(rows, weight, mesh_opposite(faces, twin), to, dim);
        return;
    }
    add_row(rows, weight, faces[half_edge], to, dim);
    add_row(rows, weight, mesh_end(faces, half_edge), to, dim);
    add_row(rows, -weight, mesh_opposite(faces, half_edge), to, dim);
}

/// The eight-point rule of a regular edge.
static inline void add_regular(const mesh_rows *rows, uint32_t half_edge, double *restrict to, size_t dim)
{
    const uint32_t *faces = rows->level->faces;
    uint32_t twin = rows->level->links->twin[half_edge];
    add_row(rows, 1.0 / 2, faces[half_edge], to, dim);
    add_row(rows, 1.0 / 2, faces[twin], to, dim);
    add_row(rows, 1.0 / 8, mesh_opposite(faces, half_edge), to, dim);
    add_row(rows, 1.0 / 8, mesh_opposite(faces, twin), to, dim);
    add_beyond(rows, bat_mesh_next(half_edge), -1.0 / 16, to, dim);
    add_beyond(rows, bat_mesh_previous(half_edge), -1.0 / 16, to, dim);
    add_beyond(rows, bat_mesh_next(twin), -1.0 / 16, to, dim);
    add_beyond(rows, bat_mesh_previous(twin), -1.0 / 16, to, dim);
}

/// The rule of an irregular interior vertex, where the half-edge begins.
static void add_inner(const butterfly_job *job, uint32_t half_edge, unsigned valence, double share, double *restrict to)
{
    const mesh_rows *rows = job->rows;
    const uint32_t *faces = rows->level->faces;
    size_t dim = rows->dim;
    add_row(rows, share * 3 / 4, faces[half_edge], to, dim);
    uint32_t h = half_edge;
    for (unsigned j = 0; j < valence; j++)
    {
        double weight = valence < TABLED ? job->weights[valence][j] : butterfly_weight(valence, j);
        add_row(rows, share * weight, mesh_end(faces, h), to, dim);
        h = bat_mesh_next_around(rows->level->links, h);
    }
}

/// The rule of an irregular boundary vertex, where the interior half-edge begins.
static void add_boundary(const mesh_rows *rows, uint32_t half_edge, unsigned valence, double share, double *restrict to)
{
    const uint32_t *faces = rows->level->faces;
    const bat_mesh_connectivity *links = rows->level->links;
    size_t dim = rows->dim;
    uint32_t vertex = faces[half_edge], h = links->first[vertex], last = h;
    unsigned i = 0;
    for (uint32_t g = h; g != half_edge; g = bat_mesh_next_around(links, g))
        i++;
    double angle = ANGLE_PI / valence, own = 1 - sin(angle) * sin(i * angle) / (valence * (1 - cos(angle)));
    add_row(rows, share * own, vertex, to, dim);
    for (unsigned j = 0; j < valence; j++)
    {
        add_row(rows, share * boundary_weight(valence, i, j), mesh_end(faces, h), to, dim);
        last = h;
        h = bat_mesh_next_around(links, h);
    }
    add_row(rows, share * boundary_weight(valence, i, valence), mesh_opposite(faces, last), to, dim);
}

/// The number of faces at an irregular vertex; 0 for a regular one.
static inline uint32_t irregular_at(const mesh_level *level, uint32_t vertex)
{
    return vertex < level->coarse_count ? level->irregular[vertex] : 0;
}

/// The mean of the rules of the edge's irregular ends.
static void add_irregular(const butterfly_job *job, uint32_t half_edge, double *restrict to)
{
    const mesh_level *level = job->rows->level;
    const bat_mesh_connectivity *links = level->links;
    uint32_t from_end[2] = {half_edge, links->twin[half_edge]}, valence[2];
    for (int e = 0; e < 2; e++)
        valence[e] = irregular_at(level, level->faces[from_end[e]]);
    double share = valence[0] > 0 && valence[1] > 0 ? 0.5 : 1;
    for (int e = 0; e < 2; e++)
    {
        if (valence[e] == 0)
            continue;
        if (mesh_at_boundary(links, links->first[level->faces[from_end[e]]]))
            add_boundary(job->rows, from_end[e], valence[e], share, to);
        else
            add_inner(job, from_end[e], valence[e], share, to);
    }
}

/// The four-point rule (-1, 9, 9, -1) / 16 along the boundary.
static void add_four_point(const mesh_rows *rows, uint32_t half_edge, double *restrict to)
{
    const uint32_t *faces = rows->level->faces;
    const bat_mesh_connectivity *links = rows->level->links;
    size_t dim = rows->dim;
    uint32_t begin = faces[half_edge], end = mesh_end(faces, half_edge), last = half_edge;
    for (uint32_t h = half_edge; h != BAT_MESH_NONE; h = bat_mesh_next_around(links, h))
        last = h;
    add_row(rows, 9.0 / 16, begin, to, dim);
    add_row(rows, 9.0 / 16, end, to, dim);
    add_row(rows, -1.0 / 16, mesh_opposite(faces, last), to, dim);
    add_row(rows, -1.0 / 16, mesh_end(faces, links->first[end]), to, dim);
}

static inline void edge_row(const butterfly_job *job, uint32_t half_edge, size_t dim)
{
    const mesh_rows *rows = job->rows;
    const mesh_level *level = rows->level;
    double *restrict to = rows->to + (level->links->vertex_count + level->links->edge[half_edge]) * dim;
    memset(to, 0, dim * sizeof *to);
    if (mesh_at_boundary(level->links, half_edge))
        add_four_point(rows, half_edge, to);
    else if ((irregular_at(level, level->faces[half_edge]) | irregular_at(level, mesh_end(level->faces, half_edge))) == 0)
        add_regular(rows, half_edge, to, dim);
    else
        add_irregular(job, half_edge, to);
}

/// Compute the new vertices on the edges that some faces own.
static void edge_range(const void *context, size_t begin, size_t end)
{
    const butterfly_job *job = context;
    const uint32_t *twin = job->rows->level->links->twin;
    size_t dim = job->rows->dim;
    if (dim == 3)
    {
        for (uint32_t h = (uint32_t)(3 * begin); h < 3 * end; h++)
            if (mesh_owns(twin, h))
                edge_row(job, h, 3);
    }
    else
        for (uint32_t h = (uint32_t)(3 * begin); h < 3 * end; h++)
            if (mesh_owns(twin, h))
                edge_row(job, h, dim);
}

void butterfly_rule(const mesh_rows *rows, int threads)
{
    const bat_mesh_connectivity *links = rows->level->links;
    butterfly_job job = {.rows = rows};
    for (unsigned valence = 1; valence < TABLED; valence++)
        for (unsigned j = 0; j < valence; j++)
            job.weights[valence][j] = butterfly_weight(valence, j);
    memcpy(rows->to, rows->from, links->vertex_count * rows->dim * sizeof *rows->to);
    mesh_share(edge_range, &job, links->face_count, threads);
}
