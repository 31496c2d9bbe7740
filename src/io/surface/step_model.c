#include "base/error.h"
#include "base/memory.h"
#include "io/surface/cut.h"
#include "io/surface/step.h"
#include "io/surface/trimmed_model.h"
#include "surface/spline/knot_vector.h"
#include "surface/spline/tensor_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Patches, edge curves and vertices of a surface for a STEP file. The curve of an edge is a part of a patch's side.

static size_t first_knot(const bat_knot_vector *knots)
{
    return (size_t)knots->degree;
}

static size_t span_count(const bat_knot_vector *knots)
{
    return knots->count - 2 * (size_t)knots->degree - 1;
}

/// The rectangle of a patch on the grid of the finest level.
static shell_face face_of(const tensor_surface *patch, const bat_hierarchical_options *options, size_t finest)
{
    shell_face face;
    for (int d = 0; d < 2; d++)
    {
        const bat_knot_vector *knots = &patch->knots[d];
        double cells = ldexp((double)options->spans[d], (int)finest);
        face.low[d] = (uint64_t)llround(knots->knots[first_knot(knots)] * cells);
        face.high[d] = (uint64_t)llround(knots->knots[first_knot(knots) + span_count(knots)] * cells);
    }
    return face;
}

static bat_status make_shell(const bat_spline_surface *surface, step_model *model, size_t count, bat_error *error)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    size_t finest = bat_hierarchical_space_levels(surface->space) - 1;
    shell_face *faces = memory_array(count, sizeof *faces);
    if (faces == NULL)
        return error_memory(error, count * sizeof *faces);
    for (size_t i = 0; i < count; i++)
        faces[i] = face_of(&model->patches[i], &options, finest);
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
    return (high[edge->direction] - low[edge->direction]) / span_count(&patch->knots[edge->direction]);
}

/// Copy the control points of a side of a patch.
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
    size_t count = knot_vector_functions(knots);
    double *side = memory_array(count, 3 * sizeof *side);
    if (side == NULL)
        return error_memory(error, count * 3 * sizeof *side);
    copy_side(patch, edge->sides[user], side);
    bat_knot_vector *cut = &model->knots[index];
    bat_status status =
        cut_knots(knots, knots->knots[first_knot(knots) + from], knots->knots[first_knot(knots) + to], cut, error);
    if (status == BAT_OK)
    {
        size_t points = knot_vector_functions(cut);
        model->control[index] = memory_array(points, 3 * sizeof *side);
        status = model->control[index] != NULL ? cut_control(knots, cut, side, 3, model->control[index], error)
                                               : error_memory(error, points * 3 * sizeof *side);
    }
    free(side);
    return status;
}

static double *last_point(const step_model *model, size_t edge)
{
    return model->control[edge] + 3 * (knot_vector_functions(&model->knots[edge]) - 1);
}

/// Set the positions of vertices from their first edges. Replace the ends of the other edges, which may differ by rounding.
static bat_status place_vertices(step_model *model, bat_error *error)
{
    const surface_shell *shell = &model->shell;
    model->points = memory_array(shell->vertex_count, 3 * sizeof *model->points);
    bool *placed = calloc(shell->vertex_count, sizeof *placed);
    if (model->points == NULL || placed == NULL)
    {
        free(placed);
        return error_memory(error, shell->vertex_count * 3 * sizeof *model->points);
    }
    for (size_t i = 0; i < 2 * shell->edge_count; i++)
    {
        const shell_edge *edge = &shell->edges[i / 2];
        size_t vertex = i % 2 == 0 ? edge->from : edge->to;
        double *end = i % 2 == 0 ? model->control[i / 2] : last_point(model, i / 2), *point = model->points + 3 * vertex;
        if (!placed[vertex])
            memcpy(point, end, 3 * sizeof *point);
        else
            memcpy(end, point, 3 * sizeof *point);
        placed[vertex] = true;
    }
    free(placed);
    return BAT_OK;
}

static uint32_t representative(const uint32_t *same, uint32_t vertex)
{
    while (same[vertex] != vertex)
        vertex = same[vertex];
    return vertex;
}

/// Find the edges that are collapsed to points. Their ends are one vertex.
static bat_status find_collapsed(step_model *model, bat_error *error)
{
    const surface_shell *shell = &model->shell;
    model->same = memory_array(shell->vertex_count, sizeof *model->same);
    model->collapsed = memory_array(shell->edge_count, sizeof *model->collapsed);
    if (model->same == NULL || model->collapsed == NULL)
        return error_memory(error, shell->vertex_count * sizeof *model->same);
    for (size_t v = 0; v < shell->vertex_count; v++)
        model->same[v] = (uint32_t)v;
    for (size_t e = 0; e < shell->edge_count; e++)
    {
        double farthest = 0;
        size_t points = knot_vector_functions(&model->knots[e]);
        for (size_t i = 0; i < 3 * points; i++)
            farthest = fmax(farthest, fabs(model->control[e][i] - model->control[e][i % 3]));
        model->collapsed[e] = farthest <= model->tolerance;
        if (model->collapsed[e])
            model->same[representative(model->same, shell->edges[e].to)] = representative(model->same, shell->edges[e].from);
    }
    for (size_t v = 0; v < shell->vertex_count; v++)
        model->same[v] = representative(model->same, (uint32_t)v);
    return BAT_OK;
}

static bat_status make_curves(step_model *model, bat_error *error)
{
    size_t count = model->shell.edge_count;
    model->knots = calloc(count, sizeof *model->knots);
    model->control = calloc(count, sizeof *model->control);
    bat_status status =
        model->knots == NULL || model->control == NULL ? error_memory(error, count * sizeof *model->knots) : BAT_OK;
    for (size_t e = 0; e < count && status == BAT_OK; e++)
        status = make_curve(model, e, error);
    return status;
}

bat_status step_model_make(const bat_spline_surface *surface, step_model *model, bat_error *error)
{
    size_t count = 0;
    step_model made = {0};
    bat_status status = spline_surface_patches(surface, &made.patches, &count, error);
    if (status != BAT_OK)
        return status;
    made.shell.face_count = count; // the count for step_model_free() after a failure
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = cut_clamp(&made.patches[i], error);
    if (status == BAT_OK)
        status = make_shell(surface, &made, count, error);
    if (status == BAT_OK)
        status = make_curves(&made, error);
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
    for (size_t e = 0; e < model->shell.edge_count; e++)
    {
        if (model->knots != NULL)
            knot_vector_free(&model->knots[e]);
        if (model->control != NULL)
            free(model->control[e]);
    }
    free(model->knots);
    free(model->control);
    free(model->points);
    free(model->same);
    free(model->collapsed);
    shell_free(&model->shell);
    *model = (step_model){0};
}
