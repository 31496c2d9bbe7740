#ifndef SURFACE_FIT_SYSTEM_H
#define SURFACE_FIT_SYSTEM_H

#include "surface/fit/pattern.h"
#include "surface/fit/points.h"

/// @file
/// The normal equations of a penalized least-squares fit over a space,
///     (G + 2 lambda M) c = b,   G = A^T W A,   b = A^T W x,
/// with A the functions at the points and M the thin-plate matrix (fit_thin_plate.h). Both matrices share one pattern: two
/// functions meet when they do not vanish on a common cell.

enum
{
    FIT_PROBES = 2 ///< random right-hand sides beside the coordinates, for the trace of the influence matrix
};

/// Release it with fit_system_free().
typedef struct fit_system
{
    const bat_hierarchical_space *space;
    size_t functions;
    size_t dimension; ///< of points
    size_t columns;   ///< of right-hand sides: dimension + FIT_PROBES
    fit_pattern pattern;
    double *gram;   ///< G's lower triangle
    double *plate;  ///< M's
    double *right;  ///< functions x columns: b, then A^T W^1/2 z for vectors z of random signs
    double square;  ///< sum of w |x|^2 over the points
    size_t counted; ///< points of a weight above 0
    int threads;
} fit_system;

/// The pattern and the thin-plate matrix of a space, which must outlive the system.
bat_status fit_system_make(const bat_hierarchical_space *space, size_t dimension, int threads, fit_system *system,
                           bat_error *error);
void fit_system_free(fit_system *system);

/// Gather G, b and the sums from points that are sorted by cells. The same bytes for any number of threads.
bat_status fit_system_gather(fit_system *system, const fit_points *points, bat_error *error);

/// Gather A^T W r alone.
/// @param rows   of points: count x dimension
/// @param result receives functions x dimension
bat_status fit_system_gather_residual(const fit_system *system, const fit_points *points, const double *rows, double *result,
                                      bat_error *error);

/// product = S x for a symmetric matrix of the system's pattern.
/// @param x functions x columns, and so is the product
void fit_system_multiply(const fit_system *system, const double *values, size_t columns, const double *x, double *product);

#endif
