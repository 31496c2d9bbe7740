/// @file
/// Sums over points in the normal equations; see system.h.
///
///     G = sum over cells c of E_c^T (sum over blocks of points on c of G_block) E_c,   the same for b.
///
/// A cell's sum is made of the sums of its blocks, in their order, so that processes may divide the points between blocks.

#include "surface/fit/system.h"

#include <string.h>

double fit_random_sign(uint32_t number, size_t probe)
{
    uint64_t z = ((uint64_t)probe << 32 | number) * UINT64_C(0x9e3779b97f4a7c15) + UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (z ^ z >> 31) >> 63 != 0 ? 1 : -1;
}

/// The coefficients of a point in the right-hand sides: w x for the coordinates, sqrt(w) z for the probes.
static void set_loads(const gather_context *gather, size_t row, double *loads)
{
    const fit_points *points = gather->points;
    size_t dimension = points->dimension;
    double weight = points->weight[row], root = sqrt(weight);
    for (size_t k = 0; k < dimension; k++)
        loads[k] = weight * points->position[row * dimension + k];
    for (size_t k = dimension; k < gather->columns; k++)
        loads[k] = root * fit_random_sign(points->number[row], k - dimension);
}

/// Add the contribution of a point with `count` function values to the lower triangle and the right-hand sides.
static void add_point(size_t count, const double *values, double weight, const double *loads, size_t columns, double *matrix,
                      double *right)
{
    for (size_t i = 0; i < count; i++)
    {
        double scaled = weight * values[i];
        for (size_t j = 0; j <= i; j++)
            matrix[i * count + j] += scaled * values[j];
        vector_add(columns, values[i], loads, right + i * columns);
    }
}

/// Whether evaluating the active functions at each point costs less than first assembling in the local functions.
static bool extract_points_first(size_t points, size_t locals, size_t coarse, size_t active)
{
    return points * (coarse * locals + active * active / 2) < points * locals * locals / 2 + 2 * coarse * locals * active;
}

cell_sums gather_sums_of(const gather_context *gather, size_t index)
{
    const bat_hierarchical_space *space = gather->system->space;
    const hierarchical_cell *cell = &space->cells[index];
    size_t locals = hierarchical_locals(space);
    bool active = extract_points_first(fit_points_of_cell(gather->points, index), locals, cell->coarse, cell->active);
    return (cell_sums){cell, index, active, active ? cell->active : locals};
}

size_t gather_numbers_of(const gather_context *gather, size_t side)
{
    return side * (side + gather->columns);
}

size_t gather_max_side(const gather_context *gather)
{
    size_t locals = hierarchical_locals(gather->system->space);
    size_t active = hierarchical_space_max_active(gather->system->space);
    return active > locals ? active : locals;
}

size_t gather_scratch_of(const gather_context *gather)
{
    size_t locals = hierarchical_locals(gather->system->space);
    return gather->columns + locals + gather_max_side(gather) * (locals + 1);
}

void gather_fill_block(const gather_context *gather, const cell_sums *sums, size_t begin, size_t end, double *scratch,
                       double *numbers)
{
    const bat_hierarchical_space *space = gather->system->space;
    const fit_points *points = gather->points;
    double *loads = scratch, *values = loads + gather->columns, *active = values + hierarchical_locals(space);
    double *matrix = numbers, *right = numbers + sums->side * sums->side;
    memset(numbers, 0, gather_numbers_of(gather, sums->side) * sizeof *numbers);
    for (size_t place = begin; place < end; place++)
    {
        size_t row = points->order[place];
        const double *at = points->parameter + 2 * row;
        hierarchical_local_values(space, sums->cell, at[0], at[1], 0, values);
        if (sums->active)
            hierarchical_extract_products(space, sums->cell, values, 1, active);
        set_loads(gather, row, loads);
        add_point(sums->side, sums->active ? active : values, points->weight[row], loads, gather->columns, matrix, right);
    }
}

void gather_finish_cell(const gather_context *gather, const cell_sums *sums, double *numbers, double *scratch,
                        double *matrix, double *right)
{
    const bat_hierarchical_space *space = gather->system->space;
    size_t active = sums->cell->active;
    double *from = numbers + sums->side * sums->side;
    if (sums->active)
    {
        memcpy(matrix, numbers, active * active * sizeof *matrix);
        memcpy(right, from, active * gather->columns * sizeof *right);
        return;
    }
    hierarchical_extract_products(space, sums->cell, from, gather->columns, right);
    for (size_t i = 0; i < sums->side; i++)
        for (size_t j = 0; j < i; j++)
            numbers[j * sums->side + i] = numbers[i * sums->side + j];
    hierarchical_extract_matrix(space, sums->cell, numbers, scratch, matrix);
}

void gather_fill_cell(const void *context, size_t index, double *scratch, double *matrix, double *right)
{
    const gather_context *gather = context;
    const fit_points *points = gather->points;
    cell_sums sums = gather_sums_of(gather, index);
    size_t size = gather_numbers_of(gather, sums.side), begin = points->first[index], end = points->first[index + 1];
    double *total = scratch, *block = total + size, *rest = block + size;
    memset(total, 0, size * sizeof *total);
    for (bool first = true; begin < end; first = false)
    {
        size_t next = fit_points_block_end(points, begin, end);
        gather_fill_block(gather, &sums, begin, next, rest, first ? total : block);
        for (size_t k = 0; !first && k < size; k++)
            total[k] += block[k];
        begin = next;
    }
    gather_finish_cell(gather, &sums, total, block, matrix, right);
}

/// The terms of a point in the sums: w |x|^2, and 1 for a point with positive weight.
static void square_terms(const void *context, size_t row, double *sums)
{
    const fit_points *points = context;
    sums[0] += points->weight[row] * vector_square(points->dimension, points->position + row * points->dimension);
    sums[1] += points->weight[row] > 0 && points->number[row] < points->own;
}

bat_status fit_system_gather(fit_system *system, const fit_points *points, bat_error *error)
{
    double sums[2];
    bat_status status = fit_sum_points(points->team, points->count, square_terms, points, 2, system->threads, sums, error);
    if (status != BAT_OK)
        return status;
    system->square = sums[0];
    system->counted = (size_t)sums[1];
    size_t locals = hierarchical_locals(system->space);
    gather_context gather = {.system = system, .points = points, .columns = system->columns};
    size_t scratch = 3 * gather_numbers_of(&gather, gather_max_side(&gather)) + gather_scratch_of(&gather);
    bool together = team_count(points->team) > 1;
    if (together)
        status = points->team->begin_cells(&gather, scratch, system->threads, error);
    fit_cell_work work = {.fill = gather_fill_cell,
                          .collect = together ? points->team->collect_cells : NULL,
                          .context = &gather,
                          .scratch = scratch,
                          .columns = gather.columns,
                          .operations = (double)points->count * (double)(100 + locals * locals),
                          .values = system->gram,
                          .right = system->right};
    if (status == BAT_OK)
        status = fit_pattern_sum(&system->pattern, system->space, &work, system->threads, error);
    free(gather.sent);
    free(gather.first);
    return status;
}
