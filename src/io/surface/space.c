#include "io/surface/formats.h"
#include "surface/spline/hierarchical_space.h"

/// @file
/// Hierarchical spline spaces from the boxes of refined cells in files.

static bat_status check_box(const bat_hierarchical_options *options, const surface_box *box, bat_error *error)
{
    if (box->level >= BAT_HIERARCHICAL_MAX_LEVELS)
        return ERROR_FILE(error, box->line, "the box is of level %llu, above %d", (unsigned long long)box->level,
                          BAT_HIERARCHICAL_MAX_LEVELS - 1);
    for (int d = 0; d < 2; d++)
    {
        uint64_t cells = surface_level_cells(options, box->level, d);
        if (cells > UINT32_MAX)
            return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, box->line, "the grid of level %llu has 2^32 cells or more",
                             (unsigned long long)box->level);
        if (box->low[d] >= box->high[d] || box->high[d] > cells)
            return ERROR_FILE(error, box->line, "the box from %llu to %llu is empty or exceeds the %llu cells of its level",
                              (unsigned long long)box->low[d], (unsigned long long)box->high[d], (unsigned long long)cells);
    }
    return BAT_OK;
}

/// Check the number of cells against the number of coefficients before memory is allocated. A box of w x h cells adds at
/// least (w - degree) x (h - degree) functions. Thin boxes may add none, hence the margin.
static bat_status check_cells(const surface_box *boxes, size_t count, size_t functions, bat_error *error)
{
    enum
    {
        CELLS_A_FUNCTION = 64,
        ROOM = 1 << 20
    };
    double cells = 0, max_cells = (double)ROOM + (double)CELLS_A_FUNCTION * (double)functions;
    for (size_t i = 0; i < count; i++)
    {
        const surface_box *box = &boxes[i];
        cells += (double)(box->high[0] - box->low[0]) * (double)(box->high[1] - box->low[1]);
        if (cells > max_cells)
            return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, box->line,
                             "the boxes up to here have %.0f cells, too many for %zu coefficients", cells, functions);
    }
    return BAT_OK;
}

/// Make a space with cells refined, `shift` levels below those of the boxes. Boxes of level 0 refine nothing.
static bat_status make_refined(const bat_hierarchical_options *options, const surface_box *boxes, size_t count,
                               unsigned shift, bat_hierarchical_space **space, bat_error *error)
{
    size_t made = 0;
    bat_spline_box *refine = memory_array(count, sizeof *refine);
    if (refine == NULL)
        return error_memory(error, count * sizeof *refine);
    for (size_t i = 0; i < count; i++)
    {
        const surface_box *box = &boxes[i];
        if (box->level == 0)
            continue;
        bat_spline_box *to = &refine[made++];
        to->level = (uint32_t)box->level - 1;
        for (int d = 0; d < 2; d++)
        {
            to->low[d] = (uint32_t)(box->low[d] >> shift);
            to->high[d] = (uint32_t)((box->high[d] + shift) >> shift);
        }
    }
    bat_hierarchical_space *refined = NULL;
    bat_status status = bat_hierarchical_space_make(options, &refined, error);
    if (status == BAT_OK && made > 0)
        status = bat_hierarchical_space_refine(refined, refine, made, error);
    free(refine);
    if (status == BAT_OK)
        *space = refined;
    else
        bat_hierarchical_space_free(refined);
    return status;
}

/// The number of cells in the region of each level, in cells of that level, times 4^-shift.
static bat_status region_sizes(const bat_hierarchical_space *space, unsigned shift,
                               uint64_t sizes[BAT_HIERARCHICAL_MAX_LEVELS + 1], bat_error *error)
{
    bat_spline_box *regions = NULL;
    size_t count = 0;
    bat_status status = hierarchical_space_regions(space, &regions, &count, error);
    if (status != BAT_OK)
        return status;
    memset(sizes, 0, (BAT_HIERARCHICAL_MAX_LEVELS + 1) * sizeof *sizes);
    for (size_t i = 0; i < count; i++)
        sizes[regions[i].level] +=
            (uint64_t)(regions[i].high[0] - regions[i].low[0]) * (uint64_t)(regions[i].high[1] - regions[i].low[1]);
    for (size_t i = 0; i <= BAT_HIERARCHICAL_MAX_LEVELS; i++)
        sizes[i] >>= 2 * shift;
    free(regions);
    return BAT_OK;
}

/// The first box of a level or above with a border that divides cells of the previous level; `count` for none.
static size_t find_odd(const surface_box *boxes, size_t count, size_t level)
{
    for (size_t i = 0; i < count; i++)
        if (boxes[i].level >= level && boxes[i].level > 0 &&
            ((boxes[i].low[0] | boxes[i].low[1] | boxes[i].high[0] | boxes[i].high[1]) & 1) != 0)
            return i;
    return count;
}

/// Check boxes that divide cells of the previous level; the space contains these cells whole. In a space of twice the spans,
/// each level has the cells of the next one. It represents the boxes exactly. The regions of both spaces agree if other
/// boxes fill the divided cells.
static bat_status check_filled(const bat_hierarchical_options *options, const surface_box *boxes, size_t count,
                               const bat_hierarchical_space *space, bat_error *error)
{
    bat_hierarchical_options exact = {.degree = {1, 1}, .spans = {2 * options->spans[0], 2 * options->spans[1]}};
    bat_hierarchical_space *doubled = NULL;
    uint64_t sizes[BAT_HIERARCHICAL_MAX_LEVELS + 1], exact_sizes[BAT_HIERARCHICAL_MAX_LEVELS + 1];
    bat_status status = make_refined(&exact, boxes, count, 0, &doubled, error);
    if (status == BAT_OK)
        status = region_sizes(space, 0, sizes, error);
    if (status == BAT_OK)
        status = region_sizes(doubled, 1, exact_sizes, error);
    bat_hierarchical_space_free(doubled);
    for (size_t level = 1; level <= BAT_HIERARCHICAL_MAX_LEVELS && status == BAT_OK; level++)
        if (sizes[level] != exact_sizes[level])
        {
            size_t odd = find_odd(boxes, count, level);
            status = ERROR_UNSUPPORTED(error, odd < count ? boxes[odd].line : 0,
                                       "the boxes of level %zu do not fill the cells of level %zu that they touch", level,
                                       level - 1);
        }
    return status;
}

static bat_status check_size(const bat_hierarchical_options *options, size_t line, size_t functions, bat_error *error)
{
    double min_functions = 1; // no refinement has fewer functions than level 0
    for (int d = 0; d < 2; d++)
        min_functions *= (double)options->spans[d] + options->degree[d];
    if (min_functions <= (double)functions)
        return BAT_OK;
    return ERROR_FILE(error, line, "there are %zu control points, fewer than the %.0f functions of level 0", functions,
                      min_functions);
}

bat_status surface_space_make(const bat_hierarchical_options *options, const surface_box *boxes, size_t count, size_t line,
                              size_t functions, bat_hierarchical_space **space, bat_error *error)
{
    bat_status status = check_size(options, line, functions, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = check_box(options, &boxes[i], error);
    if (status == BAT_OK)
        status = check_cells(boxes, count, functions, error);
    bat_hierarchical_space *made = NULL;
    if (status == BAT_OK)
        status = make_refined(options, boxes, count, 1, &made, error);
    if (status == BAT_OK && find_odd(boxes, count, 0) < count)
        status = check_filled(options, boxes, count, made, error);
    if (status == BAT_OK && bat_hierarchical_space_functions(made) != functions)
        status = ERROR_FILE(error, line, "there are %zu control points, but %zu functions", functions,
                            bat_hierarchical_space_functions(made));
    if (status == BAT_OK)
        *space = made;
    else
        bat_hierarchical_space_free(made);
    return status;
}
