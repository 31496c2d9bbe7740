#ifndef SURFACE_PARAMETERIZE_STRETCH_H
#define SURFACE_PARAMETERIZE_STRETCH_H

#include "surface/parameterize/averages.h"

/// @file
/// Stretch minimization: Yoshizawa, Belyaev and Seidel, "A fast and simple stretch-minimizing mesh parameterization" (2004),
/// for clouds.
///
/// With s_k the stretch at point k, weights are updated by  w_ik <- w_ik / s_k  (rows rescaled to sum 1). The parameters are
/// then solved for again. This is repeated while the total stretch decreases. The stretch at a point is the root mean square
/// of the singular values of the derivative dx/du, fitted to the neighbours of its row by least squares. The total stretch
/// is the root mean square over the interior.

/// Minimize the stretch of parameters.
/// @param rows       weights that the parameters satisfy; changed by every round, including a last one that is rejected
/// @param parameters count x 2
/// @return see averages_solve()
bat_status stretch_minimize(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double *parameters,
                            bat_error *error);

#endif
