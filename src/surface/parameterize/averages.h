#ifndef SURFACE_PARAMETERIZE_AVERAGES_H
#define SURFACE_PARAMETERIZE_AVERAGES_H

#include "batten/cloud.h"
#include "linalg/sparse_rows.h"

/// @file
/// Solution of u_i = sum_k w_ik u_k for the parameters of interior points, w_ik >= 0, sum_k w_ik = 1, with the other
/// parameters fixed: Floater and Reimers, "Meshless parameterization and surface reconstruction" (2001).

/// The solver: direct, or iterative.
typedef struct average_solver
{
    bool direct;
    int threads;           ///< threads of the iteration, 0: the default of OpenMP; the result does not depend on it
    bat_progress progress; ///< of the rounds of iterative methods
} average_solver;

/// Solve for some interior points.
/// @param rows       weights from weights_build(), with every point connected to the boundary
/// @param moved      count: the points to solve for, none on the boundary; null for the whole interior
/// @param solver     the solver
/// @param parameters count x 2; fixed ones are read, the others receive values in the bounding box of the fixed ones
/// @return BAT_OK, BAT_NO_CONVERGENCE or BAT_NO_MEMORY
bat_status averages_solve(const bat_cloud *cloud, const sparse_rows *rows, const bool *moved, average_solver solver,
                          double *parameters, bat_error *error);

#endif
