#include "io/surface/tessellate.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "base/memory.h"
#include "surface/cloud/delaunay.h"
#include "surface/cloud/neighbours.h"
#include "surface/trim/region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Tessellation of trimmed surfaces: a Delaunay triangulation of the grid's vertices inside and of points of the curves.
/// A curve is divided until no point lies in the circle over a part of it; the parts are then edges (Ruppert, 1995).

enum
{
    MAX_ROUNDS = 8, ///< divisions; at acute corners they would not end
    MAX_PARTS = 256 ///< of an edge of a polygon; more where points are near
};

/// Points of one curve after the other, in the plane of parameters times mean lengths of tangents.
typedef struct cut_points
{
    double (*places)[3]; ///< the third coordinate is zero, for the tree
    uint32_t *next;
    size_t count, place_capacity, next_capacity;
    double scale[2];
} cut_points;

static void cut_free(cut_points *cut)
{
    free(cut->places);
    free(cut->next);
}

static bool add_point(cut_points *cut, double x, double y, uint32_t next)
{
    void *places = cut->places, *links = cut->next;
    bool grown = array_grow(&places, &cut->place_capacity, cut->count + 1, sizeof *cut->places);
    cut->places = places;
    grown = grown && array_grow(&links, &cut->next_capacity, cut->count + 1, sizeof *cut->next);
    cut->next = links;
    if (!grown)
        return false;
    const double place[3] = {x, y, 0};
    memcpy(cut->places[cut->count], place, sizeof place);
    cut->next[cut->count++] = next;
    return true;
}

/// The width of a quad at a parameter.
static double step_at(const bat_spline_surface *surface, size_t samples, const cut_points *cut, double u, double v)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    bat_spline_box cell = bat_hierarchical_space_cell(surface->space, bat_hierarchical_space_locate(surface->space, u, v));
    double least = INFINITY;
    for (int d = 0; d < 2; d++)
    {
        size_t steps = samples > 0 ? samples : (size_t)options.degree[d] + 1;
        least = fmin(least, ldexp(cut->scale[d] / ((double)options.spans[d] * (double)steps), -(int)cell.level));
    }
    return least;
}

/// The polygons of the curves, with edges no longer than the quads beside them.
static bool add_polygons(const bat_spline_surface *surface, size_t samples, const trim_region *region, cut_points *cut)
{
    bool good = true;
    for (size_t l = 0; l < region->loop_count && good; l++)
    {
        size_t first = cut->count;
        for (size_t i = region->loops[l]; i < region->loops[l + 1] && good; i++)
        {
            const double *a = region->points[i], *b = region->points[trim_region_next(region, i)];
            double length = hypot((b[0] - a[0]) * cut->scale[0], (b[1] - a[1]) * cut->scale[1]);
            double step = step_at(surface, samples, cut, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
            size_t parts = length > step ? (size_t)fmin(ceil(length / step), MAX_PARTS) : 1;
            for (size_t k = 0; k < parts && good; k++)
            {
                double share = (double)k / (double)parts;
                good = add_point(cut, (a[0] + share * (b[0] - a[0])) * cut->scale[0],
                                 (a[1] + share * (b[1] - a[1])) * cut->scale[1], (uint32_t)cut->count + 1);
            }
        }
        if (good && cut->count > first)
            cut->next[cut->count - 1] = (uint32_t)first;
    }
    return good;
}

/// The middle of an edge, and half of its length.
static double middle_of(const cut_points *cut, size_t edge, double middle[3])
{
    const double *a = cut->places[edge], *b = cut->places[cut->next[edge]];
    for (int d = 0; d < 3; d++)
        middle[d] = (a[d] + b[d]) / 2;
    return hypot(b[0] - a[0], b[1] - a[1]) / 2;
}

/// Divide the edges whose circles hold other points of the curves. `divided` tells whether there were any.
static bat_status divide_edges(cut_points *cut, bool *divided, bat_error *error)
{
    neighbour_tree tree;
    neighbour_list near = {0};
    size_t count = cut->count;
    bat_status status = neighbour_tree_build(*cut->places, count, &tree, error);
    if (status != BAT_OK)
        return status;
    *divided = false;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        double middle[3], half = middle_of(cut, i, middle);
        uint32_t end = cut->next[i];
        bool split = false;
        status = neighbours_within(&tree, middle, half * (1 - 1e-9), &near, error);
        for (size_t k = 0; k < near.count && status == BAT_OK; k++)
            split = split || (near.entries[k].item != i && near.entries[k].item != end);
        if (!split || status != BAT_OK)
            continue;
        *divided = true;
        cut->next[i] = (uint32_t)cut->count;
        if (!add_point(cut, middle[0], middle[1], end))
            status = error_memory(error, cut->count * sizeof *cut->places);
    }
    neighbour_list_free(&near);
    neighbour_tree_free(&tree);
    return status;
}

/// The places of vertices of the grid that are inside, but not in the circle over an edge. `places` receives the points of
/// the curves, then those.
static bat_status gather_places(const surface_tessellation *grid, const trim_region *region, const cut_points *cut,
                                double (*places)[2], size_t *count, bat_error *error)
{
    neighbour_tree tree;
    neighbour_list near = {0};
    double(*inner)[3] = memory_array(grid->vertex_count, sizeof *inner);
    bool *left_out = calloc(grid->vertex_count + 1, sizeof *left_out);
    size_t made = 0;
    if (inner == NULL || left_out == NULL)
    {
        free(inner);
        free(left_out);
        return error_memory(error, grid->vertex_count * sizeof *inner);
    }
    for (size_t i = 0; i < grid->vertex_count; i++)
    {
        const double *u = grid->parameters + 2 * i;
        if (!trim_region_contains(region, u[0], u[1]))
            continue;
        inner[made][0] = u[0] * cut->scale[0];
        inner[made][1] = u[1] * cut->scale[1];
        inner[made++][2] = 0;
    }
    bat_status status = made > 0 ? neighbour_tree_build(*inner, made, &tree, error) : BAT_OK;
    for (size_t i = 0; i < cut->count && made > 0 && status == BAT_OK; i++)
    {
        double middle[3], half = middle_of(cut, i, middle);
        status = neighbours_within(&tree, middle, 1.1 * half, &near, error);
        for (size_t k = 0; k < near.count && status == BAT_OK; k++)
            left_out[near.entries[k].item] = true;
    }
    for (size_t i = 0; i < cut->count; i++)
        memcpy(places[i], cut->places[i], sizeof *places);
    *count = cut->count;
    for (size_t i = 0; i < made; i++)
        if (!left_out[i])
            memcpy(places[(*count)++], inner[i], sizeof *places);
    if (made > 0 && status != BAT_NO_MEMORY)
        neighbour_tree_free(&tree);
    neighbour_list_free(&near);
    free(inner);
    free(left_out);
    return status;
}

/// Replace the vertices and triangles.
static bat_status store(const bat_spline_surface *surface, const trim_region *region, const cut_points *cut,
                        const double (*places)[2], size_t count, surface_tessellation *made, bat_error *error)
{
    planar_triangles found;
    bat_status status = planar_delaunay(places, count, &found, error);
    if (status != BAT_OK)
        return status;
    surface_tessellation kept = {.triangles = found.corners,
                                 .parameters = memory_array(count, 2 * sizeof(double)),
                                 .levels = memory_array(found.count, sizeof *kept.levels)};
    uint32_t *numbers = memory_array(count, sizeof *numbers);
    if (kept.parameters == NULL || kept.levels == NULL || numbers == NULL)
        status = error_memory(error, count * 2 * sizeof(double));
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        numbers[i] = UINT32_MAX;
    for (size_t t = 0; t < found.count && status == BAT_OK; t++)
    {
        const uint32_t *corners = found.corners + 3 * t;
        double centre[2];
        for (int d = 0; d < 2; d++)
            centre[d] = (places[corners[0]][d] + places[corners[1]][d] + places[corners[2]][d]) / 3 / cut->scale[d];
        if (!trim_region_contains(region, centre[0], centre[1]))
            continue;
        for (size_t k = 0; k < 3; k++)
        {
            uint32_t *number = &numbers[corners[k]];
            if (*number == UINT32_MAX)
            {
                *number = (uint32_t)kept.vertex_count++;
                for (size_t d = 0; d < 2; d++)
                    kept.parameters[2 * (size_t)*number + d] = fmin(fmax(places[corners[k]][d] / cut->scale[d], 0), 1);
            }
            kept.triangles[3 * kept.triangle_count + k] = *number;
        }
        size_t cell = bat_hierarchical_space_locate(surface->space, centre[0], centre[1]);
        kept.levels[kept.triangle_count++] = bat_hierarchical_space_cell(surface->space, cell).level;
    }
    kept.grid_count = kept.vertex_count;
    free(numbers);
    if (status == BAT_OK)
        status = tessellation_evaluate(surface, &kept, error);
    if (status != BAT_OK)
    {
        tessellation_free(&kept);
        return status;
    }
    tessellation_free(made);
    *made = kept;
    return BAT_OK;
}

/// Mean lengths of tangents, as differences of the grid's vertices.
static void set_scale(const surface_tessellation *grid, double scale[2])
{
    double length[2] = {0, 0}, steps[2] = {0, 0};
    for (size_t q = 0; q < grid->quad_count; q++)
        for (size_t d = 0; d < 2; d++)
        {
            size_t a = grid->quads[4 * q], b = grid->quads[4 * q + 1 + 2 * d];
            double apart = 0;
            for (size_t c = 0; c < 3; c++)
                apart = hypot(apart, grid->positions[3 * b + c] - grid->positions[3 * a + c]);
            length[d] += apart;
            steps[d] += fabs(grid->parameters[2 * b + d] - grid->parameters[2 * a + d]);
        }
    for (int d = 0; d < 2; d++)
        scale[d] = steps[d] > 0 && length[d] > 0 && isfinite(length[d]) ? length[d] / steps[d] : 1;
    // Only their ratio matters.
    double larger = fmax(scale[0], scale[1]);
    scale[0] = fmax(scale[0] / larger, 1e-3);
    scale[1] = fmax(scale[1] / larger, 1e-3);
}

bat_status tessellation_cut(const bat_spline_surface *surface, size_t samples, surface_tessellation *made, bat_error *error)
{
    trim_region region;
    cut_points cut = {0};
    bat_status status = trim_region_make(&surface->trim, &region, error);
    if (status != BAT_OK)
        return status;
    set_scale(made, cut.scale);
    if (!add_polygons(surface, samples, &region, &cut))
        status = error_memory(error, cut.count * sizeof *cut.places);
    bool divided = true;
    for (int round = 0; round < MAX_ROUNDS && divided && status == BAT_OK; round++)
        status = divide_edges(&cut, &divided, error);
    double(*places)[2] = memory_array(cut.count + made->vertex_count, sizeof *places);
    size_t count = 0;
    if (status == BAT_OK && places == NULL)
        status = error_memory(error, (cut.count + made->vertex_count) * sizeof *places);
    if (status == BAT_OK)
        status = gather_places(made, &region, &cut, places, &count, error);
    if (status == BAT_OK)
        status = store(surface, &region, &cut, (const double(*)[2])places, count, made, error);
    free(places);
    cut_free(&cut);
    trim_region_free(&region);
    return status;
}
