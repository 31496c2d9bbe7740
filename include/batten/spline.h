#ifndef BATTEN_SPLINE_H
#define BATTEN_SPLINE_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Hierarchical B-splines over [0, 1]^2, plain and truncated: Giannelli, Jüttler and Speleers, "THB-splines: the truncated
/// basis for hierarchical splines" (2012).
///
/// Level l has the clamped uniform B-splines of the given bidegree on a grid of spans[0] 2^l x spans[1] 2^l cells. Nested
/// regions define the active level: region 0 is the whole square, and region l + 1 consists of cells of level l. A function
/// of level l belongs to the basis when its support lies in region l but not in region l + 1 (Kraft's selection). Truncation
/// subtracts from each function its part in the selected finer ones. The truncated basis is nonnegative and sums to one.

/// The highest degree that any call takes.
#define BAT_SPLINE_MAX_DEGREE 15

/// A knot vector. All zero: none.
typedef struct bat_knot_vector
{
    double *knots; ///< count numbers, nondecreasing, owned
    size_t count;  ///< at least 2 degree + 2
    int degree;    ///< 0 to BAT_SPLINE_MAX_DEGREE
} bat_knot_vector;

/// A spline curve.
typedef struct bat_spline_curve
{
    bat_knot_vector knots;
    double *control;  ///< functions x dimension, owned
    size_t dimension; ///< at least 1
} bat_spline_curve;

/// The largest number of levels.
#define BAT_HIERARCHICAL_MAX_LEVELS 20

/// A space of hierarchical splines. Spaces only change by bat_hierarchical_space_refine(); reading one from several threads
/// is safe.
typedef struct bat_hierarchical_space bat_hierarchical_space;

/// Options of a new space. Begin with bat_hierarchical_defaults().
typedef struct bat_hierarchical_options
{
    int degree[2];   ///< 1 to BAT_SPLINE_MAX_DEGREE; default 2, 2
    size_t spans[2]; ///< cells of level 0 in each direction, at least 1; default 1, 1
    bool truncated;  ///< default true; false: the plain hierarchical basis, which does not add up to one
    /// Refinement keeps the space admissible of this class m: on every cell, functions of at most m successive levels do not
    /// vanish (Buffa and Giannelli, 2016, for the truncated basis; Bracco, Giannelli and Vázquez, 2018, for the plain one).
    /// 0: no such promise; otherwise at least 2; default 0.
    int admissible;
} bat_hierarchical_options;

/// The default options.
BAT_API bat_hierarchical_options bat_hierarchical_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_hierarchical_fields;

/// Cells of one level: those of columns low[0] to high[0] - 1 and rows low[1] to high[1] - 1 of the level's grid.
typedef struct bat_spline_box
{
    uint32_t level;
    uint32_t low[2], high[2];
} bat_spline_box;

/// A function of the basis: the B-spline of a level with index i in u and j in v.
typedef struct bat_spline_function
{
    uint32_t level;
    uint32_t i, j;
} bat_spline_function;

/// Make the tensor-product space of level 0.
/// @param options null for the defaults
/// @param space   receives the space; release it with bat_hierarchical_space_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_TOO_LARGE or BAT_NO_MEMORY; `*space` is untouched on failure
BAT_API bat_status bat_hierarchical_space_make(const bat_hierarchical_options *options, bat_hierarchical_space **space,
                                               bat_error *error);
/// Does nothing to null.
BAT_API void bat_hierarchical_space_free(bat_hierarchical_space *space);

/// Refine: the cells of the boxes join the region of the next level. Boxes may overlap and may cover refined cells. Cells
/// outside of their level's region are refined through all levels between. With a class of admissibility, coarser neighbours
/// are refined as well. The new space contains the old one.
/// @return BAT_OK; BAT_INVALID_ARGUMENT with a box that leaves its grid or is empty; BAT_TOO_LARGE past the largest number
///         of levels or 2^32 - 1 functions; BAT_NO_MEMORY. The space is untouched on failure
BAT_API bat_status bat_hierarchical_space_refine(bat_hierarchical_space *space, const bat_spline_box *boxes, size_t count,
                                                 bat_error *error);

/// The options that the space was made with.
BAT_API bat_hierarchical_options bat_hierarchical_space_options(const bat_hierarchical_space *space);
/// The dimension of the space: the number of functions in its basis.
BAT_API size_t bat_hierarchical_space_functions(const bat_hierarchical_space *space);
/// The number of levels in use, at least 1.
BAT_API size_t bat_hierarchical_space_levels(const bat_hierarchical_space *space);

/// The number of active cells: cells of a level in that level's region but not in the next one's. They cover the square
/// once.
BAT_API size_t bat_hierarchical_space_cells(const bat_hierarchical_space *space);
/// Active cell number `index`, as a box of one cell. Cells are numbered by level, then by row, then by column.
BAT_API bat_spline_box bat_hierarchical_space_cell(const bat_hierarchical_space *space, size_t index);
/// The number of the active cell that holds a parameter of [0, 1]^2; one on a border belongs to the cell above or to the
/// right. The borders of n cells are the doubles nearest 0 / n, 1 / n, to n / n.
BAT_API size_t bat_hierarchical_space_locate(const bat_hierarchical_space *space, double u, double v);
/// The functions that do not vanish on an active cell, in rising order.
/// @param indices receives a list that belongs to the space until it changes
/// @return their number
BAT_API size_t bat_hierarchical_space_active(const bat_hierarchical_space *space, size_t cell, const uint32_t **indices);

/// The values and derivatives of all functions that do not vanish at a parameter.
/// @param cell        the cell of (u, v) by bat_hierarchical_space_locate()
/// @param derivatives 0, 1 or 2
/// @param values      receives (1, 3 or 6) x active numbers: rows are B, B_u, B_v, B_uu, B_uv, B_vv; columns as
///                    bat_hierarchical_space_active()
BAT_API void bat_hierarchical_space_basis(const bat_hierarchical_space *space, size_t cell, double u, double v,
                                          int derivatives, double *values);

/// Closed curves in the square that bound the part of a surface that counts. It lies to the left of each curve. All zero:
/// the whole square.
typedef struct bat_spline_trim
{
    bat_spline_curve *pieces; ///< planar, clamped; each ends where the next one of its loop begins, the last at the first
    size_t *loops;            ///< loop_count + 1: the first piece of each loop, and the number of pieces
    size_t loop_count;        ///< the outline, which is counter-clockwise, comes first; then holes, which are clockwise
} bat_spline_trim;

/// A spline surface: a space and its control points. Release it with bat_spline_surface_free().
typedef struct bat_spline_surface
{
    bat_hierarchical_space *space; ///< owned
    double *control;               ///< functions x dimension, owned
    size_t dimension;              ///< at least 1
    bat_spline_trim trim;          ///< the part that counts; all zero: the whole surface. Evaluation ignores it
} bat_spline_surface;

/// Free what a surface owns and make it empty.
BAT_API void bat_spline_surface_free(bat_spline_surface *surface);
/// Evaluate a surface and its derivatives.
/// @param parameters  count x 2, in the square
/// @param derivatives 0: positions; 1: also S_u, S_v; 2: also S_uu, S_uv, S_vv
/// @param values      receives count x (1, 3 or 6) x dimension, in that order
/// @return BAT_OK or BAT_INVALID_POINT with the parameter that is not in the domain
BAT_API bat_status bat_spline_surface_evaluate(const bat_spline_surface *surface, const double *parameters, size_t count,
                                               int derivatives, double *values, bat_error *error);

BAT_C_END

#endif
