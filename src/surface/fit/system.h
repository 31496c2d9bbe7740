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

#endif
