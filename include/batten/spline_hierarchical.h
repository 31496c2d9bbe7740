#ifndef BATTEN_SPLINE_HIERARCHICAL_H
#define BATTEN_SPLINE_HIERARCHICAL_H

#include "batten/spline.h"

BAT_C_BEGIN

/// @file
/// Hierarchical B-splines over [0, 1]^2, plain and truncated: Giannelli, Jüttler and Speleers, "THB-splines: the truncated
/// basis for hierarchical splines" (2012).
///
/// Level l has the clamped uniform B-splines of the given bidegree on a grid of spans[0] 2^l x spans[1] 2^l cells. Nested
/// regions define the active level: region 0 is the whole square, and region l + 1 consists of cells of level l. A function
/// of level l belongs to the basis when its support lies in region l but not in region l + 1 (Kraft's selection). Truncation
/// subtracts from each function its part in the selected finer ones. The truncated basis is nonnegative and sums to one.

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
/// Copy a space.
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_hierarchical_space_copy(const bat_hierarchical_space *space, bat_hierarchical_space **copy,
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
/// The largest number of functions that do not vanish on one cell.
BAT_API size_t bat_hierarchical_space_max_active(const bat_hierarchical_space *space);
/// Function number `index`. Functions are numbered by level, then by j, then by i.
BAT_API bat_spline_function bat_hierarchical_space_function(const bat_hierarchical_space *space, size_t index);
/// The number of a function; BAT_NO_INDEX if the basis does not have it.
BAT_API size_t bat_hierarchical_space_find(const bat_hierarchical_space *space, bat_spline_function function);

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

/// The region of each level as disjoint boxes: those of level l are of level l's grid and cover region l.
/// @param boxes receives an array from malloc(), by level from 1 on (region 0 is the square)
BAT_API bat_status bat_hierarchical_space_regions(const bat_hierarchical_space *space, bat_spline_box **boxes, size_t *count,
                                                  bat_error *error);

/// The values and derivatives of all functions that do not vanish at a parameter.
/// @param cell        the cell of (u, v) by bat_hierarchical_space_locate()
/// @param derivatives 0, 1 or 2
/// @param values      receives (1, 3 or 6) x active numbers: rows are B, B_u, B_v, B_uu, B_uv, B_vv; columns as
///                    bat_hierarchical_space_active()
BAT_API void bat_hierarchical_space_basis(const bat_hierarchical_space *space, size_t cell, double u, double v,
                                          int derivatives, double *values);

/// Prolongate coefficients to a refined space: coefficients of the same surface. In the truncated basis, functions of both
/// spaces keep their coefficients (Giannelli, Jüttler and Speleers, 2014).
/// @param coarse      functions of `space` x dimension
/// @param fine        receives functions of `refined` x dimension
/// @return BAT_OK; BAT_INVALID_ARGUMENT where `refined` does not contain `space`; BAT_NO_MEMORY
BAT_API bat_status bat_hierarchical_space_prolong(const bat_hierarchical_space *space, const bat_hierarchical_space *refined,
                                                  const double *coarse, size_t dimension, double *fine, bat_error *error);

/// Closed curves in the square that bound the part of a surface that counts. It lies to the left of each curve. All zero:
/// the whole square. Release it with bat_spline_trim_free().
typedef struct bat_spline_trim
{
    bat_spline_curve *pieces; ///< planar, clamped; each ends where the next one of its loop begins, the last at the first
    size_t *loops;            ///< loop_count + 1: the first piece of each loop, and the number of pieces
    size_t loop_count;        ///< the outline, which is counter-clockwise, comes first; then holes, which are clockwise
} bat_spline_trim;

/// Copy trimming curves.
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_spline_trim_copy(const bat_spline_trim *trim, bat_spline_trim *copy, bat_error *error);
/// Check the conditions of every call that takes trimming curves.
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a wrong knot vector or dimension, a curve that leaves the square or is not
///         clamped, or a loop that is not closed to 1e-9
BAT_API bat_status bat_spline_trim_check(const bat_spline_trim *trim, bat_error *error);
/// Free what trimming curves own and make them empty.
BAT_API void bat_spline_trim_free(bat_spline_trim *trim);

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
/// As bat_tensor_surface_evaluate(), on all threads.
BAT_API bat_status bat_spline_surface_evaluate(const bat_spline_surface *surface, const double *parameters, size_t count,
                                               int derivatives, double *values, bat_error *error);

/// Split a surface into tensor-product patches: rectangles of cells of one level. Each is the B-spline surface of that level
/// over its part of the square, with clamped knots in the coordinates of the square. Neighbouring patches meet exactly; a
/// long side may meet several short ones.
/// @param patches receives an array from malloc(); release each with bat_tensor_surface_free(), then the array
BAT_API bat_status bat_spline_surface_patches(const bat_spline_surface *surface, bat_tensor_surface **patches, size_t *count,
                                              bat_error *error);

BAT_C_END

#endif
