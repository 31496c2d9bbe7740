#ifndef SURFACE_SPLINE_HIERARCHICAL_SPACE_H
#define SURFACE_SPLINE_HIERARCHICAL_SPACE_H

#include "batten/spline.h"

#include "surface/spline/box_tree.h"
#include "surface/spline/run_set.h"
#include "surface/spline/uniform_basis.h"

/// @file
/// Internal representation of a hierarchical spline space, and its functions cell by cell.
///
/// The box tree stores the level of every cell: the finest level whose region contains it. Active cells and functions follow
/// from it. On an active cell of level l, the *local functions* are the (p + 1)(q + 1) B-splines of level l that do not
/// vanish there. Local function b (p + 1) + a has the indices column + a and row + b. The *extraction* of the cell expresses
/// the active functions of the basis in local functions,
///     B_k = sum_a E_ka N_a   (compare multi-level Bezier extraction; D'Angella et al., 2018).
/// Active functions of level l are local functions themselves, so that only the rows of coarser functions are stored.

/// An active cell.
typedef struct hierarchical_cell
{
    uint32_t column, row;
    uint32_t level;
    uint32_t active; ///< number of active functions
    uint32_t coarse; ///< number of these of coarser levels, which come first and have rows in the extraction
    size_t first;    ///< offset of its active functions in `active` of the space
    size_t matrix;   ///< offset of its rows in `extraction` of the space
} hierarchical_cell;

/// The cells and functions of a level.
typedef struct hierarchical_level
{
    run_set region;    ///< cells in the level's region
    run_set refined;   ///< cells of the region that belong to the next level's region, numbered from 0
    run_set cells;     ///< the other cells of the region: active cells with their numbers
    run_set supported; ///< functions of the level with support in its region, numbered from 0
    run_set selected;  ///< of these, the functions of the basis with their numbers
} hierarchical_level;

struct bat_hierarchical_space
{
    bat_hierarchical_options options;
    box_tree tree; ///< levels; coordinates are cells of the finest possible level
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

/// The number of cells of a level in a direction.
static inline size_t hierarchical_spans(const bat_hierarchical_space *space, size_t level, int direction)
{
    return space->options.spans[direction] << level;
}

/// The number of a cell's local functions.
static inline size_t hierarchical_locals(const bat_hierarchical_space *space)
{
    return ((size_t)space->options.degree[0] + 1) * ((size_t)space->options.degree[1] + 1);
}

/// The index of the local function that equals active function k >= coarse of a cell.
static inline size_t hierarchical_local(const bat_hierarchical_space *space, const hierarchical_cell *cell, size_t k)
{
    const bat_spline_function *function = &space->functions[space->active[cell->first + k]];
    return (size_t)(function->j - cell->row) * ((size_t)space->options.degree[0] + 1) + (function->i - cell->column);
}

/// The space that has the regions of hierarchical_space_regions(). Changes `boxes`.
/// @return the failures of bat_hierarchical_space_make() and bat_hierarchical_space_refine()
bat_status hierarchical_space_of_regions(const bat_hierarchical_options *options, bat_spline_box *boxes, size_t count,
                                         bat_hierarchical_space **space, bat_error *error);

/// Build the levels from options and tree, and count cells and functions. The space can be freed after a failure.
bat_status hierarchical_number(bat_hierarchical_space *space, bat_error *error);

/// Build all other members, from levels and bases. The space can be freed after a failure.
bat_status hierarchical_build(bat_hierarchical_space *space, bat_error *error);

/// The space that bat_hierarchical_space_refine() would make, unless it has too many functions.
/// @param most      number of functions that are not too many
/// @param functions receives the number of functions
/// @param refined   receives the space, or null if there are too many functions
/// @return the failures of bat_hierarchical_space_refine()
bat_status hierarchical_space_refined(const bat_hierarchical_space *space, const bat_spline_box *boxes, size_t count,
                                      size_t most, size_t *functions, bat_hierarchical_space **refined, bat_error *error);

/// Convert coefficients of a cell's local functions to those of one of its four quarters, a cell of the next level.
/// @param level   level of the cell
/// @param column  column of the quarter in the next level's grid; likewise `row`
/// @param rows    count x locals, replaced
void hierarchical_refine_rows(const bat_hierarchical_space *space, size_t level, uint32_t column, uint32_t row, size_t count,
                              double *rows);

/// The local functions of an active cell and their derivatives, as rows in the order of bat_hierarchical_space_basis().
/// @param values receives (1, 3 or 6) x locals numbers
void hierarchical_local_values(const bat_hierarchical_space *space, const hierarchical_cell *cell, double u, double v,
                               int derivatives, double *values);

/// The coefficients of a surface in the local functions of a cell: N = E^T C.
/// @param control functions x dimension
/// @param local   receives locals x dimension
void hierarchical_local_control(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *control,
                                size_t dimension, double *local);

/// The values of a surface and of its derivatives at a parameter of a cell.
/// @param local   coefficients in the local functions of the cell
/// @param scratch 3 (degree[1] + 1) x dimension numbers
/// @param values  receives (1, 3 or 6) x dimension numbers
void hierarchical_local_evaluate(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                 size_t dimension, double u, double v, int derivatives, double *scratch, double *values);

/// Convert inner products with local functions to inner products with active functions: E x.
/// @param local  locals x dimension
/// @param active receives active x dimension
void hierarchical_extract_products(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                   size_t dimension, double *active);

/// The same for a symmetric matrix N: E N E^T.
/// @param local   locals x locals
/// @param scratch active x locals numbers
/// @param active  receives active x active
void hierarchical_extract_matrix(const bat_hierarchical_space *space, const hierarchical_cell *cell, const double *local,
                                 double *scratch, double *active);

/// The extraction rows of a cell's coarser functions; null if there are none.
static inline const double *hierarchical_extraction(const bat_hierarchical_space *space, const hierarchical_cell *cell)
{
    return cell->coarse > 0 ? space->extraction + cell->matrix : NULL;
}

/// The largest number of functions that do not vanish on one cell.
size_t hierarchical_space_max_active(const bat_hierarchical_space *space);

/// The number of a function; BAT_NO_INDEX if the basis does not have it.
size_t hierarchical_space_find(const bat_hierarchical_space *space, bat_spline_function function);

/// The region of each level as disjoint boxes: those of level l are of level l's grid and cover region l.
/// @param boxes receives an array from malloc(), by level from 1 on (region 0 is the square)
bat_status hierarchical_space_regions(const bat_hierarchical_space *space, bat_spline_box **boxes, size_t *count,
                                      bat_error *error);

/// Prolongate coefficients to a refined space: coefficients of the same surface. In the truncated basis, functions of both
/// spaces keep their coefficients (Giannelli, Jüttler and Speleers, 2014).
/// @param coarse      functions of `space` x dimension
/// @param fine        receives functions of `refined` x dimension
/// @return BAT_OK; BAT_INVALID_ARGUMENT where `refined` does not contain `space`; BAT_NO_MEMORY
bat_status hierarchical_space_prolong(const bat_hierarchical_space *space, const bat_hierarchical_space *refined,
                                      const double *coarse, size_t dimension, double *fine, bat_error *error);

/// Copy a space.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status hierarchical_space_copy(const bat_hierarchical_space *space, bat_hierarchical_space **copy, bat_error *error);

/// Function number `index`. Functions are numbered by level, then by j, then by i.
bat_spline_function hierarchical_space_function(const bat_hierarchical_space *space, size_t index);

#endif
