/// @file
/// Construction of a hierarchical space from its box tree: regions, active cells, basis functions, extraction.
///
/// With B_l the B-splines of level l and O_l the region of level l, the basis (Kraft, 1997) is
///     { B in B_l : supp B is in O_l but not in O_l+1, l = 0, 1, … }.
/// The extraction is computed from level to level. On every cell of a level, each active function of coarser levels is a row
/// of coefficients in local functions. Rows of a refined cell, extended by the functions selected on its level, are
/// converted to its quarters by the two-scale relation. For the truncated basis, coefficients of functions with support in
/// the next region are then set to zero, and zero rows are dropped.

#include "surface/spline/hierarchical_space.h"

#include "base/array_grow.h"
#include "base/error.h"

/// Convert the boxes of the tree to runs of cells for each level.
static bat_status collect_cells(bat_hierarchical_space *space, bat_error *error)
{
    box_tree_leaf *leaves;
    size_t count;
    bat_status status = box_tree_leaves(&space->tree, &leaves, &count, error);
    if (status != BAT_OK)
        return status;
    bool made = true;
    for (size_t i = 0; i < count && made; i++)
    {
        const box_tree_leaf *leaf = &leaves[i];
        int shift = BAT_HIERARCHICAL_MAX_LEVELS - 1 - leaf->level;
        run_set *cells = &space->level[leaf->level].cells;
        for (uint64_t row = leaf->area.low[1] >> shift; row < leaf->area.high[1] >> shift && made; row++)
            made = run_set_append(cells, (uint32_t)row, (uint32_t)(leaf->area.low[0] >> shift),
                                  (uint32_t)(leaf->area.high[0] >> shift));
        space->levels = leaf->level >= space->levels ? (size_t)leaf->level + 1 : space->levels;
    }
    for (size_t l = 0; l < space->levels; l++)
        run_set_sort(&space->level[l].cells);
    free(leaves);
    return made ? BAT_OK : error_memory(error, count * sizeof *leaves);
}

/// Region, supported and selected functions of a level. Selected are the functions supported in the region but not in its
/// refined part.
static bool make_level(bat_hierarchical_space *space, size_t level)
{
    uint32_t size[2] = {(uint32_t)hierarchical_spans(space, level, 0), (uint32_t)hierarchical_spans(space, level, 1)};
    hierarchical_level *made = &space->level[level];
    run_set replaced = {0};
    bool all = (level + 1 == space->levels || run_set_halve(&made[1].region, &made->refined)) &&
               run_set_unite(&made->cells, &made->refined, &made->region) &&
               run_set_supports(&made->region, size, space->options.degree, &made->supported) &&
               run_set_supports(&made->refined, size, space->options.degree, &replaced) &&
               run_set_subtract(&made->supported, &replaced, &made->selected);
    run_set_free(&replaced);
    return all;
}

/// Number the elements of a set from `*count` on.
static bat_status number_places(run_set *set, const char *what, size_t *count, bat_error *error)
{
    uint64_t size = run_set_size(set);
    if (size >= UINT32_MAX - *count)
        return ERROR_TOO_LARGE(error, "the space would have more than %u %s", UINT32_MAX - 1, what);
    run_set_number(set, (uint32_t)*count);
    *count += (size_t)size;
    return BAT_OK;
}

static bat_status number_levels(bat_hierarchical_space *space, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t l = 0; l < space->levels && status == BAT_OK; l++)
    {
        hierarchical_level *level = &space->level[l];
        size_t supported = 0, refined = 0;
        status = number_places(&level->cells, "cells", &space->cell_count, error);
        if (status == BAT_OK)
            status = number_places(&level->refined, "cells", &refined, error);
        if (status == BAT_OK)
            status = number_places(&level->supported, "functions", &supported, error);
        if (status == BAT_OK)
            status = number_places(&level->selected, "functions", &space->function_count, error);
    }
    return status;
}

/// The rows of all refined cells of a level.
typedef struct refined_rows
{
    double *values;
    uint32_t *indices; ///< of the functions
    size_t *first;     ///< cells + 1; null before level 0
    size_t count, value_capacity, index_capacity;
} refined_rows;

/// Results of the previous searches in a set, one for each row of local functions.
typedef struct run_hints
{
    size_t row[BAT_SPLINE_MAX_DEGREE + 1];
} run_hints;

typedef struct cell_rows
{
    memory_pool pool;
    double *values;      ///< max_rows x locals
    uint32_t *indices;   ///< of the functions
    uint32_t *supported; ///< numbers of the local functions in the set of supported functions
    uint32_t *selected;
    size_t count;
    run_hints hint_supported, hint_selected, hint_parent;
} cell_rows;

/// Find the numbers of a cell's local functions in a set of functions; UINT32_MAX for those not in the set.
/// @return the number of local functions in the set
static size_t local_numbers(const bat_hierarchical_space *space, const run_set *functions, uint32_t column, uint32_t row,
                            run_hints *hints, uint32_t *numbers)
{
    uint32_t columns = (uint32_t)space->options.degree[0] + 1, rows = (uint32_t)space->options.degree[1] + 1;
    size_t found = 0;
    memset(numbers, 0xff, hierarchical_locals(space) * sizeof *numbers);
    for (uint32_t b = 0; b < rows; b++)
    {
        size_t i = run_set_lower_bound_from(functions, row + b, column, &hints->row[b]);
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

/// Apply both two-scale relations to one row, with coefficient b (p + 1) + a.
static void refine_row(const uniform_refinement *across, const uniform_refinement *along, size_t columns, size_t rows,
                       double *row)
{
    double half[(BAT_SPLINE_MAX_DEGREE + 1) * (BAT_SPLINE_MAX_DEGREE + 1)];
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

/// Truncate: set the coefficients of supported functions to zero, and drop rows that become zero.
static void truncate_rows(const uint32_t *supported, size_t locals, cell_rows *rows)
{
    size_t count = 0;
    for (size_t k = 0; k < rows->count; k++)
    {
        const double *row = rows->values + k * locals;
        double *to = rows->values + count * locals;
        bool zero = true;
        for (size_t a = 0; a < locals; a++)
        {
            to[a] = supported[a] == UINT32_MAX ? row[a] : 0;
            zero = zero && to[a] == 0;
        }
        rows->indices[count] = rows->indices[k];
        count += !zero;
    }
    rows->count = count;
}

/// Compute the rows of a cell from those of the refined cell of which it is a quarter.
/// @param supported numbers of the cell's local functions; not used for the plain basis
static void refine_parent_rows(const bat_hierarchical_space *space, size_t level, uint32_t column, uint32_t row,
                               const uint32_t *supported, const refined_rows *parents, cell_rows *rows)
{
    size_t locals = hierarchical_locals(space);
    const run_set *refined = &space->level[level - 1].refined;
    const grid_run *run = &refined->runs[run_set_lower_bound_from(refined, row / 2, column / 2, &rows->hint_parent.row[0])];
    size_t parent = run->number + (column / 2 - run->begin), first = parents->first[parent];
    rows->count = parents->first[parent + 1] - first;
    if (rows->count == 0 || parents->values == NULL)
        return;
    memcpy(rows->values, parents->values + first * locals, rows->count * locals * sizeof *rows->values);
    memcpy(rows->indices, parents->indices + first, rows->count * sizeof *rows->indices);
    hierarchical_refine_rows(space, level - 1, column, row, rows->count, rows->values);
    if (space->options.truncated)
        truncate_rows(supported, locals, rows);
}

/// Append the selected functions of the cell's level as unit rows.
static void add_selected(size_t locals, cell_rows *rows)
{
    for (size_t a = 0; a < locals; a++)
    {
        if (rows->selected[a] == UINT32_MAX)
            continue;
        double *values = rows->values + rows->count * locals;
        memset(values, 0, locals * sizeof *values);
        values[a] = 1;
        rows->indices[rows->count++] = rows->selected[a];
    }
}

static bool store_refined(const bat_hierarchical_space *space, size_t level, uint32_t column, uint32_t row,
                          const refined_rows *parents, cell_rows *rows, refined_rows *stored)
{
    size_t locals = hierarchical_locals(space);
    const hierarchical_level *sets = &space->level[level];
    size_t supported = local_numbers(space, &sets->supported, column, row, &rows->hint_supported, rows->supported);
    local_numbers(space, &sets->selected, column, row, &rows->hint_selected, rows->selected);
    rows->count = 0;
    if (parents->first != NULL && (supported < locals || !space->options.truncated))
        refine_parent_rows(space, level, column, row, rows->supported, parents, rows);
    add_selected(locals, rows);
    size_t count = stored->count + rows->count;
    if (!ARRAY_GROW(stored->values, stored->value_capacity, count * locals) ||
        !ARRAY_GROW(stored->indices, stored->index_capacity, count))
        return false;
    if (rows->count > 0)
    {
        memcpy(stored->values + stored->count * locals, rows->values, rows->count * locals * sizeof *rows->values);
        memcpy(stored->indices + stored->count, rows->indices, rows->count * sizeof *rows->indices);
    }
    stored->count = count;
    return true;
}

/// Compute and append the extraction and the active functions of an active cell. On an active cell, all supported local
/// functions are selected.
static bool store_cell(bat_hierarchical_space *space, hierarchical_cell *cell, const refined_rows *parents, cell_rows *rows)
{
    size_t locals = hierarchical_locals(space), level = cell->level;
    size_t own =
        local_numbers(space, &space->level[level].selected, cell->column, cell->row, &rows->hint_selected, rows->selected);
    rows->count = 0;
    if (parents->first != NULL && (own < locals || !space->options.truncated))
        refine_parent_rows(space, level, cell->column, cell->row, rows->selected, parents, rows);
    cell->active = (uint32_t)(rows->count + own);
    cell->coarse = (uint32_t)rows->count;
    cell->first = space->active_count;
    cell->matrix = space->extraction_count;
    if (!ARRAY_GROW(space->active, space->active_capacity, space->active_count + cell->active) ||
        !ARRAY_GROW(space->extraction, space->extraction_capacity, space->extraction_count + rows->count * locals))
        return false;
    if (rows->count > 0)
    {
        memcpy(space->extraction + cell->matrix, rows->values, rows->count * locals * sizeof *rows->values);
        memcpy(space->active + cell->first, rows->indices, rows->count * sizeof *rows->indices);
    }
    space->extraction_count += rows->count * locals;
    uint32_t *next = space->active + cell->first + rows->count;
    for (size_t a = 0; a < locals; a++)
        if (rows->selected[a] != UINT32_MAX)
            *next++ = rows->selected[a];
    space->active_count += cell->active;
    space->max_active = cell->active > space->max_active ? cell->active : space->max_active;
    return true;
}

/// Extraction of all cells of a level, from the rows of the level before.
static bool extract_level(bat_hierarchical_space *space, size_t level, const refined_rows *parents, cell_rows *rows,
                          refined_rows *stored)
{
    const run_set *refined = &space->level[level].refined, *cells = &space->level[level].cells;
    rows->hint_supported = rows->hint_selected = rows->hint_parent = (run_hints){0};
    stored->count = 0;
    free(stored->first);
    stored->first = memory_array((size_t)run_set_size(refined) + 1, sizeof *stored->first);
    bool made = stored->first != NULL;
    for (const grid_run *run = refined->runs; run < run_set_end(refined) && made; run++)
        for (uint32_t i = run->begin; i < run->end && made; i++)
        {
            stored->first[run->number + (i - run->begin)] = stored->count;
            made = store_refined(space, level, i, run->row, parents, rows, stored);
        }
    if (made)
        stored->first[run_set_size(refined)] = stored->count;
    for (const grid_run *run = cells->runs; run < run_set_end(cells) && made; run++)
        for (uint32_t i = run->begin; i < run->end && made; i++)
            made = store_cell(space, &space->cells[run->number + (i - run->begin)], parents, rows);
    return made;
}

static bat_status hierarchical_extract(bat_hierarchical_space *space, bat_error *error)
{
    size_t locals = hierarchical_locals(space), max_rows = space->levels * locals;
    cell_rows rows = {0};
    rows.values = memory_pool_array(&rows.pool, max_rows * locals, sizeof *rows.values);
    rows.indices = memory_pool_array(&rows.pool, max_rows, sizeof *rows.indices);
    rows.supported = memory_pool_array(&rows.pool, locals, sizeof *rows.supported);
    rows.selected = memory_pool_array(&rows.pool, locals, sizeof *rows.selected);
    refined_rows levels[2] = {{0}};
    bool made = rows.pool.missing == 0;
    for (size_t l = 0; l < space->levels && made; l++)
        made = extract_level(space, l, &levels[(l + 1) % 2], &rows, &levels[l % 2]);
    for (size_t k = 0; k < 2; k++)
    {
        free(levels[k].values);
        free(levels[k].indices);
        free(levels[k].first);
    }
    memory_pool_free(&rows.pool);
    return made ? BAT_OK : error_memory(error, (space->extraction_count + max_rows * locals) * sizeof *rows.values);
}

bat_status hierarchical_number(bat_hierarchical_space *space, bat_error *error)
{
    bat_status status = collect_cells(space, error);
    // From the finest level, whose cells are all active, to the coarsest.
    for (size_t l = space->levels; l-- > 0 && status == BAT_OK;)
        status = make_level(space, l) ? BAT_OK : error_memory(error, sizeof(grid_run));
    return status == BAT_OK ? number_levels(space, error) : status;
}

bat_status hierarchical_build(bat_hierarchical_space *space, bat_error *error)
{
    space->cells = memory_array(space->cell_count, sizeof *space->cells);
    space->functions = memory_array(space->function_count, sizeof *space->functions);
    if (space->cells == NULL || space->functions == NULL)
        return error_memory(error, space->cell_count * sizeof *space->cells);
    for (size_t l = 0; l < space->levels; l++)
    {
        uint32_t level = (uint32_t)l;
        const run_set *cells = &space->level[level].cells, *selected = &space->level[level].selected;
        for (const grid_run *run = cells->runs; run < run_set_end(cells); run++)
            for (uint32_t i = run->begin; i < run->end; i++)
                space->cells[run->number + (i - run->begin)] =
                    (hierarchical_cell){.column = i, .row = run->row, .level = level};
        for (const grid_run *run = selected->runs; run < run_set_end(selected); run++)
            for (uint32_t i = run->begin; i < run->end; i++)
                space->functions[run->number + (i - run->begin)] = (bat_spline_function){level, i, run->row};
    }
    return hierarchical_extract(space, error);
}
