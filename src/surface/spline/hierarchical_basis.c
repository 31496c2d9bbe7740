#include "surface/spline/hierarchical_space.h"

#include <math.h>
#include <string.h>

/// @file
/// The functions of a space at a parameter: those of the cell's own level, times the cell's extraction.

enum
{
    MOST_LOCALS = (BAT_SPLINE_MAX_DEGREE + 1) * (BAT_SPLINE_MAX_DEGREE + 1)
};

void hierarchical_values(const bat_hierarchical_space *space, const hierarchical_cell *cell, int direction, double parameter,
                         int derivatives, double *values)
{
    size_t spans = hierarchical_spans(space, cell->level, direction), count = (size_t)space->options.degree[direction] + 1;
    size_t place = direction == 0 ? cell->column : cell->row;
    double scale = (double)spans, s = fma(parameter, scale, -(double)place), power = scale;
    uniform_basis_values(space->options.degree[direction], spans, place, s, derivatives, values);
    for (size_t d = 1; d <= (size_t)derivatives; d++, power *= scale)
        for (size_t a = 0; a < count; a++)
            values[d * count + a] *= power;
}

/// Which derivatives by u and v a row of values holds: B, B_u, B_v, B_uu, B_uv, B_vv.
static const struct
{
    uint8_t u, v;
} ORDERS[6] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};

static size_t order_count(int derivatives)
{
    return derivatives == 0 ? 1 : derivatives == 1 ? 3 : 6;
}

void hierarchical_local_values(const bat_hierarchical_space *space, const hierarchical_cell *cell, double u, double v,
                               int derivatives, double *values)
{
    size_t columns = (size_t)space->options.degree[0] + 1, rows = (size_t)space->options.degree[1] + 1;
    double across[3 * (BAT_SPLINE_MAX_DEGREE + 1)], along[3 * (BAT_SPLINE_MAX_DEGREE + 1)];
    hierarchical_values(space, cell, 0, u, derivatives, across);
    hierarchical_values(space, cell, 1, v, derivatives, along);
    for (size_t k = 0; k < order_count(derivatives); k++)
    {
        const double *x = across + ORDERS[k].u * columns, *y = along + ORDERS[k].v * rows;
        for (size_t b = 0; b < rows; b++)
            for (size_t a = 0; a < columns; a++)
                *values++ = x[a] * y[b];
    }
}

void hierarchical_extract_products(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                   size_t dimension, double *active)
{
    size_t locals = hierarchical_locals(space);
    const double *row = hierarchical_extraction(space, cell);
    for (size_t k = 0; k < cell->coarse; k++, row += locals)
        for (size_t d = 0; d < dimension; d++)
        {
            double sum = 0;
            for (size_t a = 0; a < locals; a++)
                sum += row[a] * local[a * dimension + d];
            active[k * dimension + d] = sum;
        }
    for (size_t k = cell->coarse; k < cell->active; k++)
        memcpy(active + k * dimension, local + hierarchical_local(space, cell, k) * dimension, dimension * sizeof *active);
}

void hierarchical_extract_matrix(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                 double *scratch, double *active)
{
    size_t locals = hierarchical_locals(space), count = cell->active;
    hierarchical_extract_products(space, cell, local, locals, scratch);
    for (size_t k = 0; k < count; k++)
        hierarchical_extract_products(space, cell, scratch + k * locals, 1, active + k * count);
}

void hierarchical_local_control(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *control,
                                size_t dimension, double *local)
{
    size_t locals = hierarchical_locals(space);
    const uint32_t *active = space->active + cell->first;
    const double *row = hierarchical_extraction(space, cell);
    memset(local, 0, locals * dimension * sizeof *local);
    for (size_t k = 0; k < cell->coarse; k++, row += locals)
        for (size_t a = 0; a < locals; a++)
            for (size_t d = 0; d < dimension && row[a] != 0; d++)
                local[a * dimension + d] += row[a] * control[active[k] * dimension + d];
    for (size_t k = cell->coarse; k < cell->active; k++)
    {
        double *to = local + hierarchical_local(space, cell, k) * dimension;
        for (size_t d = 0; d < dimension; d++)
            to[d] += control[active[k] * dimension + d];
    }
}

/// Sums over the functions of u, and then of v; inlined, so that surfaces in space get loops of known length.
static inline void evaluate_sums(const double *across, size_t columns, const double *along, size_t rows, const double *local,
                                 size_t dimension, int derivatives, double *scratch, double *values)
{
    for (size_t u = 0; u <= (size_t)derivatives; u++)
        for (size_t b = 0; b < rows; b++)
        {
            double *sum = scratch + (u * rows + b) * dimension;
            const double *control = local + b * columns * dimension;
            for (size_t d = 0; d < dimension; d++)
                sum[d] = across[u * columns] * control[d];
            for (size_t a = 1; a < columns; a++)
                for (size_t d = 0; d < dimension; d++)
                    sum[d] += across[u * columns + a] * control[a * dimension + d];
        }
    for (size_t k = 0; k < order_count(derivatives); k++)
    {
        const double *y = along + ORDERS[k].v * rows, *sums = scratch + ORDERS[k].u * rows * dimension;
        for (size_t d = 0; d < dimension; d++)
        {
            double sum = y[0] * sums[d];
            for (size_t b = 1; b < rows; b++)
                sum += y[b] * sums[b * dimension + d];
            values[k * dimension + d] = sum;
        }
    }
}

void hierarchical_local_evaluate(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                 size_t dimension, double u, double v, int derivatives, double *scratch, double *values)
{
    size_t columns = (size_t)space->options.degree[0] + 1, rows = (size_t)space->options.degree[1] + 1;
    double across[3 * (BAT_SPLINE_MAX_DEGREE + 1)], along[3 * (BAT_SPLINE_MAX_DEGREE + 1)];
    hierarchical_values(space, cell, 0, u, derivatives, across);
    hierarchical_values(space, cell, 1, v, derivatives, along);
    if (dimension == 3)
        evaluate_sums(across, columns, along, rows, local, 3, derivatives, scratch, values);
    else
        evaluate_sums(across, columns, along, rows, local, dimension, derivatives, scratch, values);
}

void bat_hierarchical_space_basis(const bat_hierarchical_space *space, size_t cell, double u, double v, int derivatives,
                                  double *values)
{
    const hierarchical_cell *found = &space->cells[cell];
    size_t locals = hierarchical_locals(space);
    if (found->coarse == 0 && found->active == locals)
    {
        hierarchical_local_values(space, found, u, v, derivatives, values);
        return;
    }
    double local[6 * MOST_LOCALS];
    hierarchical_local_values(space, found, u, v, derivatives, local);
    for (size_t k = 0; k < order_count(derivatives); k++)
        hierarchical_extract_products(space, found, local + k * locals, 1, values + k * found->active);
}
