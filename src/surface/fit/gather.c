/// @file
/// Sums over points in the normal equations; see system.h.
///
///     G = sum over cells c of E_c^T (sum over blocks of points on c of G_block) E_c,   the same for b.
///
/// A cell's sum is made of the sums of its blocks, in their order, so that processes may divide the points between blocks.
/// Each process completes the cells of which it has all points. It sends the sums of blocks for the others, which the first
/// process adds up.

#include "surface/fit/system.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "surface/spline/hierarchical_space.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct gather_context
{
    const fit_system *system;
    const fit_points *points;
    size_t columns; ///< right-hand sides
    double *sent;   ///< contributions for the first process; null without others
    size_t *first;  ///< cells + 1: offsets of the cells in `sent`
} gather_context;

/// A pseudo-random sign of point and probe: one bit of the finalizer of splitmix64 (Steele, Lea and Flood, 2014).
static double random_sign(uint32_t number, size_t probe)
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
        loads[k] = root * random_sign(points->number[row], k - dimension);
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
        for (size_t k = 0; k < columns; k++)
            right[i * columns + k] += values[i] * loads[k];
    }
}

/// Whether evaluating the active functions at each point costs less than first assembling in the local functions.
static bool extract_points_first(size_t points, size_t locals, size_t coarse, size_t active)
{
    return points * (coarse * locals + active * active / 2) < points * locals * locals / 2 + 2 * coarse * locals * active;
}

/// How the sums of a cell are made: in its active functions, or in the local ones of its level.
typedef struct cell_sums
{
    const hierarchical_cell *cell;
    size_t index;
    bool active;
    size_t side; ///< number of these functions
} cell_sums;

static cell_sums sums_of(const gather_context *gather, size_t index)
{
    const bat_hierarchical_space *space = gather->system->space;
    const hierarchical_cell *cell = &space->cells[index];
    size_t locals = hierarchical_locals(space);
    bool active = extract_points_first(fit_points_of_cell(gather->points, index), locals, cell->coarse, cell->active);
    return (cell_sums){cell, index, active, active ? cell->active : locals};
}

/// Numbers of a side x side matrix and of its right-hand sides.
static size_t numbers_of(const gather_context *gather, size_t side)
{
    return side * (side + gather->columns);
}

/// The same with the lower triangle alone.
static size_t packed_of(const gather_context *gather, size_t side)
{
    return side * (side + 1) / 2 + side * gather->columns;
}

/// The largest number of functions in sums of cells.
static size_t max_side(const gather_context *gather)
{
    size_t locals = hierarchical_locals(gather->system->space);
    size_t active = hierarchical_space_max_active(gather->system->space);
    return active > locals ? active : locals;
}

/// Size of the workspace of fill_block() and finish_cell().
static size_t scratch_of(const gather_context *gather)
{
    size_t locals = hierarchical_locals(gather->system->space);
    return gather->columns + locals + max_side(gather) * (locals + 1);
}

/// Sum over points of a cell that are of one block: places begin to end - 1 of their order.
static void fill_block(const gather_context *gather, const cell_sums *sums, size_t begin, size_t end, double *scratch,
                       double *numbers)
{
    const bat_hierarchical_space *space = gather->system->space;
    const fit_points *points = gather->points;
    double *loads = scratch, *values = loads + gather->columns, *active = values + hierarchical_locals(space);
    double *matrix = numbers, *right = numbers + sums->side * sums->side;
    memset(numbers, 0, numbers_of(gather, sums->side) * sizeof *numbers);
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

static void mirror(size_t side, double *matrix)
{
    for (size_t i = 0; i < side; i++)
        for (size_t j = 0; j < i; j++)
            matrix[j * side + i] = matrix[i * side + j];
}

/// The contribution of a cell, in its active functions, from its sums.
static void finish_cell(const gather_context *gather, const cell_sums *sums, double *numbers, double *scratch,
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
    mirror(sums->side, numbers);
    hierarchical_extract_matrix(space, sums->cell, numbers, scratch, matrix);
}

/// Sum all blocks of a cell that are here.
/// @param scratch receives the sums first; scratch_of() and twice numbers_of(max_side()) numbers
static void fill_sums(const gather_context *gather, const cell_sums *sums, double *scratch)
{
    const fit_points *points = gather->points;
    size_t size = numbers_of(gather, sums->side), begin = points->first[sums->index], end = points->first[sums->index + 1];
    double *total = scratch, *block = total + size, *rest = block + size;
    memset(total, 0, size * sizeof *total);
    for (bool first = true; begin < end; first = false)
    {
        size_t next = fit_points_block_end(points, begin, end);
        fill_block(gather, sums, begin, next, rest, first ? total : block);
        for (size_t k = 0; !first && k < size; k++)
            total[k] += block[k];
        begin = next;
    }
}

static void fill_cell(const void *context, size_t index, double *scratch, double *matrix, double *right)
{
    const gather_context *gather = context;
    cell_sums sums = sums_of(gather, index);
    fill_sums(gather, &sums, scratch);
    finish_cell(gather, &sums, scratch, scratch + numbers_of(gather, sums.side), matrix, right);
}

// Several processes.

/// What goes before the numbers of a cell.
typedef struct sent_head
{
    uint32_t cell;
    uint32_t blocks; ///< sums of so many blocks; 0: the complete contribution
} sent_head;

_Static_assert(sizeof(sent_head) == sizeof(double), "a head takes the place of a number");

static bool is_complete(const fit_points *points, size_t cell)
{
    return points->first[cell + 1] - points->first[cell] == fit_points_of_cell(points, cell);
}

static uint32_t blocks_of(const fit_points *points, size_t cell)
{
    uint32_t blocks = 0;
    for (size_t begin = points->first[cell], end = points->first[cell + 1]; begin < end; blocks++)
        begin = fit_points_block_end(points, begin, end);
    return blocks;
}

/// Append the lower triangle of the matrix and the right-hand sides.
static double *pack(const gather_context *gather, size_t side, double *numbers, double *to)
{
    for (size_t i = 0; i < side; i++, to += i)
        memcpy(to, numbers + i * side, (i + 1) * sizeof *to);
    memcpy(to, numbers + side * side, side * gather->columns * sizeof *to);
    return to + side * gather->columns;
}

static const double *add_packed(const gather_context *gather, size_t side, const double *from, double *numbers)
{
    for (size_t i = 0; i < side; i++, from += i)
        for (size_t j = 0; j <= i; j++)
            numbers[i * side + j] += from[j];
    double *right = numbers + side * side;
    for (size_t k = 0; k < side * gather->columns; k++)
        right[k] += from[k];
    return from + side * gather->columns;
}

static void send_cell(const gather_context *gather, size_t cell, double *scratch)
{
    const fit_points *points = gather->points;
    cell_sums sums = sums_of(gather, cell);
    size_t begin = points->first[cell], end = points->first[cell + 1], active = sums.cell->active;
    bool complete = is_complete(points, cell);
    sent_head head = {(uint32_t)cell, complete ? 0 : blocks_of(points, cell)};
    double *to = gather->sent + gather->first[cell];
    if (begin == end)
        return;
    memcpy(to++, &head, sizeof head);
    if (complete)
    {
        double *contribution = scratch, *rest = contribution + numbers_of(gather, active);
        fill_cell(gather, cell, rest, contribution, contribution + active * active);
        (void)pack(gather, active, contribution, to);
        return;
    }
    while (begin < end)
    {
        size_t next = fit_points_block_end(points, begin, end);
        fill_block(gather, &sums, begin, next, scratch + numbers_of(gather, sums.side), scratch);
        to = pack(gather, sums.side, scratch, to);
        begin = next;
    }
}

static bat_status fill_sent(gather_context *gather, size_t scratch_size, int threads, bat_error *error)
{
    const fit_points *points = gather->points;
    size_t cells = points->cells;
    gather->first = memory_array(cells + 1, sizeof *gather->first);
    if (gather->first == NULL)
        return error_memory(error, (cells + 1) * sizeof *gather->first);
    gather->first[0] = 0;
    for (size_t c = 0; c < cells; c++)
    {
        size_t size = 0;
        cell_sums sums = sums_of(gather, c);
        if (points->first[c] < points->first[c + 1])
            size = 1 + (is_complete(points, c) ? packed_of(gather, sums.cell->active)
                                               : blocks_of(points, c) * packed_of(gather, sums.side));
        gather->first[c + 1] = gather->first[c] + size;
    }
    gather->sent = memory_array(gather->first[cells] + 1, sizeof *gather->sent);
    if (gather->sent == NULL)
        return error_memory(error, gather->first[cells] * sizeof *gather->sent);
    double operations = (double)points->count * 300;
    bool allocated = true;
#pragma omp parallel num_threads(threads_worth(threads, (cells + 15) / 16, operations)) reduction(&& : allocated)
    {
        double *scratch = memory_array(scratch_size, sizeof *scratch);
        allocated = scratch != NULL;
#pragma omp for schedule(dynamic, 16)
        for (size_t c = 0; c < cells; c++)
            if (scratch != NULL)
                send_cell(gather, c, scratch);
        free(scratch);
    }
    return allocated ? BAT_OK : error_memory(error, scratch_size * sizeof(double));
}

/// What the first process has received of one rank and not yet read.
typedef struct received_part
{
    const double *at, *end;
} received_part;

/// The contribution of a cell from what all ranks have sent.
static void receive_cell(const gather_context *gather, size_t cell, received_part *parts, double *scratch, double *numbers)
{
    cell_sums sums = sums_of(gather, cell);
    size_t active = sums.cell->active, size = numbers_of(gather, sums.side);
    memset(scratch, 0, size * sizeof *scratch);
    memset(numbers, 0, numbers_of(gather, active) * sizeof *numbers);
    bool summed = false;
    for (size_t rank = 0; rank < group_count(gather->points->group); rank++)
    {
        received_part *part = &parts[rank];
        sent_head head;
        if (part->at == part->end)
            continue;
        memcpy(&head, part->at, sizeof head);
        if (head.cell != cell)
            continue;
        part->at++;
        if (head.blocks == 0)
            part->at = add_packed(gather, active, part->at, numbers);
        for (uint32_t k = 0; k < head.blocks; k++)
            part->at = add_packed(gather, sums.side, part->at, scratch);
        summed = summed || head.blocks > 0;
    }
    if (summed)
        finish_cell(gather, &sums, scratch, scratch + size, numbers, numbers + active * active);
}

static bat_status collect_cells(const void *context, size_t begin, size_t end, const size_t *place, double *numbers,
                                bat_error *error)
{
    const gather_context *gather = context;
    const bat_group *group = gather->points->group;
    size_t *sizes = NULL, side = max_side(gather), offset = 0;
    char *all = NULL;
    bat_status status = group_gather(group, gather->sent + gather->first[begin],
                                     (gather->first[end] - gather->first[begin]) * sizeof(double), &sizes, &all, error);
    if (status == BAT_OK && group_is_first(group))
    {
        received_part *parts = memory_array(group_count(group), sizeof *parts);
        double *scratch = memory_array(numbers_of(gather, side) + scratch_of(gather), sizeof *scratch);
        if (parts == NULL || scratch == NULL)
            status = error_memory(error, numbers_of(gather, side) * sizeof *scratch);
        for (size_t rank = 0; status == BAT_OK && rank < group_count(group); offset += sizes[rank++])
            parts[rank] = (received_part){(const double *)(const void *)(all + offset),
                                          (const double *)(const void *)(all + offset + sizes[rank])};
        for (size_t c = begin; status == BAT_OK && c < end; c++)
            receive_cell(gather, c, parts, scratch, numbers + place[c - begin]);
        free(parts);
        free(scratch);
    }
    free(sizes);
    free(all);
    return status;
}

/// The terms of a point in the sums: w |x|^2, and 1 for a point with positive weight.
static void square_terms(const void *context, size_t row, double *sums)
{
    const fit_points *points = context;
    double square = 0;
    for (size_t k = 0; k < points->dimension; k++)
        square += points->position[row * points->dimension + k] * points->position[row * points->dimension + k];
    sums[0] += points->weight[row] * square;
    sums[1] += points->weight[row] > 0 && points->number[row] < points->own;
}

bat_status fit_system_gather(fit_system *system, const fit_points *points, bat_error *error)
{
    double sums[2];
    bat_status status = fit_sum_points(points->group, points->count, square_terms, points, 2, system->threads, sums, error);
    if (status != BAT_OK)
        return status;
    system->square = sums[0];
    system->counted = (size_t)sums[1];
    size_t locals = hierarchical_locals(system->space);
    gather_context gather = {.system = system, .points = points, .columns = system->columns};
    size_t scratch = 3 * numbers_of(&gather, max_side(&gather)) + scratch_of(&gather);
    bool together = group_count(points->group) > 1;
    if (together)
        status = fill_sent(&gather, scratch, system->threads, error);
    fit_cell_work work = {.fill = fill_cell,
                          .collect = together ? collect_cells : NULL,
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
