#pragma once

#include "batten/base.h"
#include "batten/spline.h"

/// @file
/// Internal representation of a hierarchical spline space, and its functions cell by cell.
///
/// The box tree stores the level of every cell: the finest level whose region contains it. Active cells and functions follow
/// from it. On an active cell of level l, the *local functions* are the (p + 1)(q + 1) B-splines of level l that do not
/// vanish there. Local function b (p + 1) + a has the indices column + a and row + b. The *extraction* of the cell expresses
/// the active functions of the basis in local functions,
///     B_k = sum_a E_ka N_a   (compare multi-level Bezier extraction; D'Angella et al., 2018).
/// Active functions of level l are local functions themselves, so that only the rows of coarser functions are stored.

// Sets of grid cells or of functions on a grid, stored as runs of columns in rows. Runs are sorted by row and column; runs
// of a row do not touch. After numbering, the number of an element is `first` plus the number of elements before it.

/// The columns [begin, end) of a row.
typedef struct grid_run
{
    uint32_t row, begin, end;
    uint32_t number; ///< number of the first element
} grid_run;

/// A set. All zero: the empty set. Release it with run_set_free(). Functions that return false are out of memory.
typedef struct run_set
{
    grid_run *runs;
    size_t count, capacity;
} run_set;

void run_set_free(run_set *set);

/// Append a run after all others; merge it with the last one if they touch or overlap.
bool run_set_append(run_set *set, uint32_t row, uint32_t begin, uint32_t end);
/// Sort runs that were appended in any order, and merge those that touch or overlap.
void run_set_sort(run_set *set);
/// The number of elements.
uint64_t run_set_size(const run_set *set);
/// Number the elements consecutively from `first`. The last number must fit into 32 bits.
void run_set_number(run_set *set, uint32_t first);

/// Index of the first run that ends after (row, column), or `count`.
size_t run_set_lower_bound(const run_set *set, uint32_t row, uint32_t column);
/// The same, starting from the result `*hint` of the previous search, and updating it: fast for searches in ascending order.
size_t run_set_lower_bound_from(const run_set *set, uint32_t row, uint32_t column, size_t *hint);
/// The number of an element, or UINT32_MAX if it is not in the set.
uint32_t run_set_find(const run_set *set, uint32_t row, uint32_t column);

/// The union of two sets.
bool run_set_unite(const run_set *a, const run_set *b, run_set *both);
/// The difference of two sets.
bool run_set_subtract(const run_set *from, const run_set *what, run_set *rest);
/// The set on the grid of half the resolution; the rows and columns of `set` come in pairs.
bool run_set_halve(const run_set *set, run_set *coarse);

/// The functions of bidegree `degree` on a clamped grid of size[0] x size[1] cells whose support lies in a set of cells. The
/// support of function (i, j) consists of columns i - degree[0] to i and rows j - degree[1] to j, clipped to the grid.
bool run_set_supports(const run_set *cells, const uint32_t size[2], const int degree[2], run_set *functions);

/// The end of the runs; null for a set without memory.
static inline const grid_run *run_set_end(const run_set *set)
{
    return set->runs != NULL ? set->runs + set->count : NULL;
}

// The level of every cell of the square: a k-d tree of boxes with levels, after Kiss, Giannelli and Jüttler, "Algorithms
// and data structures for truncated hierarchical B-splines" (2014).
//
// Coordinates are integers from 0 to the size of the square. A box is cut at the interior integer divisible by the highest
// power of two. The depth is therefore at most twice the number of binary digits of the size, for any order of insertions,
// and cuts follow the dyadic grids.

/// The integer box [low, high).
typedef struct box_tree_area
{
    uint64_t low[2], high[2];
} box_tree_area;

/// A node: an inner node with a cut, or a leaf with a level.
typedef struct box_tree_node
{
    uint64_t cut;      ///< first coordinate of the upper child
    uint32_t child[2]; ///< indices of the children; 0, 0 for a leaf
    uint8_t axis;      ///< axis of the cut
    uint8_t level;     ///< level of a leaf
} box_tree_node;

/// The tree; node 0 is the root. Release it with box_tree_free().
typedef struct box_tree
{
    box_tree_node *nodes;
    size_t count, capacity;
    uint64_t size[2];
} box_tree;

/// Make a tree with one box of level 0. Both sizes are positive.
bat_status box_tree_make(uint64_t width, uint64_t height, box_tree *tree, bat_error *error);
/// A compact copy: without unused nodes, in depth-first order.
bat_status box_tree_copy(const box_tree *tree, box_tree *copy, bat_error *error);
void box_tree_free(box_tree *tree);

/// Raise all of an area to at least `level`.
/// @return BAT_OK, or BAT_NO_MEMORY with the area partly raised
bat_status box_tree_raise(box_tree *tree, const box_tree_area *area, uint8_t level, bat_error *error);

/// Whether all of an area has at least the level `level`.
bool box_tree_reaches(const box_tree *tree, const box_tree_area *area, uint8_t level);
/// The level at (x, y).
uint8_t box_tree_level(const box_tree *tree, uint64_t x, uint64_t y);

/// A box of constant level.
typedef struct box_tree_leaf
{
    box_tree_area area;
    uint8_t level;
} box_tree_leaf;

/// List the boxes of the leaves, which tile the square.
/// @param leaves receives an array from malloc()
bat_status box_tree_leaves(const box_tree *tree, box_tree_leaf **leaves, size_t *count, bat_error *error);

// B-splines of degree p over a clamped uniform knot vector, evaluated on a cell.
//
// On cell c, functions c to c + p do not vanish. They depend only on the distances of the cell from both ends of the grid,
// up to p - 1 cells. A small grid with the same distances has the same functions there. Hence one table of two-scale
// relations for grids of 1 to 2 p - 1 cells serves all grids.

/// The two-scale relations of a degree. Release it with uniform_basis_free().
typedef struct uniform_basis
{
    int degree;                                    ///< at least 1
    double *refinement[2 * BAT_SPLINE_MAX_DEGREE]; ///< [n]: matrix (n + p) x (2 n + p) of the grid with n cells
    double *storage;                               ///< owned
} uniform_basis;

bat_status uniform_basis_make(int degree, uniform_basis *basis, bat_error *error);
void uniform_basis_free(uniform_basis *basis);

/// A (p + 1) x (p + 1) block of a matrix; consecutive rows are `stride` numbers apart.
typedef struct uniform_refinement
{
    const double *rows;
    size_t stride;
} uniform_refinement;

/// The two-scale relation on the lower (half 0) or upper (half 1) half of a cell. Row a holds the coefficients of function
/// cell + a in the fine functions 2 cell + half to 2 cell + half + p.
uniform_refinement uniform_basis_refinement(const uniform_basis *basis, size_t cells, size_t cell, size_t half);

/// The coefficient of a fine function in a coarse function of a grid with `cells` cells.
double uniform_basis_two_scale(const uniform_basis *basis, size_t cells, size_t coarse, size_t fine);

/// The functions of a cell at the local coordinate s in [0, 1], and their derivatives with respect to s.
/// @param derivatives 0 to 2
/// @param values      receives (derivatives + 1) x (p + 1) numbers
void uniform_basis_values(int degree, size_t cells, size_t cell, double s, int derivatives, double *values);

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
