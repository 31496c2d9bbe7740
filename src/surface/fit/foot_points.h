#ifndef SURFACE_FIT_FOOT_POINTS_H
#define SURFACE_FIT_FOOT_POINTS_H

#include "surface/fit/points.h"
#include "surface/spline/hierarchical_space.h"

/// @file
/// Distances of points from a surface, and their foot points, computed cell by cell.
///
/// On each cell the surface is a tensor-product B-spline surface of the cell's level. Its local control points are extracted
/// once (fit_nets), which makes evaluation at many parameters cheap.

/// The local control net of every cell. Release it with fit_nets_free().
typedef struct fit_nets
{
    const bat_hierarchical_space *space;
    size_t dimension, stride; ///< numbers in the net of one cell: locals x dimension
    double *control;          ///< cells x stride
} fit_nets;

/// Extract the control nets of all cells.
/// @param control functions x dimension
bat_status fit_nets_make(const bat_hierarchical_space *space, const double *control, size_t dimension, int threads,
                         fit_nets *nets, bat_error *error);
void fit_nets_free(fit_nets *nets);

/// Size of the workspace of fit_nets_evaluate(), in numbers.
static inline size_t fit_nets_scratch(const fit_nets *nets)
{
    return 3 * ((size_t)nets->space->options.degree[1] + 1) * nets->dimension;
}

/// Estimated number of arithmetic operations of fit_nets_evaluate().
static inline double fit_nets_operations(const fit_nets *nets, int derivatives)
{
    return 100 * (derivatives + 1) + (double)(nets->stride * (size_t)(derivatives + 1));
}

/// The surface and its derivatives at a parameter of a cell, in the order of bat_spline_surface_evaluate().
static inline void fit_nets_evaluate(const fit_nets *nets, size_t cell, const double *parameter, int derivatives,
                                     double *scratch, double *values)
{
    hierarchical_local_evaluate(nets->space, &nets->space->cells[cell], nets->control + cell * nets->stride, nets->dimension,
                                parameter[0], parameter[1], derivatives, scratch, values);
}

/// Compute the distances |S(u_i) - x_i| of all points. Requires fit_points_locate().
bat_status fit_nets_measure(const fit_nets *nets, fit_points *points, int threads, bat_error *error);

/// Stopping rule of the search for foot points.
typedef struct fit_correction
{
    int steps;        ///< maximum number of Newton steps
    double tolerance; ///< the search ends when the next step is at most this long, in cells
} fit_correction;

/// The stopping rule for convergence to rounding.
fit_correction fit_correction_full(void);

/// The share of points that are so near the surface at their parameters that their feet are at the same place of it: at
/// most `reach` times the shorter side of their cell in space. Requires fit_points_locate().
bat_status fit_near_share(const fit_nets *nets, fit_points *points, double reach, int threads, double *share,
                          bat_error *error);

/// Move parameters to the foot points of their points, eq. (6) of the paper: min over u of |S(u) - x|^2.
///
/// A safeguarded Newton method. Where the Hessian is not positive definite, the Gauss-Newton matrix replaces it. Steps are
/// at most one cell long and are halved until the distance decreases, so that no distance ever increases. Parameters stay in
/// the unit square. A boundary parameter moves along its side, at most half way to the corners; a fixed one does not move.
///
/// Requires fit_points_locate(). Updates cells and distances, and invalidates the order of fit_points_sort().
/// @param moved receives the number of parameters that changed
bat_status fit_correct(const fit_nets *nets, fit_points *points, fit_correction correction, int threads, size_t *moved,
                       bat_error *error);

/// Restart the search for points whose projection converged to a wrong foot.
///
/// Newton's method finds the foot in the basin of attraction of its start. While the surface is stiff, in the first rounds
/// of a fit, this may be a wrong one. The points with the largest distances, far above the mean, restart. The start is the
/// parameter of the nearest point in space whose own distance is at most the mean. A result is kept only if the distance
/// decreases.
bat_status fit_correct_wrong_feet(const fit_nets *nets, fit_points *points, fit_correction correction, int threads,
                                  size_t *moved, bat_error *error);

/// Parameter correction: the parameter of the nearest foot of each point, eq. (6), by a safeguarded Newton method that never
/// increases a distance. Boundary parameters stay on their side and go at most half way to its corners.
/// @param moved receives the number of changed parameters; may be null
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT with the first point that is not finite or whose parameter is not
///         in the square; BAT_NO_MEMORY
bat_status spline_correct(const bat_spline_surface *surface, bat_surface_fit_data *data, size_t *moved, bat_error *error);

#endif
