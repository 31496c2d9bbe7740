#include "spline/hierarchical_space.h"

#include "base/array_grow.h"
#include "base/error.h"

#include <string.h>

/// @file
/// The extraction of the cells: what coarser functions are on a cell, in the cell's local functions. It is found level by level. On
/// the cell of level k that holds the active cell, each function of the basis up to level k is a row of numbers. The two-scale
/// relation says them in the functions of level k + 1; of the truncated basis those numbers are then set to zero that belong to
/// functions with support in region k + 1, and what has become zero is gone.

/// Where the last searches in a set of functions ended, one for each row of local functions.
typedef struct near_runs
{
    size_t row[BAT_SPLINE_MOST_DEGREE + 1];
} near_runs;

/// Rows in the making.
typedef struct extraction_rows
{
    double *values;    ///< of `room` rows
    uint32_t *indices; ///< of their functions
    uint32_t *numbers; ///< of the local functions of a cell
    uint32_t *own;     ///< of the active cell's local functions
    size_t count, room;
    near_runs supported[BAT_HIERARCHICAL_MOST_LEVELS], selected[BAT_HIERARCHICAL_MOST_LEVELS];
} extraction_rows;

/// The numbers in a set of functions of the local functions of a cell; UINT32_MAX for those not in it.
/// @return how many are in it
static size_t find_numbers(const bat_hierarchical_space *space, const run_set *functions, uint32_t column, uint32_t row,
                           near_runs *near, uint32_t *numbers)
{
    uint32_t columns = (uint32_t)space->options.degree[0] + 1, rows = (uint32_t)space->options.degree[1] + 1;
    size_t found = 0;
    memset(numbers, 0xff, hierarchical_locals(space) * sizeof *numbers);
    for (uint32_t b = 0; b < rows; b++)
    {
        size_t i = run_set_seek_near(functions, row + b, column, &near->row[b]);
        for (; i < functions->count; i++)
        {
            const grid_run *run = &functions->runs[i];
            if (run->row != row + b || run->begin >= column + columns)
                break;
            uint32_t begin = run->begin > column ? run->begin : column;
            uint32_t end = run->end < column + columns ? run->end : column + columns;
            for (uint32_t a = begin; a < end; a++)
                numbers[b * columns + (a - column)] = run->number + (a - run->begin);
            found += end - begin;
        }
    }
    return found;
}

/// One row, coefficients b (p + 1) + a, by both two-scale relations.
static void refine_row(const uniform_refinement *across, const uniform_refinement *along, size_t columns, size_t rows,
                       double *row)
{
    double half[(BAT_SPLINE_MOST_DEGREE + 1) * (BAT_SPLINE_MOST_DEGREE + 1)];
    memset(half, 0, columns * rows * sizeof *half);
    for (size_t b = 0; b < rows; b++)
        for (size_t a = 0; a < columns; a++)
        {
            double value = row[b * columns + a];
            const double *relation = across->rows + a * across->stride;
            for (size_t c = 0; c < columns && value != 0; c++)
                half[b * columns + c] += value * relation[c];
        }
    memset(row, 0, columns * rows * sizeof *row);
    for (size_t b = 0; b < rows; b++)
        for (size_t d = 0; d < rows; d++)
        {
            double value = along->rows[b * along->stride + d];
            for (size_t c = 0; c < columns && value != 0; c++)
                row[d * columns + c] += value * half[b * columns + c];
        }
}

void hierarchical_refine_rows(const bat_hierarchical_space *space, size_t level, uint32_t column, uint32_t row, size_t count,
                              double *rows)
{
    uniform_refinement across =
        uniform_basis_refinement(&space->bases[0], hierarchical_spans(space, level, 0), column / 2, column % 2);
    uniform_refinement along =
        uniform_basis_refinement(&space->bases[1], hierarchical_spans(space, level, 1), row / 2, row % 2);
    size_t locals = hierarchical_locals(space);
    for (size_t k = 0; k < count; k++)
        refine_row(&across, &along, (size_t)space->options.degree[0] + 1, (size_t)space->options.degree[1] + 1,
                   rows + k * locals);
}

/// Set the numbers of supported functions to zero, and drop the rows that are zero then.
static void truncate_rows(const uint32_t *supported, size_t locals, extraction_rows *rows)
{
    size_t kept = 0;
    for (size_t k = 0; k < rows->count; k++)
    {
        const double *row = rows->values + k * locals;
        double *to = rows->values + kept * locals;
        bool zero = true;
        for (size_t a = 0; a < locals; a++)
        {
            to[a] = supported[a] == UINT32_MAX ? row[a] : 0;
            zero = zero && to[a] == 0;
        }
        rows->indices[kept] = rows->indices[k];
        kept += !zero;
    }
    rows->count = kept;
}

/// Add the functions that a level selects, each being a local function there.
static void add_selected(const bat_hierarchical_space *space, size_t level, uint32_t column, uint32_t row,
                         extraction_rows *rows)
{
    size_t locals = hierarchical_locals(space);
    find_numbers(space, &space->level[level].selected, column, row, &rows->selected[level], rows->numbers);
    for (size_t a = 0; a < locals; a++)
    {
        if (rows->numbers[a] == UINT32_MAX)
            continue;
        double *values = rows->values + rows->count * locals;
        memset(values, 0, locals * sizeof *values);
        values[a] = 1;
        rows->indices[rows->count++] = rows->numbers[a];
    }
}

/// The finest level coarser than a cell's above which nothing is seen on the cell: in the truncated basis the last one whose functions
/// on it all have their support in its region.
static size_t first_level(const bat_hierarchical_space *space, const hierarchical_cell *cell, extraction_rows *rows)
{
    size_t level = space->options.truncated && cell->level > 0 ? cell->level - 1 : 0;
    for (; level > 0; level--)
    {
        uint32_t shift = cell->level - (uint32_t)level;
        if (find_numbers(space, &space->level[level].supported, cell->column >> shift, cell->row >> shift,
                         &rows->supported[level], rows->numbers) == hierarchical_locals(space))
            break;
    }
    return level;
}

/// Find what the coarser functions are on a cell.
static void find_coarse(const bat_hierarchical_space *space, const hierarchical_cell *cell, extraction_rows *rows)
{
    size_t locals = hierarchical_locals(space);
    for (size_t level = first_level(space, cell, rows); level < cell->level; level++)
    {
        uint32_t shift = cell->level - (uint32_t)level;
        add_selected(space, level, cell->column >> shift, cell->row >> shift, rows);
        uint32_t column = cell->column >> (shift - 1), row = cell->row >> (shift - 1);
        hierarchical_refine_rows(space, level, column, row, rows->count, rows->values);
        if (!space->options.truncated)
            continue;
        // On the active cell itself the next region supports nothing: what its region supports is selected.
        if (level + 1 < cell->level)
            find_numbers(space, &space->level[level + 1].supported, column, row, &rows->supported[level + 1], rows->numbers);
        truncate_rows(level + 1 < cell->level ? rows->numbers : rows->own, locals, rows);
    }
}

/// Put a cell's functions behind those of the cells before it.
static bool store_cell(bat_hierarchical_space *space, hierarchical_cell *cell, extraction_rows *rows)
{
    size_t locals = hierarchical_locals(space);
    size_t own = find_numbers(space, &space->level[cell->level].selected, cell->column, cell->row,
                              &rows->selected[cell->level], rows->own);
    rows->count = 0;
    if (own < locals || !space->options.truncated)
        find_coarse(space, cell, rows);
    *cell = (hierarchical_cell){.column = cell->column,
                                .row = cell->row,
                                .level = cell->level,
                                .active = (uint32_t)(rows->count + own),
                                .coarse = (uint32_t)rows->count,
                                .first = space->active_count,
                                .matrix = space->extraction_count};
    if (!array_grow((void **)&space->active, &space->active_capacity, space->active_count + cell->active,
                    sizeof *space->active) ||
        !array_grow((void **)&space->extraction, &space->extraction_capacity, space->extraction_count + rows->count * locals,
                    sizeof *space->extraction))
        return false;
    if (rows->count > 0)
        memcpy(space->extraction + space->extraction_count, rows->values, rows->count * locals * sizeof *rows->values);
    space->extraction_count += rows->count * locals;
    memcpy(space->active + space->active_count, rows->indices, rows->count * sizeof *rows->indices);
    space->active_count += rows->count;
    for (size_t a = 0; a < locals; a++)
        if (rows->own[a] != UINT32_MAX)
            space->active[space->active_count++] = rows->own[a];
    space->most_active = cell->active > space->most_active ? cell->active : space->most_active;
    return true;
}

bat_status hierarchical_extract(bat_hierarchical_space *space, bat_error *error)
{
    size_t locals = hierarchical_locals(space), room = space->levels * locals;
    extraction_rows rows = {.room = room,
                            .values = memory_array(room * locals, sizeof *rows.values),
                            .indices = memory_array(room, sizeof *rows.indices),
                            .numbers = memory_array(locals, sizeof *rows.numbers),
                            .own = memory_array(locals, sizeof *rows.own)};
    bool made = rows.values != NULL && rows.indices != NULL && rows.numbers != NULL && rows.own != NULL;
    for (size_t i = 0; i < space->cell_count && made; i++)
        made = store_cell(space, &space->cells[i], &rows);
    free(rows.values);
    free(rows.indices);
    free(rows.numbers);
    free(rows.own);
    return made ? BAT_OK : error_memory(error, (space->extraction_count + room * locals) * sizeof *rows.values);
}
