/// @file
/// The layout of a shell; see shell.h.
///
/// Triangles of the decimated mesh are paired by rising cost: of the largest difference of a corner of their quad from a
/// right angle, and of the angle between their normals, less a gain where an end of their edge has many edges: patches fold
/// there most. Some stay single. The split puts a vertex on each edge and into each
/// polygon, so that only the vertices of the decimated mesh and the centres of single triangles have a valence other than
/// four.

#include "surface/shell/shell.h"

#include "base/error.h"
#include "linalg/vector.h"

#include <string.h>

/// Cost of an angle between normals, relative to that of a corner.
static const double BEND_COST = 0.5;
/// Gain of a pair for each edge beyond six at an end of its own.
static const double DEGREE_GAIN = 0.05;
/// Cost from which two triangles stay single: 65 degrees.
static const double MAX_COST = 1.134464013796314;
/// Least quality of triangles in the decimation, that of meshes with creases where the number of faces is free, and cosine
/// of their turn.
static const double MIN_QUALITY = 0.2, CREASE_QUALITY = 0.4, MIN_NORMAL = 0.2;

#define PLACE_STEPS 40 ///< of an iteration that shortens errors to a third

static const uint32_t NONE = BAT_MESH_NONE;

typedef struct pair_cost
{
    double cost;
    uint32_t half_edge;
} pair_cost;

DEFINE_ORDER(compare_costs, pair_cost, cost, half_edge)

/// The decimated mesh and what is made of it.
typedef struct layout_builder
{
    bat_mesh coarse;
    bat_mesh_connectivity links;
    bool *sharp;       ///< edge_count
    uint32_t *partner; ///< face_count: the half-edge to the other triangle of a pair; NONE for none
    pair_cost *costs;
    memory_pool pool;
} layout_builder;

static const double *corner_of(const bat_mesh *mesh, uint32_t half_edge)
{
    return mesh->positions + 3 * (size_t)mesh->faces[half_edge];
}

static double angle_at(const double *a, const double *b, const double *c)
{
    double p[3], q[3];
    vector3_subtract(b, a, p);
    vector3_subtract(c, a, q);
    return vector3_angle(p, q);
}

/// The cost of joining the triangles on both sides of an edge.
static double cost_of_pair(const bat_mesh *mesh, uint32_t h, uint32_t twin)
{
    const double *a = corner_of(mesh, h), *b = corner_of(mesh, twin), *c = corner_of(mesh, bat_mesh_previous(h)),
                 *d = corner_of(mesh, bat_mesh_previous(twin));
    double angles[4] = {angle_at(a, d, b) + angle_at(a, b, c), angle_at(d, b, a), angle_at(b, c, a) + angle_at(b, a, d),
                        angle_at(c, a, b)};
    double worst = 0, p[3], q[3];
    for (int k = 0; k < 4; k++)
        worst = fmax(worst, fabs(angles[k] - ANGLE_PI / 2));
    vector3_face(mesh->positions, mesh->faces + h / 3 * 3, p);
    vector3_face(mesh->positions, mesh->faces + twin / 3 * 3, q);
    return worst + BEND_COST * vector3_angle(p, q);
}

/// Whether two triangles may be a pair.
static bool may_join(const layout_builder *builder, uint32_t h)
{
    uint32_t twin = builder->links.twin[h];
    return twin != NONE && !builder->sharp[builder->links.edge[h]] && cost_of_pair(&builder->coarse, h, twin) < MAX_COST;
}

static bat_status pair_triangles(layout_builder *builder, bat_error *error)
{
    const bat_mesh *mesh = &builder->coarse;
    size_t count = 0;
    builder->partner = memory_pool_array(&builder->pool, mesh->face_count, sizeof *builder->partner);
    builder->costs = memory_pool_array(&builder->pool, 3 * mesh->face_count, sizeof *builder->costs);
    uint32_t *degrees = memory_pool_zeros(&builder->pool, mesh->vertex_count, sizeof *degrees);
    bat_status status = memory_pool_check(&builder->pool, error);
    if (status != BAT_OK)
        return status;
    // Two polygons would share two sides where a vertex is left with two.
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
    {
        degrees[mesh->faces[h]] += builder->links.twin[h] == NONE ? 2 : 1;
        degrees[mesh->faces[bat_mesh_next(h)]] += builder->links.twin[h] == NONE;
    }
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
    {
        uint32_t twin = builder->links.twin[h], ends[2] = {degrees[mesh->faces[h]], degrees[mesh->faces[bat_mesh_next(h)]]};
        double gain = DEGREE_GAIN * (fmax(ends[0], 6) + fmax(ends[1], 6) - 12);
        if (twin != NONE && twin > h && may_join(builder, h))
            builder->costs[count++] = (pair_cost){cost_of_pair(mesh, h, twin) - gain, h};
    }
    qsort(builder->costs, count, sizeof *builder->costs, compare_costs);
    memset(builder->partner, 0xff, mesh->face_count * sizeof *builder->partner);
    for (size_t k = 0; k < count; k++)
    {
        uint32_t h = builder->costs[k].half_edge,
                 *ends[2] = {&degrees[mesh->faces[h]], &degrees[mesh->faces[bat_mesh_next(h)]]};
        if (builder->partner[h / 3] != NONE || builder->partner[builder->links.twin[h] / 3] != NONE || *ends[0] < 4 ||
            *ends[1] < 4)
            continue;
        uint32_t twin = builder->links.twin[h];
        builder->partner[h / 3] = h;
        builder->partner[twin / 3] = twin;
        --*ends[0];
        --*ends[1];
    }
    return BAT_OK;
}

// The split

/// The half-edges around the polygon that begins with a triangle. Returns their number.
static uint32_t polygon_of(const layout_builder *builder, uint32_t face, uint32_t sides[4])
{
    uint32_t h = builder->partner[face];
    if (h == NONE)
    {
        for (uint32_t k = 0; k < 3; k++)
            sides[k] = 3 * face + k;
        return 3;
    }
    uint32_t twin = builder->links.twin[h];
    sides[0] = bat_mesh_next(h);
    sides[1] = bat_mesh_previous(h);
    sides[2] = bat_mesh_next(twin);
    sides[3] = bat_mesh_previous(twin);
    return 4;
}

/// Whether a triangle is the one that its polygon is counted at.
static bool begins_polygon(const layout_builder *builder, uint32_t face)
{
    return builder->partner[face] == NONE || builder->links.twin[builder->partner[face]] / 3 > face;
}

static void add_point(double *sum, const double *point, double weight)
{
    for (int c = 0; c < 3; c++)
        sum[c] += weight * point[c];
}

/// Make the faces of a polygon, whose centre is the layout's last vertex.
static void split_polygon(const layout_builder *builder, uint32_t face, shell_layout *layout)
{
    const bat_mesh *mesh = &builder->coarse;
    uint32_t sides[4], count = polygon_of(builder, face, sides), centre = (uint32_t)layout->vertex_count++;
    double *middle = layout->positions + 3 * (size_t)centre;
    memset(middle, 0, 3 * sizeof *middle);
    for (uint32_t k = 0; k < count; k++)
    {
        uint32_t before = sides[(k + count - 1) % count],
                 edges[2] = {builder->links.edge[sides[k]], builder->links.edge[before]};
        uint32_t *quad = layout->quads + 4 * layout->face_count;
        bool *sharp = layout->sharp + 4 * layout->face_count;
        quad[0] = mesh->faces[sides[k]];
        quad[1] = (uint32_t)mesh->vertex_count + edges[0];
        quad[2] = centre;
        quad[3] = (uint32_t)mesh->vertex_count + edges[1];
        sharp[0] = builder->sharp[edges[0]];
        sharp[3] = builder->sharp[edges[1]];
        add_point(middle, corner_of(mesh, sides[k]), 1.0 / count);
        shell_triangle *triangle = &layout->triangles[sides[k] / 3];
        triangle->face = (uint32_t)layout->face_count - k;
        triangle->paired = count == 4;
        layout->face_count++;
        for (uint32_t m = 0; count == 3 && m < 3; m++)
            triangle->corners[m] = (uint8_t)m;
    }
    for (uint32_t k = 0; count == 4 && k < 4; k += 2)
    {
        // Sides k and k + 1 belong to one triangle, whose third side leads from the end of k + 1 to the begin of k.
        shell_triangle *triangle = &layout->triangles[sides[k] / 3];
        triangle->corners[sides[k] % 3] = (uint8_t)k;
        triangle->corners[sides[k + 1] % 3] = (uint8_t)(k + 1);
        triangle->corners[bat_mesh_next(sides[k + 1]) % 3] = (uint8_t)((k + 2) % 4);
    }
}

static bat_status split(const layout_builder *builder, shell_layout *layout, bat_error *error)
{
    const bat_mesh *mesh = &builder->coarse;
    size_t vertices = mesh->vertex_count + builder->links.edge_count, faces = 3 * mesh->face_count;
    memory_pool *pool = &layout->pool;
    layout->quads = memory_pool_array(pool, faces, 4 * sizeof *layout->quads);
    layout->sharp = memory_pool_zeros(pool, faces, 4 * sizeof *layout->sharp);
    layout->positions = memory_pool_array(pool, vertices + mesh->face_count, 3 * sizeof *layout->positions);
    layout->corner = memory_pool_zeros(pool, vertices + mesh->face_count, sizeof *layout->corner);
    layout->triangles = memory_pool_array(pool, mesh->face_count, sizeof *layout->triangles);
    bat_status status = memory_pool_check(pool, error);
    if (status != BAT_OK)
        return status;
    memcpy(layout->positions, mesh->positions, 3 * mesh->vertex_count * sizeof *layout->positions);
    memset(layout->positions + 3 * mesh->vertex_count, 0, 3 * builder->links.edge_count * sizeof *layout->positions);
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
    {
        uint32_t twin = builder->links.twin[h];
        double *middle = layout->positions + 3 * (mesh->vertex_count + builder->links.edge[h]);
        if (twin != NONE && twin < h)
            continue;
        add_point(middle, corner_of(mesh, h), 0.5);
        add_point(middle, corner_of(mesh, bat_mesh_next(h)), 0.5);
    }
    for (size_t k = 0; k < mesh->corner_count; k++)
        layout->corner[mesh->corners[k].vertex] = true;
    layout->vertex_count = vertices;
    for (uint32_t f = 0; f < mesh->face_count; f++)
        if (begins_polygon(builder, f))
            split_polygon(builder, f, layout);
    return BAT_OK;
}

/// Leave out vertices without a face: those on the edges inside pairs.
static bat_status renumber(shell_layout *layout, bat_error *error)
{
    uint32_t *number = memory_array(layout->vertex_count, sizeof *number);
    if (number == NULL)
        return error_memory(error, layout->vertex_count * sizeof *number);
    memset(number, 0xff, layout->vertex_count * sizeof *number);
    for (size_t k = 0; k < 4 * layout->face_count; k++)
        number[layout->quads[k]] = 0;
    uint32_t count = 0;
    for (size_t v = 0; v < layout->vertex_count; v++)
    {
        if (number[v] == NONE)
            continue;
        number[v] = count;
        layout->corner[count] = layout->corner[v];
        memmove(layout->positions + 3 * (size_t)count++, layout->positions + 3 * v, 3 * sizeof *layout->positions);
    }
    layout->vertex_count = count;
    for (size_t k = 0; k < 4 * layout->face_count; k++)
        layout->quads[k] = number[layout->quads[k]];
    free(number);
    return BAT_OK;
}

/// Mark the edges of the decimated mesh that are creases.
static bat_status mark_creases(layout_builder *builder, bat_error *error)
{
    const bat_mesh *mesh = &builder->coarse;
    builder->sharp = memory_pool_zeros(&builder->pool, builder->links.edge_count, sizeof *builder->sharp);
    if (builder->sharp == NULL)
        return memory_pool_check(&builder->pool, error);
    for (size_t k = 0; k < mesh->crease_count; k++)
    {
        uint32_t a = mesh->creases[k].a, b = mesh->creases[k].b, first = builder->links.first[a], h = first;
        do
        {
            if (mesh->faces[bat_mesh_next(h)] == b)
                builder->sharp[builder->links.edge[h]] = true;
            if (mesh->faces[bat_mesh_previous(h)] == b)
                builder->sharp[builder->links.edge[bat_mesh_previous(h)]] = true;
            h = bat_mesh_next_around(&builder->links, h);
        } while (h != NONE && h != first);
    }
    return BAT_OK;
}

bat_status shell_layout_make(const bat_mesh *mesh, size_t faces, bool exact, double normals, shell_layout *layout,
                             bat_error *error)
{
    layout_builder builder = {0};
    shell_layout made = {0};
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.method = BAT_MESH_DECIMATE_METHOD_MEMORYLESS;
    options.faces = faces / 2 > 8 ? faces / 2 : 8;
    options.min_quality = mesh->crease_count > 0 && !exact ? CREASE_QUALITY : MIN_QUALITY;
    options.min_normal = MIN_NORMAL;
    options.attributes = normals;
    bat_status status = bat_mesh_decimate(mesh, &options, &builder.coarse, &made.map, error);
    if (status == BAT_OK)
        status = bat_mesh_connect(&builder.coarse, &builder.links, error);
    if (status == BAT_OK)
        status = mark_creases(&builder, error);
    if (status == BAT_OK)
        status = pair_triangles(&builder, error);
    if (status == BAT_OK)
        status = split(&builder, &made, error);
    if (status == BAT_OK)
        status = renumber(&made, error);
    bat_mesh_free(&builder.coarse);
    bat_mesh_connectivity_free(&builder.links);
    memory_pool_free(&builder.pool);
    if (status == BAT_OK)
        *layout = made;
    else
        shell_layout_free(&made);
    return status;
}

void shell_layout_free(shell_layout *layout)
{
    bat_mesh_map_free(layout->map);
    memory_pool_free(&layout->pool);
    *layout = (shell_layout){0};
}

// Places

/// In a triangle of three faces: the bilinear coordinates of the face at the corner of the largest weight.
static shell_place place_in_triangle(uint32_t first, const double weights[3])
{
    uint32_t k = weights[0] >= weights[1] ? (weights[0] >= weights[2] ? 0U : 2U) : (weights[1] >= weights[2] ? 1U : 2U);
    double p = 2 * weights[(k + 1) % 3], q = 2 * weights[(k + 2) % 3], u = p, v = q;
    for (int step = 0; step < PLACE_STEPS; step++)
    {
        double product = fmin(u, 1) * fmin(v, 1) / 3;
        u = p + product;
        v = q + product;
    }
    return (shell_place){first + k, fmin(u, 1), fmin(v, 1)};
}

static shell_place place_in_quad(uint32_t first, double x, double y)
{
    uint32_t k = y < 0.5 ? (x < 0.5 ? 0U : 1U) : (x < 0.5 ? 3U : 2U);
    double arms[4] = {2 * x, 2 * y, 2 * (1 - x), 2 * (1 - y)};
    return (shell_place){first + k, fmin(fmax(arms[k], 0), 1), fmin(fmax(arms[(k + 1) % 4], 0), 1)};
}

bat_status shell_layout_places(const shell_layout *layout, bat_mesh_point *points, size_t count, shell_place *places,
                               bat_error *error)
{
    static const double SQUARE[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    bat_status status = bat_mesh_map_to_coarse(layout->map, points, count, error);
    for (size_t i = 0; status == BAT_OK && i < count; i++)
    {
        const shell_triangle *triangle = &layout->triangles[points[i].face];
        double at[2] = {0, 0};
        for (size_t c = 0; c < 3; c++)
            for (size_t d = 0; d < 2; d++)
                at[d] += points[i].barycentric[c] * SQUARE[triangle->corners[c]][d];
        places[i] = triangle->paired ? place_in_quad(triangle->face, at[0], at[1])
                                     : place_in_triangle(triangle->face, points[i].barycentric);
    }
    return status;
}
