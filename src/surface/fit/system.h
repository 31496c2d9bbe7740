#ifndef SURFACE_FIT_SYSTEM_H
#define SURFACE_FIT_SYSTEM_H

#include "surface/fit/pattern.h"
#include "surface/fit/points.h"

/// @file
/// The normal equations of a penalized least-squares fit over a space,
///     (G + 2 lambda M) c = b,   G = A^T W A,   b = A^T W x,
///     M_ij = integral over [0, 1]^2 of B_i,uu B_j,uu + B_i,uv B_j,uv + B_i,vv B_j,vv.
/// A holds the values of the functions B_j at the parameters of the points, W the weights, x the points. M is the thin-plate
/// matrix: c^T M c is the energy J of eq. (5) of Giannelli et al. (2023). G and M have the same sparsity pattern
/// (pattern.h).

enum
{
    FIT_PROBES = 2 ///< random right-hand sides besides the coordinates, to estimate the trace of the influence matrix
};

/// The matrices and right-hand sides of a fit. Release it with fit_system_free().
typedef struct fit_system
{
    const bat_hierarchical_space *space;
    size_t functions;
    size_t dimension; ///< of the points
    size_t columns;   ///< number of right-hand sides: dimension + FIT_PROBES
    fit_pattern pattern;
    double *gram;   ///< lower triangle of G
    double *plate;  ///< lower triangle of M
    double *right;  ///< functions x columns: b, then A^T W^1/2 z for random vectors z with entries +1 and -1
    double square;  ///< sum of w |x|^2 over the points
    size_t counted; ///< number of points with positive weight
    int threads;
} fit_system;

/// Compute the pattern and the thin-plate matrix of a space, which must outlive the system. Of the processes of a group, the
/// first alone has them.
/// @param group    null for one process
/// @param levelled whether the integral over a cell of level l counts 16^-l: the energy of a function then does not grow
///                 with its level
bat_status fit_system_make(const bat_hierarchical_space *space, const bat_group *group, size_t dimension, bool levelled,
                           int threads, fit_system *system, bat_error *error);
void fit_system_free(fit_system *system);

/// Assemble G, b and the sums. Requires fit_points_sort(). The result is the same for any number of threads and processes.
bat_status fit_system_gather(fit_system *system, const fit_points *points, bat_error *error);

/// Compute A^T W r for residuals r.
/// @param rows   residuals r, count x dimension
/// @param result receives functions x dimension
bat_status fit_system_gather_residual(const fit_system *system, const fit_points *points, const double *rows, double *result,
                                      bat_error *error);

/// product = S x for a symmetric matrix S with the pattern of the system.
/// @param x functions x columns; `product` has the same shape
void fit_system_multiply(const fit_system *system, const double *values, size_t columns, const double *x, double *product);

/// Fit control points over a space by penalized least squares, eq. (5) of the paper:
///     min  1/2 sum_i w_i |S(u_i) - x_i|^2  +  lambda  integral |S_uu|^2 + |S_uv|^2 + |S_vv|^2
/// The matrix of the thin plate is exact (Gauss quadrature on every cell). Where lambda is 0 and functions have no data, the
/// least smoothing that makes the system regular in double precision is added; `*lambda` receives it.
/// @param weights count, at least 0; null: ones
/// @param lambda  the weight of smoothing, at least 0; receives the weight used
/// @param control receives functions x dimension
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT with the first point that is not finite or whose parameter is not
///         in the square; BAT_NO_CONVERGENCE for a system that is singular even so; BAT_TOO_LARGE; BAT_NO_MEMORY
bat_status spline_fit(const bat_hierarchical_space *space, const bat_surface_fit_data *data, const double *weights,
                      double *lambda, double *control, bat_error *error);

/// Parameter correction: the parameter of the nearest foot of each point, eq. (6), by a safeguarded Newton method that never
/// increases a distance. Boundary parameters stay on their side and go at most half way to its corners.
/// @param moved receives the number of changed parameters; may be null
/// @return as spline_fit()
bat_status spline_correct(const bat_spline_surface *surface, bat_surface_fit_data *data, size_t *moved, bat_error *error);

#endif
