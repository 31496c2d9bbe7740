#include "surface/surface_distance.h"

#include "base/error.h"
#include "base/memory.h"
#include "surface/cloud/neighbours.h"

#include <math.h>
#include <stdlib.h>

enum
{
    SAMPLES = 5 ///< of a cell
};

/// Corners and middle of all cells.
static double *sample_cells(const bat_hierarchical_space *space, size_t cells)
{
    static const double AT[SAMPLES][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 0.5}};
    bat_hierarchical_options options = bat_hierarchical_space_options(space);
    double *parameters = memory_array(cells, SAMPLES * 2 * sizeof *parameters);
    for (size_t c = 0; c < cells && parameters != NULL; c++)
    {
        bat_spline_box cell = bat_hierarchical_space_cell(space, c);
        for (size_t s = 0; s < SAMPLES; s++)
            for (size_t d = 0; d < 2; d++)
                parameters[2 * (c * SAMPLES + s) + d] =
                    fmin((cell.low[d] + AT[s][d]) / ldexp((double)options.spans[d], (int)cell.level), 1);
    }
    return parameters;
}

static bat_status measure(const double *places, size_t count, const neighbour_tree *tree, double *stray, bat_error *error)
{
    neighbour_list list = {0};
    bat_status status = BAT_OK;
    *stray = 0;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(tree, places + 3 * i, 1, &list, error);
        if (status == BAT_OK)
            *stray = fmax(*stray, sqrt(list.entries[0].squared));
    }
    neighbour_list_free(&list);
    return status;
}

bat_status surface_distance(const bat_spline_surface *surface, const double *points, size_t count, double *stray,
                            bat_error *error)
{
    size_t cells = bat_hierarchical_space_cells(surface->space), samples = cells * SAMPLES;
    neighbour_tree tree;
    bat_status status = neighbour_tree_build(points, count, &tree, error);
    if (status != BAT_OK)
        return status;
    double *parameters = sample_cells(surface->space, cells), *places = memory_array(samples, 3 * sizeof *places);
    if (parameters == NULL || places == NULL)
        status = error_memory(error, samples * 5 * sizeof *places);
    if (status == BAT_OK)
        status = bat_spline_surface_evaluate(surface, parameters, samples, 0, places, error);
    if (status == BAT_OK)
        status = measure(places, samples, &tree, stray, error);
    free(parameters);
    free(places);
    neighbour_tree_free(&tree);
    return status;
}
