/// @file
/// Evaluation of basis functions and surfaces on the cells of a hierarchical space:
///     S(u, v) = sum_ab C_ab N_a(u) N_b(v)   on each cell, C = E^T control  (hierarchical_space.h).

#include "linalg/vector.h"
#include "surface/spline/hierarchical_space.h"
#include "surface/spline/tensor_surface.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <string.h>

#define MAX_LOCALS ((BAT_SPLINE_MAX_DEGREE + 1) * (BAT_SPLINE_MAX_DEGREE + 1))

/// The univariate functions of an active cell and their derivatives by u or v.
/// @param direction   0 for u, 1 for v
/// @param derivatives 0 to 2
/// @param values      receives (derivatives + 1) x (degree + 1) numbers
static void hierarchical_values(const bat_hierarchical_space *space, const hierarchical_cell *cell, int direction,
                                double parameter, int derivatives, double *values)
{
    size_t spans = hierarchical_spans(space, cell->level, direction), count = (size_t)space->options.degree[direction] + 1;
    size_t place = direction == 0 ? cell->column : cell->row;
    double scale = (double)spans, s = fma(parameter, scale, -(double)place), power = scale;
    uniform_basis_values(space->options.degree[direction], spans, place, s, derivatives, values);
    for (size_t d = 1; d <= (size_t)derivatives; d++, power *= scale)
        vector_scale(count, power, values + d * count);
}

/// Orders of derivatives with respect to u and v in each row of values: B, B_u, B_v, B_uu, B_uv, B_vv.
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
        vector_add(dimension, 1, control + active[k] * dimension, local + hierarchical_local(space, cell, k) * dimension);
}

/// Sum over the functions of u, then of v. Inlined, so that dimension 3 gets loops of constant length.
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
    double local[6 * MAX_LOCALS];
    hierarchical_local_values(space, found, u, v, derivatives, local);
    for (size_t k = 0; k < order_count(derivatives); k++)
        hierarchical_extract_products(space, found, local + k * locals, 1, values + k * found->active);
}

void bat_spline_surface_free(bat_spline_surface *surface)
{
    bat_hierarchical_space_free(surface->space);
    free(surface->control);
    spline_trim_free(&surface->trim);
    *surface = (bat_spline_surface){0};
}

/// Points sorted by the cells that contain them.
typedef struct cell_points
{
    memory_pool pool;
    uint32_t *cell; ///< cell of every point
    size_t *order;  ///< the points, cell by cell
    size_t *begin;  ///< cells + 1
} cell_points;

static bat_status cell_points_make(const bat_hierarchical_space *space, const double *parameters, size_t count,
                                   int threads BAT_UNUSED, cell_points *points, bat_error *error)
{
    *points = (cell_points){0};
    points->cell = memory_pool_array(&points->pool, count, sizeof *points->cell);
    points->order = memory_pool_array(&points->pool, count, sizeof *points->order);
    points->begin = memory_pool_zeros(&points->pool, space->cell_count + 1, sizeof *points->begin);
    bat_status status = memory_pool_check(&points->pool, error);
    if (status != BAT_OK)
        return status;
#pragma omp parallel for num_threads(threads) schedule(static)
    for (size_t i = 0; i < count; i++)
        points->cell[i] = (uint32_t)bat_hierarchical_space_locate(space, parameters[2 * i], parameters[2 * i + 1]);
    // Counting sort: offsets point to the ends of the cells, and move to their beginnings while points are placed.
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
        return ERROR_ARGUMENT(error, "the order of derivatives, %d, is not between 0 and 2", derivatives);
    for (size_t i = 0; i < count; i++)
        for (size_t d = 0; d < 2; d++)
            if (!(parameters[2 * i + d] >= 0 && parameters[2 * i + d] <= 1))
                return error_set(error, BAT_INVALID_POINT, i, 0, "parameter %zu, (%g, %g), is not in the unit square", i,
                                 parameters[2 * i], parameters[2 * i + 1]);
    return BAT_OK;
}

static void evaluate_cell(const bat_spline_surface *surface, size_t cell, const cell_points *points,
                          const double *parameters, int derivatives, double *scratch, double *values)
{
    const bat_hierarchical_space *space = surface->space;
    size_t dimension = surface->dimension, size = order_count(derivatives) * dimension;
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
    size_t scratch_size = (hierarchical_locals(space) + 3 * ((size_t)space->options.degree[1] + 1)) * surface->dimension;
    double *scratch = memory_array((size_t)threads * scratch_size, sizeof *scratch);
    if (scratch == NULL)
        return error_memory(error, (size_t)threads * scratch_size * sizeof *scratch);
    cell_points points;
    status = cell_points_make(space, parameters, count, threads, &points, error);
    if (status == BAT_OK)
    {
#pragma omp parallel for num_threads(threads) schedule(dynamic, 64)
        for (size_t c = 0; c < space->cell_count; c++)
            evaluate_cell(surface, c, &points, parameters, derivatives, scratch + (size_t)threads_current() * scratch_size,
                          values);
    }
    memory_pool_free(&points.pool);
    free(scratch);
    return status;
}
