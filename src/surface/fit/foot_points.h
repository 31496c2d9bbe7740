#ifndef SURFACE_FIT_FOOT_POINTS_H
#define SURFACE_FIT_FOOT_POINTS_H

#include "surface/fit/points.h"
#include "surface/spline/hierarchical_space.h"

/// @file
/// A surface cell by cell, in the local B-splines of each, and its distances from points.

/// Release it with fit_nets_free().
typedef struct fit_nets
{
    const bat_hierarchical_space *space;
    size_t dimension, stride; ///< numbers of a cell: locals x dimension
    double *control;          ///< cells x stride
} fit_nets;

/// @param control functions x dimension
bat_status fit_nets_make(const bat_hierarchical_space *space, const double *control, size_t dimension, int threads,
                         fit_nets *nets, bat_error *error);
void fit_nets_free(fit_nets *nets);

/// Room that fit_nets_evaluate() wants, in numbers.
static inline size_t fit_nets_scratch(const fit_nets *nets)
{
    return 3 * ((size_t)nets->space->options.degree[1] + 1) * nets->dimension;
}

/// About how many arithmetic operations fit_nets_evaluate() takes.
static inline double fit_nets_operations(const fit_nets *nets, int derivatives)
{
    return 100 * (derivatives + 1) + (double)(nets->stride * (size_t)(derivatives + 1));
}

/// The surface and its derivatives, as bat_spline_surface_evaluate(), at a parameter of a cell.
static inline void fit_nets_evaluate(const fit_nets *nets, size_t cell, const double *parameter, int derivatives,
                                     double *scratch, double *values)
{
    hierarchical_local_evaluate(nets->space, &nets->space->cells[cell], nets->control + cell * nets->stride, nets->dimension,
                                parameter[0], parameter[1], derivatives, scratch, values);
}

/// Measure the distances of all points, which know their cells.
/// @param residual receives x_i - S(u_i), count x dimension; may be null
bat_status fit_nets_measure(const fit_nets *nets, fit_points *points, double *residual, int threads, bat_error *error);

/// How far feet are sought.
typedef struct fit_correction
{
    int steps;        ///< the most of Newton's method
    double tolerance; ///< when the next step is as short as this, in cells, the search ends
} fit_correction;

/// Every step until rounding ends it.
fit_correction fit_correction_full(void);

/// Move parameters to the feet of their points, eq. (6): min over u of |S(u) - x|^2, by Newton's method. Where its matrix is
/// not positive definite that of Gauss and Newton takes its place, steps are at most as long as a few cells, shortened until
/// the distance falls, and kept in the square; a boundary parameter moves along its side, at most half way to the corners, a
/// fixed one not at all. Distances never
/// rise. Points know their cells before and after, but their order by cells is no more. Distances are measured anew.
/// @param moved receives how many parameters changed
bat_status fit_correct(const fit_nets *nets, fit_points *points, fit_correction correction, int threads, size_t *moved,
                       bat_error *error);

/// Let points that are much farther off than the mean look for their feet elsewhere: from the parameter of the nearest point
/// in space that is near its own. Newton's method finds the foot of the valley that it begins in, and in the early rounds of
/// a fit, when the surface is stiff, that may be the wrong one for good. The farthest few do so, and stay where they are
/// unless they get nearer.
bat_status fit_correct_wrong_feet(const fit_nets *nets, fit_points *points, fit_correction correction, int threads,
                                  size_t *moved, bat_error *error);

#endif
