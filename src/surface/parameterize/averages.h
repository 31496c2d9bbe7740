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

// Stretch minimization: Yoshizawa, Belyaev and Seidel, "A fast and simple stretch-minimizing mesh parameterization" (2004),
// for clouds.
//
// With s_k the stretch at point k, weights are updated by  w_ik <- w_ik / s_k  (rows rescaled to sum 1). The parameters are
// then solved for again. This is repeated while the total stretch decreases. The stretch at a point is the root mean square
// of the singular values of the derivative dx/du, fitted to the neighbours of its row by least squares. The total stretch
// is the root mean square over the interior.

/// Minimize the stretch of parameters.
/// @param rows       weights that the parameters satisfy; changed by every round, including a last one that is rejected
/// @param parameters count x 2
/// @return see averages_solve()
bat_status stretch_minimize(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double *parameters,
                            bat_error *error);

// Parameters of least distortion. The points are triangulated in given parameters (Floater and Reimers, 2001). Then the
// symmetric Dirichlet energy of the triangles is minimized (dirichlet.h). The triangles of a mesh are its own, with new
// points in the middles of edges that join boundary points through the interior.

/// Minimize the distortion of parameters.
/// @param cloud      points in spatial order, scaled to unit size, with a boundary
/// @param rows       weights that the parameters satisfy; changed where points crowd, which are spread first
/// @param parameters count x 2, in [0, 1]^2; unchanged where they have no triangulation without degenerate triangles
/// @return see averages_solve()
bat_status isometric_minimize(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double *parameters,
                              bat_error *error);

#endif
