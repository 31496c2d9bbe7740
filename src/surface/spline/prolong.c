/// @file
/// Prolongation of coefficients to a refined space.
///
/// Truncated basis: coefficients are preserved. On any active cell of level l, represent the surface in B-splines of level
/// l. The coefficient of a function of level l is that of its B-spline ("preservation of coefficients"; Giannelli, Jüttler
/// and Speleers, "Strongly stable bases for adaptively refined multilevel spline spaces", 2014). It is read off there.
///
/// Plain basis: a function that is no longer selected is replaced by its children, B = sum_j r_j B_j, level by level.

#include "linalg/vector.h"
#include "surface/spline/hierarchical_space.h"

#include "base/error.h"
#include "base/memory.h"

#include <string.h>

/// Whether `refined` contains `space`: the same options, and at least the same level everywhere.
static bool contains(const bat_hierarchical_space *space, const bat_hierarchical_space *refined)
{
    const bat_hierarchical_options *a = &space->options, *b = &refined->options;
    if (a->degree[0] != b->degree[0] || a->degree[1] != b->degree[1] || a->spans[0] != b->spans[0] ||
        a->spans[1] != b->spans[1] || a->truncated != b->truncated)
        return false;
    for (size_t i = 0; i < space->cell_count; i++)
    {
        const hierarchical_cell *cell = &space->cells[i];
        int shift = BAT_HIERARCHICAL_MAX_LEVELS - 1 - (int)cell->level;
        box_tree_area area = {{(uint64_t)cell->column << shift, (uint64_t)cell->row << shift},
                              {((uint64_t)cell->column + 1) << shift, ((uint64_t)cell->row + 1) << shift}};
        if (!box_tree_reaches(&refined->tree, &area, (uint8_t)cell->level))
            return false;
    }
    return true;
}

/// The active cell of a space that contains a cell of the same or a finer level.
static const hierarchical_cell *cell_containing(const bat_hierarchical_space *space, const hierarchical_cell *fine)
{
    int shift = BAT_HIERARCHICAL_MAX_LEVELS - 1 - (int)fine->level;
    uint32_t level = box_tree_level(&space->tree, (uint64_t)fine->column << shift, (uint64_t)fine->row << shift);
    uint32_t up = fine->level - level;
    return &space->cells[run_set_find(&space->level[level].cells, fine->row >> up, fine->column >> up)];
}

typedef struct prolong_workspace
{
    memory_pool pool;
    double *local;  ///< locals x dimension
    double *rows;   ///< dimension x locals
    bool *computed; ///< functions of the refined space with known coefficient
} prolong_workspace;

/// The local coefficients of the surface on a cell of the refined space.
static void coefficients_on(const bat_hierarchical_space *space, const hierarchical_cell *fine, const double *coarse,
                            size_t dimension, const prolong_workspace *workspace)
{
    size_t locals = hierarchical_locals(space);
    const hierarchical_cell *container = cell_containing(space, fine);
    hierarchical_local_control(space, container, coarse, dimension, workspace->local);
    for (size_t a = 0; a < locals; a++)
        for (size_t d = 0; d < dimension; d++)
            workspace->rows[d * locals + a] = workspace->local[a * dimension + d];
    for (uint32_t level = container->level; level < fine->level; level++)
    {
        uint32_t up = fine->level - level - 1;
        hierarchical_refine_rows(space, level, fine->column >> up, fine->row >> up, dimension, workspace->rows);
    }
}

static bool all_computed(const bat_hierarchical_space *space, const hierarchical_cell *cell, const bool *computed)
{
    for (size_t k = cell->coarse; k < cell->active; k++)
        if (!computed[space->active[cell->first + k]])
            return false;
    return true;
}

static void prolong_truncated(const bat_hierarchical_space *space, const bat_hierarchical_space *refined,
                              const double *coarse, size_t dimension, double *fine, const prolong_workspace *workspace)
{
    size_t locals = hierarchical_locals(space);
    for (size_t i = 0; i < refined->cell_count; i++)
    {
        const hierarchical_cell *cell = &refined->cells[i];
        if (all_computed(refined, cell, workspace->computed))
            continue;
        coefficients_on(space, cell, coarse, dimension, workspace);
        for (size_t k = cell->coarse; k < cell->active; k++)
        {
            uint32_t function = refined->active[cell->first + k];
            size_t a = hierarchical_local(refined, cell, k);
            for (size_t d = 0; d < dimension; d++)
                fine[function * dimension + d] = workspace->rows[d * locals + a];
            workspace->computed[function] = true;
        }
    }
}

static bat_status make_truncated(const bat_hierarchical_space *space, const bat_hierarchical_space *refined,
                                 const double *coarse, size_t dimension, double *fine, bat_error *error)
{
    size_t size = hierarchical_locals(space) * dimension;
    prolong_workspace workspace = {0};
    workspace.local = memory_pool_array(&workspace.pool, size, sizeof *workspace.local);
    workspace.rows = memory_pool_array(&workspace.pool, size, sizeof *workspace.rows);
    workspace.computed = memory_pool_zeros(&workspace.pool, refined->function_count, sizeof *workspace.computed);
    bat_status status = memory_pool_check(&workspace.pool, error);
    if (status == BAT_OK)
        prolong_truncated(space, refined, coarse, dimension, fine, &workspace);
    memory_pool_free(&workspace.pool);
    return status;
}

/// The children of function i in one direction are 2 i - degree to 2 i + 1, clipped to the grid. Returns the first.
static uint32_t first_child(uint32_t i, uint32_t degree)
{
    return 2 * i < degree ? 0 : 2 * i - degree;
}

/// Distribute the coefficient of a function to its children.
static void add_to_children(const bat_hierarchical_space *refined, bat_spline_function function, const double *coefficients,
                            size_t dimension, double *next)
{
    const run_set *supported = &refined->level[function.level + 1].supported;
    size_t spans[2] = {hierarchical_spans(refined, function.level, 0), hierarchical_spans(refined, function.level, 1)};
    uint32_t p = (uint32_t)refined->options.degree[0], q = (uint32_t)refined->options.degree[1];
    for (uint32_t j = first_child(function.j, q); j <= 2 * function.j + 1 && j < 2 * spans[1] + q; j++)
        for (uint32_t i = first_child(function.i, p); i <= 2 * function.i + 1 && i < 2 * spans[0] + p; i++)
        {
            double share = uniform_basis_two_scale(&refined->bases[0], spans[0], function.i, i) *
                           uniform_basis_two_scale(&refined->bases[1], spans[1], function.j, j);
            if (share != 0)
                vector_add(dimension, share, coefficients, next + (size_t)run_set_find(supported, j, i) * dimension);
        }
}

/// Initial coefficients of all functions with support in the level's region: those of the coarse space, else 0.
static double *initial_level(const bat_hierarchical_space *space, const bat_hierarchical_space *refined, size_t level,
                             const double *coarse, size_t dimension)
{
    const run_set *supported = &refined->level[level].supported, *selected = &space->level[level].selected;
    double *begun = calloc((size_t)run_set_size(supported) * dimension + 1, sizeof *begun);
    for (size_t r = 0; r < selected->count && begun != NULL; r++)
    {
        const grid_run *run = &selected->runs[r];
        size_t first = run_set_find(supported, run->row, run->begin);
        memcpy(begun + first * dimension, coarse + run->number * dimension,
               (run->end - run->begin) * dimension * sizeof *begun);
    }
    return begun;
}

/// Store the coefficients of selected functions, and distribute the others to the next level.
static void store_level(const bat_hierarchical_space *refined, uint32_t level, const double *coefficients, size_t dimension,
                        double *fine, double *next)
{
    const run_set *supported = &refined->level[level].supported;
    for (const grid_run *run = supported->runs; run < run_set_end(supported); run++)
        for (uint32_t i = run->begin; i < run->end; i++)
        {
            const double *from = coefficients + (run->number + (size_t)(i - run->begin)) * dimension;
            uint32_t number = run_set_find(&refined->level[level].selected, run->row, i);
            if (number != UINT32_MAX)
                memcpy(fine + number * dimension, from, dimension * sizeof *fine);
            else
                add_to_children(refined, (bat_spline_function){level, i, run->row}, from, dimension, next);
        }
}

static bat_status make_plain(const bat_hierarchical_space *space, const bat_hierarchical_space *refined,
                             const double *coarse, size_t dimension, double *fine, bat_error *error)
{
    double *level = initial_level(space, refined, 0, coarse, dimension);
    for (uint32_t l = 0; l < refined->levels && level != NULL; l++)
    {
        double *next = initial_level(space, refined, l + 1 < refined->levels ? l + 1 : l, coarse, dimension);
        if (next != NULL)
            store_level(refined, l, level, dimension, fine, next);
        free(level);
        level = next;
    }
    bool made = level != NULL;
    free(level);
    return made ? BAT_OK : error_memory(error, refined->function_count * dimension * sizeof *fine);
}

bat_status hierarchical_space_prolong(const bat_hierarchical_space *space, const bat_hierarchical_space *refined,
                                      const double *coarse, size_t dimension, double *fine, bat_error *error)
{
    if (!contains(space, refined))
        return ERROR_ARGUMENT(error, "the refined space does not contain the coarse one");
    return refined->options.truncated ? make_truncated(space, refined, coarse, dimension, fine, error)
                                      : make_plain(space, refined, coarse, dimension, fine, error);
}
