#include "surface/fit/fit_nets.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>

bat_status fit_nets_make(const bat_hierarchical_space *space, const double *control, size_t dimension, int threads,
                         fit_nets *nets, bat_error *error)
{
    size_t cells = bat_hierarchical_space_cells(space), stride = hierarchical_locals(space) * dimension, numbers;
    *nets = (fit_nets){.space = space, .dimension = dimension, .stride = stride};
    if (size_multiply_overflows(cells, stride, &numbers))
        return error_memory(error, SIZE_MAX);
    nets->control = memory_array(numbers, sizeof *nets->control);
    if (nets->control == NULL)
        return error_memory(error, numbers * sizeof *nets->control);
    // As if every cell had as many coarser functions as local ones.
    double operations = (double)cells * (double)(hierarchical_locals(space) * stride);
#pragma omp parallel for schedule(static) num_threads(threads_worth(threads, cells, operations))
    for (size_t c = 0; c < cells; c++)
        hierarchical_local_control(space, &space->cells[c], control, dimension, nets->control + c * stride);
    return BAT_OK;
}

void fit_nets_free(fit_nets *nets)
{
    free(nets->control);
    *nets = (fit_nets){0};
}

static void measure_point(const fit_nets *nets, fit_points *points, size_t row, double *scratch, double *residual)
{
    size_t dimension = nets->dimension;
    const double *position = points->position + row * dimension;
    double *value = scratch + fit_nets_scratch(nets), square = 0;
    fit_nets_evaluate(nets, points->cell[row], points->parameter + 2 * row, 0, scratch, value);
    for (size_t k = 0; k < dimension; k++)
    {
        double apart = position[k] - value[k];
        square += apart * apart;
        if (residual != NULL)
            residual[row * dimension + k] = apart;
    }
    points->distance[row] = sqrt(square);
}

bat_status fit_nets_measure(const fit_nets *nets, fit_points *points, double *residual, int threads, bat_error *error)
{
    size_t room = fit_nets_scratch(nets) + nets->dimension;
    double operations = (double)points->count * fit_nets_operations(nets, 0);
    bool whole = true;
#pragma omp parallel num_threads(threads_worth(threads, points->count, operations)) reduction(&& : whole)
    {
        double *scratch = memory_array(room, sizeof *scratch);
        whole = scratch != NULL;
#pragma omp for schedule(static)
        for (size_t row = 0; row < points->count; row++)
            if (scratch != NULL)
                measure_point(nets, points, row, scratch, residual);
        free(scratch);
    }
    return whole ? BAT_OK : error_memory(error, room * sizeof(double));
}
