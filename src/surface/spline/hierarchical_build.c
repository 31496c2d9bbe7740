#include "surface/spline/hierarchical_space.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>

/// @file
/// From the box tree to the active cells and the selected functions, level by level, as sets of runs.

/// Sort the boxes of the tree by level into runs of cells.
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

/// The region of a level and its functions: those that the region supports, of which those are selected that the refined
/// cells, which are the next region, do not support.
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

/// Go from the finest region, whose cells are all active, to the coarsest.
static bat_status make_levels(bat_hierarchical_space *space, bat_error *error)
{
    bool made = true;
    for (size_t l = space->levels; l-- > 0 && made;)
        made = make_level(space, l);
    return made ? BAT_OK : error_memory(error, sizeof(grid_run));
}

/// Number the places of a set after `*count` others.
static bat_status number_places(run_set *set, const char *what, size_t *count, bat_error *error)
{
    uint64_t size = run_set_size(set);
    if (size >= UINT32_MAX - *count)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the space would have more than %u %s", UINT32_MAX - 1,
                         what);
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

static void list_level(bat_hierarchical_space *space, uint32_t level)
{
    const run_set *cells = &space->level[level].cells, *selected = &space->level[level].selected;
    for (const grid_run *run = cells->runs; run < run_set_end(cells); run++)
        for (uint32_t i = run->begin; i < run->end; i++)
            space->cells[run->number + (i - run->begin)] = (hierarchical_cell){.column = i, .row = run->row, .level = level};
    for (const grid_run *run = selected->runs; run < run_set_end(selected); run++)
        for (uint32_t i = run->begin; i < run->end; i++)
            space->functions[run->number + (i - run->begin)] = (bat_spline_function){level, i, run->row};
}

bat_status hierarchical_build(bat_hierarchical_space *space, bat_error *error)
{
    bat_status status = collect_cells(space, error);
    if (status == BAT_OK)
        status = make_levels(space, error);
    if (status == BAT_OK)
        status = number_levels(space, error);
    if (status != BAT_OK)
        return status;
    space->cells = memory_array(space->cell_count, sizeof *space->cells);
    space->functions = memory_array(space->function_count, sizeof *space->functions);
    if (space->cells == NULL || space->functions == NULL)
        return error_memory(error, space->cell_count * sizeof *space->cells);
    for (size_t l = 0; l < space->levels; l++)
        list_level(space, (uint32_t)l);
    return hierarchical_extract(space, error);
}
