#include "surface/spline/hierarchical_space.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <stdlib.h>
#include <string.h>

bat_status bat_spline_surface_copy(const bat_spline_surface *surface, bat_spline_surface *copy, bat_error *error)
{
    bat_spline_surface made = {.dimension = surface->dimension};
    size_t count = bat_hierarchical_space_functions(surface->space) * surface->dimension;
    bat_status status = bat_hierarchical_space_copy(surface->space, &made.space, error);
    if (status != BAT_OK)
        return status;
    made.control = memory_array(count, sizeof *made.control);
    if (made.control == NULL)
    {
        bat_spline_surface_free(&made);
        return error_memory(error, count * sizeof *made.control);
    }
    memcpy(made.control, surface->control, count * sizeof *made.control);
    *copy = made;
    return BAT_OK;
}

void bat_spline_surface_free(bat_spline_surface *surface)
{
    bat_hierarchical_space_free(surface->space);
    free(surface->control);
    *surface = (bat_spline_surface){0};
}

/// Points sorted by the cells that hold them.
typedef struct cell_points
{
    uint32_t *cell; ///< of every point
    size_t *order;  ///< the points, cell by cell
    size_t *begin;  ///< cells + 1
} cell_points;

static void cell_points_free(cell_points *points)
{
    free(points->cell);
    free(points->order);
    free(points->begin);
}

static bat_status cell_points_make(const bat_hierarchical_space *space, const double *parameters, size_t count, int threads,
                                   cell_points *points, bat_error *error)
{
    *points = (cell_points){memory_array(count, sizeof *points->cell), memory_array(count, sizeof *points->order),
                            calloc(space->cell_count + 1, sizeof *points->begin)};
    if (points->cell == NULL || points->order == NULL || points->begin == NULL)
    {
        cell_points_free(points);
        return error_memory(error, count * sizeof *points->order);
    }
    (void)threads;
#pragma omp parallel for num_threads(threads) schedule(static)
    for (size_t i = 0; i < count; i++)
        points->cell[i] = (uint32_t)bat_hierarchical_space_locate(space, parameters[2 * i], parameters[2 * i + 1]);
    // Counting moves each beginning one cell on; sorting moves it back.
    for (size_t i = 0; i < count; i++)
        points->begin[points->cell[i]]++;
    size_t before = 0;
    for (size_t c = 0; c <= space->cell_count; c++)
        before = points->begin[c] += before;
    for (size_t i = count; i-- > 0;)
        points->order[--points->begin[points->cell[i]]] = i;
    return BAT_OK;
}

static bat_status check_parameters(const double *parameters, size_t count, int derivatives, bat_error *error)
{
    if (derivatives < 0 || derivatives > 2)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "derivatives of order %d are not among 0 to 2",
                         derivatives);
    for (size_t i = 0; i < count; i++)
        for (size_t d = 0; d < 2; d++)
            if (!(parameters[2 * i + d] >= 0 && parameters[2 * i + d] <= 1))
                return error_set(error, BAT_INVALID_POINT, i, 0, "parameter %zu, (%g, %g), is not in the unit square", i,
                                 parameters[2 * i], parameters[2 * i + 1]);
    return BAT_OK;
}

/// Evaluate at the points of one cell.
static void evaluate_cell(const bat_spline_surface *surface, size_t cell, const cell_points *points,
                          const double *parameters, int derivatives, double *scratch, double *values)
{
    const bat_hierarchical_space *space = surface->space;
    size_t dimension = surface->dimension, size = (derivatives == 0 ? 1 : derivatives == 1 ? 3 : 6) * dimension;
    double *local = scratch + 3 * ((size_t)space->options.degree[1] + 1) * dimension;
    if (points->begin[cell] == points->begin[cell + 1])
        return;
    hierarchical_local_control(space, &space->cells[cell], surface->control, dimension, local);
    for (size_t k = points->begin[cell]; k < points->begin[cell + 1]; k++)
    {
        size_t i = points->order[k];
        hierarchical_local_evaluate(space, &space->cells[cell], local, dimension, parameters[2 * i], parameters[2 * i + 1],
                                    derivatives, scratch, values + i * size);
    }
}

bat_status bat_spline_surface_evaluate(const bat_spline_surface *surface, const double *parameters, size_t count,
                                       int derivatives, double *values, bat_error *error)
{
    bat_status status = check_parameters(parameters, count, derivatives, error);
    if (status != BAT_OK)
        return status;
    const bat_hierarchical_space *space = surface->space;
    int threads = threads_for(0, count / 256);
    size_t room = (hierarchical_locals(space) + 3 * ((size_t)space->options.degree[1] + 1)) * surface->dimension;
    double *scratch = memory_array((size_t)threads * room, sizeof *scratch);
    if (scratch == NULL)
        return error_memory(error, (size_t)threads * room * sizeof *scratch);
    cell_points points;
    status = cell_points_make(space, parameters, count, threads, &points, error);
    if (status == BAT_OK)
    {
#pragma omp parallel for num_threads(threads) schedule(dynamic, 64)
        for (size_t c = 0; c < space->cell_count; c++)
            evaluate_cell(surface, c, &points, parameters, derivatives, scratch + (size_t)threads_current() * room, values);
        cell_points_free(&points);
    }
    free(scratch);
    return status;
}
