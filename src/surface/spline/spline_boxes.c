#include "surface/spline/hierarchical_space.h"

#include "base/array_grow.h"
#include "base/error.h"

#include <string.h>

/// @file
/// Sets of cells as few boxes: runs of the same columns in rows that follow each other are one.

/// The run of the row below with the same columns, if there is one.
static size_t run_below(const run_set *cells, const grid_run *run)
{
    size_t i = run_set_seek(cells, run->row + 1, run->begin);
    if (i == cells->count || cells->runs[i].row != run->row + 1 || cells->runs[i].begin != run->begin ||
        cells->runs[i].end != run->end)
        return cells->count;
    return i;
}

bat_status hierarchical_boxes(const run_set *cells, uint32_t level, bat_spline_box **boxes, size_t *count, size_t *capacity,
                              bat_error *error)
{
    bool *taken = calloc(cells->count + 1, sizeof *taken), made = taken != NULL;
    for (size_t i = 0; i < cells->count && made; i++)
    {
        const grid_run *run = &cells->runs[i];
        if (taken[i])
            continue;
        bat_spline_box box = {level, {run->begin, run->row}, {run->end, run->row + 1}};
        for (size_t next = run_below(cells, run); next < cells->count; next = run_below(cells, &cells->runs[next]))
        {
            taken[next] = true;
            box.high[1]++;
        }
        made = array_grow((void **)boxes, capacity, *count + 1, sizeof **boxes);
        if (made)
            (*boxes)[(*count)++] = box;
    }
    free(taken);
    return made ? BAT_OK : error_memory(error, (*count + 1) * sizeof **boxes);
}

bat_status bat_hierarchical_space_regions(const bat_hierarchical_space *space, bat_spline_box **boxes, size_t *count,
                                          bat_error *error)
{
    bat_spline_box *made = NULL;
    size_t made_count = 0, capacity = 0;
    // An array, even where there is one level only.
    bat_status status = array_grow((void **)&made, &capacity, 1, sizeof *made) ? BAT_OK : error_memory(error, sizeof *made);
    for (uint32_t l = 1; l < space->levels && status == BAT_OK; l++)
        status = hierarchical_boxes(&space->level[l].region, l, &made, &made_count, &capacity, error);
    if (status != BAT_OK)
    {
        free(made);
        return status;
    }
    *boxes = made;
    *count = made_count;
    return BAT_OK;
}
