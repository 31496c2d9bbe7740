#ifndef SURFACE_SPLINE_HIERARCHICAL_SPACE_H
#define SURFACE_SPLINE_HIERARCHICAL_SPACE_H

#include "batten/spline_hierarchical.h"

#include "surface/spline/box_tree.h"
#include "surface/spline/run_set.h"
#include "surface/spline/uniform_basis.h"

/// @file
/// What a space is made of, and its functions cell by cell.
///
/// The box tree says the level of every place of the square: the finest whose region holds it. All else follows from it: the
/// active cells, the functions, and on each cell the extraction, which says the functions of the basis that do not vanish
/// there in the cell's local functions, the (p + 1)(q + 1) B-splines of the cell's own level. Local function b (p + 1) + a
/// is that of column
/// + a and row + b. On the cell, functions of the cell's level are local functions themselves; coarser ones are a row of
/// numbers each.

/// An active cell.
typedef struct hierarchical_cell
{
    uint32_t column, row;
    uint32_t level;
    uint32_t active; ///< functions that do not vanish
    uint32_t coarse; ///< the first of them, of coarser levels: as many rows of the extraction
    size_t first;    ///< where its list begins in `active` of the space
    size_t matrix;   ///< where its rows begin in `extraction` of the space
} hierarchical_cell;

/// What the space keeps of a level.
typedef struct hierarchical_level
{
    run_set region;    ///< cells in the level's region
    run_set refined;   ///< those of them in the next level's region, numbered from 0
    run_set cells;     ///< the others, the active ones, by their numbers
    run_set supported; ///< functions of the level with support in its region, numbered from 0
    run_set selected;  ///< those of them in the basis, by their numbers
} hierarchical_level;

struct bat_hierarchical_space
{
    bat_hierarchical_options options;
    box_tree tree; ///< of cells of level BAT_HIERARCHICAL_MAX_LEVELS - 1
    uniform_basis bases[2];
    size_t levels;
    hierarchical_level level[BAT_HIERARCHICAL_MAX_LEVELS];
    bat_spline_function *functions;
    size_t function_count;
    hierarchical_cell *cells;
    size_t cell_count;
    size_t max_active;
    uint32_t *active;
    size_t active_count, active_capacity;
    double *extraction;
    size_t extraction_count, extraction_capacity;
};

/// The cells of a level in a direction.
static inline size_t hierarchical_spans(const bat_hierarchical_space *space, size_t level, int direction)
{
    return space->options.spans[direction] << level;
}

/// The number of a cell's local functions.
static inline size_t hierarchical_locals(const bat_hierarchical_space *space)
{
    return ((size_t)space->options.degree[0] + 1) * ((size_t)space->options.degree[1] + 1);
}

/// The local function that an active function of the cell's own level is; `k` counts from the cell's `coarse` on.
static inline size_t hierarchical_local(const bat_hierarchical_space *space, const hierarchical_cell *cell, size_t k)
{
    const bat_spline_function *function = &space->functions[space->active[cell->first + k]];
    return (size_t)(function->j - cell->row) * ((size_t)space->options.degree[0] + 1) + (function->i - cell->column);
}

/// Build all but options, tree and bases, which are there already. The space can be freed on failure, too.
bat_status hierarchical_build(bat_hierarchical_space *space, bat_error *error);

/// Say rows of numbers, coefficients of a cell's local functions, in those of one of its four quarters, cells of the next
/// level.
/// @param level   of the cell
/// @param column  of the quarter, in the next level's grid; `row` too
/// @param rows    count x locals, replaced
void hierarchical_refine_rows(const bat_hierarchical_space *space, size_t level, uint32_t column, uint32_t row, size_t count,
                              double *rows);

/// The local functions of an active cell and their derivatives, as rows in the order of bat_hierarchical_space_basis().
/// @param values receives (1, 3 or 6) x locals numbers
void hierarchical_local_values(const bat_hierarchical_space *space, const hierarchical_cell *cell, double u, double v,
                               int derivatives, double *values);

/// The coefficients of a surface in a cell's local functions.
/// @param control functions x dimension
/// @param local   receives locals x dimension
void hierarchical_local_control(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *control,
                                size_t dimension, double *local);

/// A surface and its derivatives at a parameter of a cell.
/// @param local   its coefficients in the cell's local functions
/// @param scratch room for 3 (degree[1] + 1) x dimension numbers
/// @param values  receives (1, 3 or 6) x dimension numbers
void hierarchical_local_evaluate(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                 size_t dimension, double u, double v, int derivatives, double *scratch, double *values);

/// Products with local functions made into those with the active functions: E x for a right-hand side x.
/// @param local  locals x dimension
/// @param active receives active x dimension
void hierarchical_extract_products(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                   size_t dimension, double *active);

/// The same for a symmetric matrix of products of two: E N E^T.
/// @param local   locals x locals
/// @param scratch room for active x locals
/// @param active  receives active x active
void hierarchical_extract_matrix(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                 double *scratch, double *active);

/// The rows of a cell's coarser functions; null where it has none.
static inline const double *hierarchical_extraction(const bat_hierarchical_space *space, const hierarchical_cell *cell)
{
    return cell->coarse > 0 ? space->extraction + cell->matrix : NULL;
}

#endif
