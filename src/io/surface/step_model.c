#include "base/disjoint_sets.h"
#include "base/error.h"
#include "io/surface/step.h"

#include <math.h>
#include <string.h>

/// @file
/// Patches, edge curves and vertices of a surface for a STEP file. Corners of patches are sorted along lines of both
/// directions. Each side of a patch is then split at the vertices on it. The curve of an edge is a part of a patch's side.

// Topology

/// A corner. Sorted corners of a line are consecutive.
typedef struct shell_point
{
    uint64_t line, along;
    uint32_t vertex;
} shell_point;

typedef struct shell_builder
{
    const shell_face *faces;
    size_t face_count;
    shell_point *lines[2];   ///< all vertices along lines of u, and along lines of v
    uint32_t *edge_after[2]; ///< for each vertex: the edge that begins there along u, and along v
    size_t use_count;
    surface_shell *shell;
    memory_pool pool;
} shell_builder;

DEFINE_ORDER(compare_points, shell_point, line, along)

/// Collect all corners, each once, sorted along lines v = constant.
static bat_status find_vertices(shell_builder *builder, bat_error *error)
{
    size_t corners = 4 * builder->face_count, count = 0;
    shell_point *points = builder->lines[0] = memory_pool_array(&builder->pool, corners, sizeof *points);
    if (points == NULL)
        return memory_pool_check(&builder->pool, error);
    for (size_t i = 0; i < corners; i++)
    {
        const shell_face *face = &builder->faces[i / 4];
        points[i].line = i % 4 < 2 ? face->low[1] : face->high[1];
        points[i].along = i % 2 == 0 ? face->low[0] : face->high[0];
    }
    qsort(points, corners, sizeof *points, compare_points);
    for (size_t i = 0; i < corners; i++)
        if (i == 0 || compare_points(&points[i], &points[count - 1]) != 0)
        {
            points[count] = points[i];
            points[count].vertex = (uint32_t)count;
            count++;
        }
    builder->shell->vertex_count = count;
    return BAT_OK;
}

/// Sort the vertices along lines u = constant, and set their coordinates. At most two edges begin at a vertex, and each is
/// on the loops of at most two faces.
static bat_status sort_vertices(shell_builder *builder, bat_error *error)
{
    surface_shell *shell = builder->shell;
    size_t count = shell->vertex_count;
    builder->lines[1] = memory_pool_array(&builder->pool, count, sizeof *builder->lines[1]);
    builder->edge_after[0] = memory_pool_array(&builder->pool, count, sizeof **builder->edge_after);
    builder->edge_after[1] = memory_pool_array(&builder->pool, count, sizeof **builder->edge_after);
    shell->vertices = memory_pool_array(&shell->pool, count, 2 * sizeof *shell->vertices);
    shell->edges = memory_pool_array(&shell->pool, count, 2 * sizeof *shell->edges);
    shell->uses = memory_pool_array(&shell->pool, count, 4 * sizeof *shell->uses);
    shell->loops = memory_pool_array(&shell->pool, builder->face_count + 1, sizeof *shell->loops);
    bat_status status = memory_pool_check(&builder->pool, error);
    if (status == BAT_OK)
        status = memory_pool_check(&shell->pool, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count; i++)
    {
        const shell_point *point = &builder->lines[0][i];
        builder->lines[1][i] = (shell_point){point->along, point->line, point->vertex};
        builder->edge_after[0][i] = builder->edge_after[1][i] = SHELL_NONE;
        shell->vertices[2 * i] = point->along;
        shell->vertices[2 * i + 1] = point->line;
    }
    qsort(builder->lines[1], count, sizeof **builder->lines, compare_points);
    return BAT_OK;
}

/// The edge from a vertex to the next one on its line, as a part of a side of a face.
static uint32_t use_edge(shell_builder *builder, uint32_t direction, uint32_t from, uint32_t to, uint32_t face,
                         uint32_t side)
{
    surface_shell *shell = builder->shell;
    uint32_t *place = &builder->edge_after[direction][from];
    if (*place != SHELL_NONE)
    {
        shell->edges[*place].faces[1] = face;
        shell->edges[*place].sides[1] = side;
        return *place;
    }
    shell->edges[shell->edge_count] = (shell_edge){from, to, direction, {face, SHELL_NONE}, {side, side}};
    *place = (uint32_t)shell->edge_count++;
    return *place;
}

/// Append the edges of a side of a face to its loop.
static void add_side(shell_builder *builder, uint32_t face, uint32_t side)
{
    const shell_face *rectangle = &builder->faces[face];
    uint32_t direction = side % 2;
    const uint64_t *line = side == 1 || side == 2 ? rectangle->high : rectangle->low;
    const shell_point key = {.line = line[1 - direction], .along = rectangle->low[direction]};
    const shell_point *point =
        bsearch(&key, builder->lines[direction], builder->shell->vertex_count, sizeof key, compare_points);
    size_t first = builder->use_count;
    shell_use *uses = builder->shell->uses;
    for (; point->along < rectangle->high[direction]; point++)
        uses[builder->use_count++] =
            (shell_use){use_edge(builder, direction, point[0].vertex, point[1].vertex, face, side), side >= 2};
    // Two sides run against their direction; their edges are reversed.
    for (size_t i = first, j = builder->use_count; side >= 2 && i + 1 < j; i++)
    {
        shell_use use = uses[--j];
        uses[j] = uses[i];
        uses[i] = use;
    }
}

bat_status shell_make(const shell_face *faces, size_t count, surface_shell *shell, bat_error *error)
{
    static const int MAX_FACES = 1 << 29; // with four vertices each, all numbers fit into 32 bits
    if (count > MAX_FACES)
        return ERROR_TOO_LARGE(error, "%zu faces are more than %d", count, MAX_FACES);
    surface_shell made = {0};
    shell_builder builder = {.faces = faces, .face_count = count, .shell = &made};
    bat_status status = find_vertices(&builder, error);
    if (status == BAT_OK)
        status = sort_vertices(&builder, error);
    if (status == BAT_OK)
    {
        made.face_count = count;
        for (size_t f = 0; f < count; f++)
        {
            made.loops[f] = builder.use_count;
            for (uint32_t side = 0; side < 4; side++)
                add_side(&builder, (uint32_t)f, side);
        }
        made.loops[count] = builder.use_count;
    }
    memory_pool_free(&builder.pool);
    if (status == BAT_OK)
        *shell = made;
    else
        shell_free(&made);
    return status;
}

void shell_free(surface_shell *shell)
{
    memory_pool_free(&shell->pool);
    *shell = (surface_shell){0};
}

// Geometry

/// Make a shell of the rectangles of the patches on the grid of the finest level.
static bat_status make_shell(const bat_spline_surface *surface, step_model *model, size_t count, bat_error *error)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    size_t finest = bat_hierarchical_space_levels(surface->space) - 1;
    shell_face *faces = memory_array(count, sizeof *faces);
    if (faces == NULL)
        return error_memory(error, count * sizeof *faces);
    for (size_t i = 0; i < count; i++)
        for (int d = 0; d < 2; d++)
        {
            const bat_knot_vector *knots = &model->patches[i].knots[d];
            double cells = ldexp((double)options.spans[d], (int)finest);
            faces[i].low[d] = (uint64_t)llround(knots->knots[knots->degree] * cells);
            faces[i].high[d] = (uint64_t)llround(knots->knots[knot_vector_functions(knots)] * cells);
        }
    bat_status status = shell_make(faces, count, &model->shell, error);
    free(faces);
    return status;
}

/// The width of a span of a patch beside an edge, in cells of the finest level.
static uint64_t span_width(const step_model *model, const shell_edge *edge, int user)
{
    const tensor_surface *patch = &model->patches[edge->faces[user]];
    const surface_shell *shell = &model->shell;
    const shell_use *loop = shell->uses + shell->loops[edge->faces[user]];
    // The loop begins at the lower left corner; its third side begins at the upper right one.
    const uint64_t *low = shell->vertices + 2 * (size_t)shell->edges[loop->edge].from, *high = low;
    for (const shell_use *use = loop; !use->backward; use++)
        high = shell->vertices + 2 * (size_t)shell->edges[use->edge].to;
    const bat_knot_vector *knots = &patch->knots[edge->direction];
    return (high[edge->direction] - low[edge->direction]) / (knots->count - 2 * (size_t)knots->degree - 1);
}

static void copy_side(const tensor_surface *patch, uint32_t side, double *control)
{
    size_t columns = knot_vector_functions(&patch->knots[0]), rows = knot_vector_functions(&patch->knots[1]);
    size_t count = side % 2 == 0 ? columns : rows, step = side % 2 == 0 ? 1 : columns;
    size_t first = side == 1 ? columns - 1 : side == 2 ? columns * (rows - 1) : 0;
    for (size_t i = 0; i < count; i++)
        memcpy(control + 3 * i, patch->control + 3 * (first + i * step), 3 * sizeof *control);
}

/// Compute the curve of an edge from the finer of its patches, which has a knot at both ends of the edge.
static bat_status make_curve(step_model *model, size_t index, bat_error *error)
{
    const shell_edge *edge = &model->shell.edges[index];
    int user = edge->faces[1] != SHELL_NONE && span_width(model, edge, 1) < span_width(model, edge, 0) ? 1 : 0;
    const tensor_surface *patch = &model->patches[edge->faces[user]];
    const bat_knot_vector *knots = &patch->knots[edge->direction];
    const surface_shell *shell = &model->shell;
    uint64_t width = span_width(model, edge, user);
    uint64_t low =
        shell->vertices[2 * (size_t)shell->edges[shell->uses[shell->loops[edge->faces[user]]].edge].from + edge->direction];
    uint64_t from = (shell->vertices[2 * (size_t)edge->from + edge->direction] - low) / width;
    uint64_t to = (shell->vertices[2 * (size_t)edge->to + edge->direction] - low) / width;
    const double *first = knots->knots + knots->degree;
    bat_knot_vector *cut = &model->knots[index];
    bat_status status = knot_vector_cut(knots, first[from], first[to], cut, error);
    if (status != BAT_OK)
        return status;
    memory_pool pool = {0};
    tensor_surface side = {
        {*knots, {(double[]){0, 1}, 2, 0}}, memory_pool_array(&pool, knot_vector_functions(knots), 3 * sizeof(double)), 3};
    model->control[index] = memory_pool_array(&model->pool, knot_vector_functions(cut), 3 * sizeof(double));
    status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = memory_pool_check(&model->pool, error);
    if (status == BAT_OK)
    {
        copy_side(patch, edge->sides[user], side.control);
        tensor_surface_convert(&side, 0, cut, model->control[index]);
    }
    memory_pool_free(&pool);
    return status;
}

/// Set the positions of vertices from their first edges. Replace the ends of the other edges, which may differ by rounding.
static bat_status place_vertices(step_model *model, bat_error *error)
{
    const surface_shell *shell = &model->shell;
    model->points = memory_pool_array(&model->pool, shell->vertex_count, 3 * sizeof *model->points);
    bool *placed = memory_pool_zeros(&model->pool, shell->vertex_count, sizeof *placed);
    bat_status status = memory_pool_check(&model->pool, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < 2 * shell->edge_count; i++)
    {
        const shell_edge *edge = &shell->edges[i / 2];
        size_t vertex = i % 2 == 0 ? edge->from : edge->to;
        size_t last = i % 2 == 0 ? 0 : knot_vector_functions(&model->knots[i / 2]) - 1;
        double *end = model->control[i / 2] + 3 * last, *point = model->points + 3 * vertex;
        memcpy(placed[vertex] ? end : point, placed[vertex] ? point : end, 3 * sizeof *point);
        placed[vertex] = true;
    }
    return BAT_OK;
}

/// Find the edges that are collapsed to points. Their ends are one vertex.
static bat_status find_collapsed(step_model *model, bat_error *error)
{
    const surface_shell *shell = &model->shell;
    model->same = memory_pool_array(&model->pool, shell->vertex_count, sizeof *model->same);
    model->collapsed = memory_pool_array(&model->pool, shell->edge_count, sizeof *model->collapsed);
    bat_status status = memory_pool_check(&model->pool, error);
    if (status != BAT_OK)
        return status;
    sets_begin(model->same, shell->vertex_count);
    for (size_t e = 0; e < shell->edge_count; e++)
    {
        double farthest = 0;
        size_t points = knot_vector_functions(&model->knots[e]);
        for (size_t i = 0; i < 3 * points; i++)
            farthest = fmax(farthest, fabs(model->control[e][i] - model->control[e][i % 3]));
        model->collapsed[e] = farthest <= model->tolerance;
        if (model->collapsed[e])
            model->same[sets_root(model->same, shell->edges[e].to)] = sets_root(model->same, shell->edges[e].from);
    }
    for (size_t v = 0; v < shell->vertex_count; v++)
        model->same[v] = sets_root(model->same, (uint32_t)v);
    return BAT_OK;
}

bat_status step_model_make(const bat_spline_surface *surface, step_model *model, bat_error *error)
{
    size_t count = 0;
    step_model made = {0};
    bat_status status = spline_surface_patches(surface, &made.patches, &count, error);
    if (status != BAT_OK)
        return status;
    made.shell.face_count = count; // the count for step_model_free() after a failure
    status = make_shell(surface, &made, count, error);
    if (status == BAT_OK)
    {
        size_t edges = made.shell.edge_count;
        made.knots = memory_pool_zeros(&made.pool, edges, sizeof *made.knots);
        made.control = memory_pool_array(&made.pool, edges, sizeof *made.control);
        status = memory_pool_check(&made.pool, error);
        for (size_t e = 0; e < edges && status == BAT_OK; e++)
            status = make_curve(&made, e, error);
    }
    if (status == BAT_OK)
        status = place_vertices(&made, error);
    if (status == BAT_OK)
    {
        made.tolerance = model_tolerance(made.patches, made.shell.face_count);
        status = find_collapsed(&made, error);
    }
    if (status == BAT_OK)
        *model = made;
    else
        step_model_free(&made);
    return status;
}

void step_model_free(step_model *model)
{
    for (size_t i = 0; i < model->shell.face_count && model->patches != NULL; i++)
        tensor_surface_free(&model->patches[i]);
    free(model->patches);
    for (size_t e = 0; model->knots != NULL && e < model->shell.edge_count; e++)
        knot_vector_free(&model->knots[e]);
    memory_pool_free(&model->pool);
    shell_free(&model->shell);
    *model = (step_model){0};
}
