/// @file
/// The patches, edges and vertices of a shell for CAD files; see step.h.
///
/// A face of n x n bicubic patches is one spline with double inner knots. Its control points are the Bézier points of the
/// patches but those on the lines between patches, where they are the means of their neighbours.

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "io/surface/step.h"
#include "linalg/vector.h"
#include "mesh/sides.h"

#include <string.h>

static const mesh_sides QUADS = {.quads = true};

/// Where the parts of a side are: those of side c begin at the quads' half-edges c.
typedef struct shell_builder
{
    const bat_shell *shell;
    bat_mesh_connectivity links;
    uint32_t *edge_of; ///< of each edge of the grid that begins or ends a side: the side's edge; SHELL_NONE: none yet
    step_model *model;
} shell_builder;

/// The knots of a face: 0, 0, 0, 0, then each inner one twice, 1, 1, 1, 1.
static bool make_knots(size_t spans, bat_knot_vector *knots)
{
    *knots = (bat_knot_vector){malloc((2 * spans + 6) * sizeof(double)), 2 * spans + 6, 3};
    for (size_t i = 0; knots->knots != NULL && i < knots->count; i++)
    {
        size_t inner = i < 4 ? 0 : (i - 2) / 2;
        knots->knots[i] = inner >= spans ? 1 : (double)inner / (double)spans;
    }
    return knots->knots != NULL;
}

/// The patch and the Bézier point of it that control point k is, 0 to 2 spans + 1.
static void place_of(size_t spans, size_t k, size_t *patch, size_t *point)
{
    size_t last = 2 * spans + 1;
    *patch = k < 2 ? 0 : k >= last - 1 ? spans - 1 : (k - 1) / 2;
    *point = k == 0 ? 0 : k == last ? 3 : k % 2 == 1 ? 1 : 2;
}

static const double *control_at(const bat_shell *shell, size_t face, size_t i, size_t j)
{
    size_t patch[2], point[2];
    place_of(shell->spans, i, &patch[0], &point[0]);
    place_of(shell->spans, j, &patch[1], &point[1]);
    size_t index = (face * shell->spans + patch[1]) * shell->spans + patch[0];
    return shell->patches + 3 * (16 * index + 4 * point[1] + point[0]);
}

static bat_status make_patches(const shell_builder *builder, bat_error *error)
{
    const bat_shell *shell = builder->shell;
    size_t side = 2 * shell->spans + 2;
    for (size_t f = 0; f < shell->face_count; f++)
    {
        tensor_surface *patch = &builder->model->patches[f];
        patch->dimension = 3;
        patch->control = malloc(side * side * 3 * sizeof *patch->control);
        if (patch->control == NULL || !make_knots(shell->spans, &patch->knots[0]) ||
            !make_knots(shell->spans, &patch->knots[1]))
            return error_memory(error, side * side * 3 * sizeof *patch->control);
        for (size_t k = 0; k < side * side; k++)
            memcpy(patch->control + 3 * k, control_at(shell, f, k % side, k / side), 3 * sizeof(double));
    }
    return BAT_OK;
}

/// The half-edge of the grid that begins side c of a face, or the one that ends it.
static uint32_t half_edge_on(const bat_shell *shell, size_t face, uint32_t side, bool last)
{
    size_t end = shell->spans - 1, along = last ? end : 0;
    size_t i = side == 0 ? along : side == 1 ? end : side == 2 ? end - along : 0;
    size_t j = side == 0 ? 0 : side == 1 ? along : side == 2 ? end : end - along;
    return (uint32_t)(4 * ((face * shell->spans + j) * shell->spans + i) + side);
}

static bat_status make_curve(const shell_builder *builder, size_t face, uint32_t side, uint32_t edge, bat_error *error)
{
    const bat_shell *shell = builder->shell;
    step_model *model = builder->model;
    size_t count = 2 * shell->spans + 2, last = count - 1;
    model->control[edge] = memory_pool_array(&model->pool, count, 3 * sizeof(double));
    if (model->control[edge] == NULL || !make_knots(shell->spans, &model->knots[edge]))
        return error_memory(error, count * 3 * sizeof(double));
    for (size_t k = 0; k < count; k++)
    {
        size_t i = side == 0 ? k : side == 1 ? last : side == 2 ? last - k : 0;
        size_t j = side == 0 ? 0 : side == 1 ? k : side == 2 ? last : last - k;
        memcpy(model->control[edge] + 3 * k, control_at(shell, face, i, j), 3 * sizeof(double));
    }
    return BAT_OK;
}

/// Make the edges and the loops. The first face at an edge gives its direction.
static bat_status make_edges(shell_builder *builder, bat_error *error)
{
    const bat_shell *shell = builder->shell;
    const bat_mesh *cage = &shell->cage;
    surface_shell *topology = &builder->model->shell;
    bat_status status = BAT_OK;
    for (size_t f = 0; f < shell->face_count; f++)
    {
        topology->loops[f] = 4 * f;
        for (uint32_t c = 0; c < 4 && status == BAT_OK; c++)
        {
            uint32_t first = half_edge_on(shell, f, c, false), last = half_edge_on(shell, f, c, true);
            uint32_t *known = &builder->edge_of[builder->links.edge[first]];
            bool backward = *known != SHELL_NONE;
            if (!backward)
            {
                uint32_t edge = (uint32_t)topology->edge_count++;
                topology->edges[edge] = (shell_edge){.from = cage->faces[first],
                                                     .to = cage->faces[sides_next(&QUADS, last)],
                                                     .faces = {(uint32_t)f, SHELL_NONE}};
                builder->edge_of[builder->links.edge[first]] = edge;
                builder->edge_of[builder->links.edge[last]] = edge;
                status = make_curve(builder, f, c, edge, error);
            }
            else
                topology->edges[*known].faces[1] = (uint32_t)f;
            topology->uses[4 * f + c] = (shell_use){*known, backward};
        }
    }
    topology->loops[shell->face_count] = 4 * shell->face_count;
    return status;
}

/// Number the connected parts, in the order of their first faces.
static void find_pieces(step_model *model, size_t faces)
{
    uint32_t *pieces = model->pieces;
    sets_begin(pieces, faces);
    for (size_t e = 0; e < model->shell.edge_count; e++)
    {
        const shell_edge *edge = &model->shell.edges[e];
        if (edge->faces[1] != SHELL_NONE)
            (void)sets_join(pieces, edge->faces[0], edge->faces[1]);
    }
    for (uint32_t f = 0; f < faces; f++)
        pieces[f] = sets_root(pieces, f);
    // A root comes before all faces that refer to it, so that its number is known by then.
    for (uint32_t f = 0; f < faces; f++)
        pieces[f] = pieces[f] == f ? (uint32_t)model->piece_count++ : pieces[pieces[f]];
    for (size_t p = 0; p < model->piece_count; p++)
        model->closed[p] = true;
    for (size_t e = 0; e < model->shell.edge_count; e++)
        if (model->shell.edges[e].faces[1] == SHELL_NONE)
            model->closed[pieces[model->shell.edges[e].faces[0]]] = false;
}

/// The volume of a part, and the solid angle of a place in it, by the triangles between the corners of its faces.
static double measure_part(const step_model *model, uint32_t part, const double place[3], double *angle)
{
    double volume = 0;
    *angle = 0;
    for (size_t f = 0; f < model->shell.face_count; f++)
    {
        if (model->pieces[f] != part)
            continue;
        const tensor_surface *patch = &model->patches[f];
        size_t row = knot_vector_functions(&patch->knots[0]), all = row * knot_vector_functions(&patch->knots[1]);
        const size_t corners[4] = {0, row - 1, all - 1, all - row};
        double to[4][3], length[4];
        for (int c = 0; c < 4; c++)
            vector3_subtract(patch->control + 3 * corners[c], place, to[c]);
        for (int c = 0; c < 4; c++)
            length[c] = vector3_length(to[c]);
        for (int i = 1; i < 3; i++)
        {
            const double *a = to[0], *b = to[i], *c = to[i + 1], product = vector3_determinant(a, b, c);
            volume += product / 6;
            *angle += 2 * atan2(product, length[0] * length[i] * length[i + 1] + vector3_dot(a, b) * length[i + 1] +
                                             vector3_dot(b, c) * length[0] + vector3_dot(c, a) * length[i]);
        }
    }
    return volume;
}

/// Find the closed parts that are turned inside out, and the smallest solid around each.
static void find_voids(step_model *model)
{
    static const double HALF = ANGLE_TURN; // of all solid angles
    double angle;
    for (uint32_t p = 0, f = 0; p < model->piece_count; p++)
    {
        for (model->around[p] = p; model->pieces[f] != p;)
            f++;
        const double *place = model->patches[f].control;
        double smallest = INFINITY;
        bool hollow = model->closed[p] && measure_part(model, p, place, &angle) < 0;
        for (uint32_t q = 0; q < model->piece_count && hollow; q++)
        {
            double volume = measure_part(model, q, place, &angle);
            if (model->closed[q] && angle > HALF && volume < smallest)
            {
                smallest = volume;
                model->around[p] = q;
            }
        }
    }
}

static bat_status make_model(shell_builder *builder, bat_error *error)
{
    const bat_shell *shell = builder->shell;
    const bat_mesh *cage = &shell->cage;
    step_model *model = builder->model;
    size_t faces = shell->face_count, vertices = cage->vertex_count, edges = 4 * faces;
    memory_pool *pool = &model->pool;
    model->patches = calloc(faces, sizeof *model->patches);
    model->shell.edges = memory_pool_array(&model->shell.pool, edges, sizeof *model->shell.edges);
    model->shell.loops = memory_pool_array(&model->shell.pool, faces + 1, sizeof *model->shell.loops);
    model->shell.uses = memory_pool_array(&model->shell.pool, edges, sizeof *model->shell.uses);
    model->points = memory_pool_array(pool, vertices, 3 * sizeof *model->points);
    model->same = memory_pool_array(pool, vertices, sizeof *model->same);
    model->collapsed = memory_pool_zeros(pool, edges, sizeof *model->collapsed);
    model->knots = memory_pool_zeros(pool, edges, sizeof *model->knots);
    model->control = memory_pool_zeros(pool, edges, sizeof *model->control);
    model->pieces = memory_pool_array(pool, faces, sizeof *model->pieces);
    model->closed = memory_pool_array(pool, faces, sizeof *model->closed);
    model->around = memory_pool_array(pool, faces, sizeof *model->around);
    builder->edge_of = memory_pool_array(pool, builder->links.edge_count, sizeof *builder->edge_of);
    bat_status status = memory_pool_check(pool, error);
    if (status == BAT_OK)
        status = memory_pool_check(&model->shell.pool, error);
    if (status == BAT_OK && model->patches == NULL)
        status = error_memory(error, faces * sizeof *model->patches);
    if (status != BAT_OK)
        return status;
    model->shell.face_count = faces;
    memset(builder->edge_of, 0xff, builder->links.edge_count * sizeof *builder->edge_of);
    status = make_patches(builder, error);
    if (status == BAT_OK)
        status = make_edges(builder, error);
    if (status != BAT_OK)
        return status;
    find_pieces(model, faces);
    find_voids(model);
    // Vertices of the grid that no side begins at are no vertices of the shell: they stand for another one.
    memset(model->same, 0xff, vertices * sizeof *model->same);
    for (size_t e = 0; e < model->shell.edge_count; e++)
        for (int k = 0; k < 2; k++)
        {
            uint32_t vertex = k == 0 ? model->shell.edges[e].from : model->shell.edges[e].to;
            size_t at = k == 0 ? 0 : 2 * shell->spans + 1;
            memcpy(model->points + 3 * (size_t)vertex, model->control[e] + 3 * at, 3 * sizeof(double));
            model->same[vertex] = vertex;
        }
    model->shell.vertex_count = vertices;
    model->tolerance = model_tolerance(model->patches, faces);
    return BAT_OK;
}

bat_status shell_model_make(const bat_shell *shell, step_model *model, bat_error *error)
{
    step_model made = {0};
    shell_builder builder = {.shell = shell, .model = &made};
    const bat_mesh *cage = &shell->cage;
    bat_status status = sides_connect(&QUADS, cage->faces, cage->face_count, cage->vertex_count, &builder.links, error);
    if (status == BAT_OK)
        status = make_model(&builder, error);
    bat_mesh_connectivity_free(&builder.links);
    if (status == BAT_OK)
        *model = made;
    else
        step_model_free(&made);
    return status;
}
