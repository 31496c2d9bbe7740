/// @file
/// Hierarchical B-spline spaces: creation, refinement, admissibility and queries. Giannelli, Jüttler and Speleers,
/// "THB-splines: the truncated basis for hierarchical splines" (2012).

#include "surface/spline/hierarchical_space.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"

#include <limits.h>

static const size_t FINEST = BAT_HIERARCHICAL_MAX_LEVELS - 1;

bat_hierarchical_options bat_hierarchical_defaults(void)
{
    return (bat_hierarchical_options){.degree = {2, 2}, .spans = {1, 1}, .truncated = true};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_hierarchical_options, degree[0], OPTION_INT, 1, BAT_SPLINE_MAX_DEGREE),
    OPTION_FIELD(bat_hierarchical_options, degree[1], OPTION_INT, 1, BAT_SPLINE_MAX_DEGREE),
    OPTION_FIELD(bat_hierarchical_options, spans[0], OPTION_SIZE, 1, INFINITY),
    OPTION_FIELD(bat_hierarchical_options, spans[1], OPTION_SIZE, 1, INFINITY),
    OPTION_FIELD(bat_hierarchical_options, admissible, OPTION_INT, 0, INT_MAX),
};

static bat_status hierarchical_options_check(const void *opaque, bat_error *error)
{
    const bat_hierarchical_options *options = opaque;
    return options->admissible != 1 ? BAT_OK : error_option(error, "admissible", "is 1, but must be 0 or at least 2");
}

const bat_options_table bat_hierarchical_fields =
    OPTIONS_TABLE(bat_hierarchical_options, FIELDS, hierarchical_options_check);

/// Whether the cells and functions of a level in each direction can be numbered with 32 bits.
static bool level_fits(const bat_hierarchical_options *options, size_t level)
{
    for (int d = 0; d < 2; d++)
        if (options->spans[d] > (UINT32_MAX - (uint32_t)options->degree[d]) >> level)
            return false;
    return true;
}

/// Make a space from a box tree, unless it has more than `most` functions. Takes ownership of the tree, also on failure.
/// @param functions receives the number of functions
/// @param space     receives the space, or null if it has too many functions
static bat_status make_of_tree(const bat_hierarchical_options *options, box_tree *tree, size_t most, size_t *functions,
                               bat_hierarchical_space **space, bat_error *error)
{
    bat_hierarchical_space *made = calloc(1, sizeof *made);
    *space = NULL;
    if (made == NULL)
    {
        box_tree_free(tree);
        return error_memory(error, sizeof *made);
    }
    made->options = *options;
    made->tree = *tree;
    bat_status status = hierarchical_number(made, error);
    *functions = made->function_count;
    bool few = made->function_count <= most;
    if (status == BAT_OK && few)
        status = uniform_basis_make(options->degree[0], &made->bases[0], error);
    if (status == BAT_OK && few)
        status = uniform_basis_make(options->degree[1], &made->bases[1], error);
    if (status == BAT_OK && few)
        status = hierarchical_build(made, error);
    if (status == BAT_OK && few)
        *space = made;
    else
        bat_hierarchical_space_free(made);
    return status;
}

static bat_status make_whole(const bat_hierarchical_options *options, box_tree *tree, bat_hierarchical_space **space,
                             bat_error *error)
{
    size_t functions;
    return make_of_tree(options, tree, SIZE_MAX, &functions, space, error);
}

bat_status bat_hierarchical_space_make(const bat_hierarchical_options *options, bat_hierarchical_space **space,
                                       bat_error *error)
{
    const bat_hierarchical_options defaults = bat_hierarchical_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_hierarchical_fields, options, error);
    if (status != BAT_OK)
        return status;
    if (!level_fits(options, 0))
        return ERROR_TOO_LARGE(error, "a grid of %zu x %zu spans is too large", options->spans[0], options->spans[1]);
    box_tree tree;
    status = box_tree_make((uint64_t)options->spans[0] << FINEST, (uint64_t)options->spans[1] << FINEST, &tree, error);
    return status == BAT_OK ? make_whole(options, &tree, space, error) : status;
}

bat_status hierarchical_space_copy(const bat_hierarchical_space *space, bat_hierarchical_space **copy, bat_error *error)
{
    box_tree tree;
    bat_status status = box_tree_copy(&space->tree, &tree, error);
    return status == BAT_OK ? make_whole(&space->options, &tree, copy, error) : status;
}

void bat_hierarchical_space_free(bat_hierarchical_space *space)
{
    if (space == NULL)
        return;
    box_tree_free(&space->tree);
    for (int d = 0; d < 2; d++)
        uniform_basis_free(&space->bases[d]);
    for (size_t l = 0; l < BAT_HIERARCHICAL_MAX_LEVELS; l++)
    {
        run_set_free(&space->level[l].region);
        run_set_free(&space->level[l].refined);
        run_set_free(&space->level[l].cells);
        run_set_free(&space->level[l].supported);
        run_set_free(&space->level[l].selected);
    }
    free(space->functions);
    free(space->cells);
    free(space->active);
    free(space->extraction);
    free(space);
}

static bat_status check_box(const bat_hierarchical_options *options, const bat_spline_box *box, size_t index,
                            bat_error *error)
{
    if (box->level >= FINEST || !level_fits(options, box->level + 1))
        return error_set(error, BAT_TOO_LARGE, index, 0,
                         "box %zu, of level %u, cannot be refined: the next level is too fine", index, box->level);
    for (int d = 0; d < 2; d++)
    {
        if (box->low[d] >= box->high[d])
            return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "box %zu contains no cells", index);
        if (box->high[d] > options->spans[d] << box->level)
            return error_set(error, BAT_INVALID_ARGUMENT, index, 0,
                             "box %zu exceeds the grid of level %u, which has %zu x %zu cells", index, box->level,
                             options->spans[0] << box->level, options->spans[1] << box->level);
    }
    return BAT_OK;
}

/// The smallest box of a coarser level that contains a box.
static bat_spline_box coarsen(const bat_spline_box *box, uint32_t level)
{
    bat_spline_box coarse = {.level = level};
    for (int d = 0; d < 2; d++)
    {
        coarse.low[d] = box->low[d] >> (box->level - level);
        coarse.high[d] = ((box->high[d] - 1) >> (box->level - level)) + 1;
    }
    return coarse;
}

/// The support extension of a box: the cells of its level that share a function with one of its own.
static bat_spline_box extend(const bat_hierarchical_options *options, const bat_spline_box *box)
{
    bat_spline_box wide = *box;
    for (int d = 0; d < 2; d++)
    {
        uint32_t degree = (uint32_t)options->degree[d], spans = (uint32_t)(options->spans[d] << box->level);
        wide.low[d] = box->low[d] < degree ? 0 : box->low[d] - degree;
        wide.high[d] = spans - box->high[d] < degree ? spans : box->high[d] + degree;
    }
    return wide;
}

/// The coarser cells that must be refined before a box of level l, to preserve admissibility of class m. Truncated basis:
/// the support extension with respect to level l - m + 2 (Buffa and Giannelli 2016, section 3). Plain basis: with respect to
/// level l - m + 1 (Bracco, Giannelli and Vázquez, "Refinement algorithms for adaptive isogeometric methods with
/// hierarchical splines", 2018). False when there are none.
static bool neighbourhood(const bat_hierarchical_options *options, const bat_spline_box *box, bat_spline_box *coarse)
{
    uint32_t m = (uint32_t)options->admissible;
    if (m == 0 || box->level + 1 < m)
        return false;
    uint32_t level = box->level + 1 - m;
    bat_spline_box same = coarsen(box, options->truncated ? level + 1 : level), wide = extend(options, &same);
    *coarse = coarsen(&wide, level);
    return true;
}

static bat_status refine_box(const bat_hierarchical_options *options, box_tree *tree, const bat_spline_box *box,
                             bat_error *error)
{
    box_tree_area area;
    for (int d = 0; d < 2; d++)
    {
        area.low[d] = (uint64_t)box->low[d] << (FINEST - box->level);
        area.high[d] = (uint64_t)box->high[d] << (FINEST - box->level);
    }
    // The neighbours of cells that are already refined have been refined before.
    if (box_tree_reaches(tree, &area, (uint8_t)(box->level + 1)))
        return BAT_OK;
    bat_status status = BAT_OK;
    bat_spline_box coarse;
    if (box->level > 0)
    {
        coarse = coarsen(box, box->level - 1);
        status = refine_box(options, tree, &coarse, error);
    }
    if (status == BAT_OK && neighbourhood(options, box, &coarse))
        status = refine_box(options, tree, &coarse, error);
    return status == BAT_OK ? box_tree_raise(tree, &area, (uint8_t)(box->level + 1), error) : status;
}

bat_status hierarchical_space_refined(const bat_hierarchical_space *space, const bat_spline_box *boxes, size_t count,
                                      size_t most, size_t *functions, bat_hierarchical_space **refined, bat_error *error)
{
    bat_status status = BAT_OK;
    *refined = NULL;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = check_box(&space->options, &boxes[i], i, error);
    if (status != BAT_OK)
        return status;
    box_tree tree, tidy;
    status = box_tree_copy(&space->tree, &tree, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = refine_box(&space->options, &tree, &boxes[i], error);
    if (status == BAT_OK)
        status = box_tree_copy(&tree, &tidy, error);
    box_tree_free(&tree);
    return status == BAT_OK ? make_of_tree(&space->options, &tidy, most, functions, refined, error) : status;
}

bat_status bat_hierarchical_space_refine(bat_hierarchical_space *space, const bat_spline_box *boxes, size_t count,
                                         bat_error *error)
{
    bat_hierarchical_space *refined;
    size_t functions;
    bat_status status = hierarchical_space_refined(space, boxes, count, SIZE_MAX, &functions, &refined, error);
    if (status != BAT_OK)
        return status;
    SWAP(*space, *refined);
    bat_hierarchical_space_free(refined);
    return BAT_OK;
}

bat_hierarchical_options bat_hierarchical_space_options(const bat_hierarchical_space *space)
{
    return space->options;
}

size_t bat_hierarchical_space_functions(const bat_hierarchical_space *space)
{
    return space->function_count;
}

size_t bat_hierarchical_space_levels(const bat_hierarchical_space *space)
{
    return space->levels;
}

size_t hierarchical_space_max_active(const bat_hierarchical_space *space)
{
    return space->max_active;
}

bat_spline_function hierarchical_space_function(const bat_hierarchical_space *space, size_t index)
{
    return space->functions[index];
}

size_t hierarchical_space_find(const bat_hierarchical_space *space, bat_spline_function function)
{
    if (function.level >= space->levels)
        return BAT_NO_INDEX;
    uint32_t number = run_set_find(&space->level[function.level].selected, function.j, function.i);
    return number == UINT32_MAX ? BAT_NO_INDEX : number;
}

size_t bat_hierarchical_space_cells(const bat_hierarchical_space *space)
{
    return space->cell_count;
}

bat_spline_box bat_hierarchical_space_cell(const bat_hierarchical_space *space, size_t index)
{
    const hierarchical_cell *cell = &space->cells[index];
    return (bat_spline_box){cell->level, {cell->column, cell->row}, {cell->column + 1, cell->row + 1}};
}

size_t bat_hierarchical_space_active(const bat_hierarchical_space *space, size_t cell, const uint32_t **indices)
{
    *indices = space->active + space->cells[cell].first;
    return space->cells[cell].active;
}

/// The column (or row) of the finest grid that contains a parameter. The borders of column c are the doubles nearest to c /
/// count and (c + 1) / count; the product may be off by one unit in the last place.
static uint64_t finest_cell(const bat_hierarchical_space *space, int direction, double parameter)
{
    uint64_t count = (uint64_t)space->options.spans[direction] << FINEST;
    double size = (double)count;
    if (!(parameter > 0))
        return 0;
    if (parameter >= 1)
        return count - 1;
    uint64_t cell = (uint64_t)(parameter * size);
    cell -= (double)cell / size > parameter;
    cell += (double)(cell + 1) / size <= parameter;
    return cell;
}

size_t bat_hierarchical_space_locate(const bat_hierarchical_space *space, double u, double v)
{
    uint64_t x = finest_cell(space, 0, u), y = finest_cell(space, 1, v);
    uint8_t level = box_tree_level(&space->tree, x, y);
    return run_set_find(&space->level[level].cells, (uint32_t)(y >> (FINEST - level)), (uint32_t)(x >> (FINEST - level)));
}
