#ifndef SURFACE_PARAMETERIZE_STRETCH_H
#define SURFACE_PARAMETERIZE_STRETCH_H

#include "surface/parameterize/averages.h"

/// Even out how much the map from parameters to points stretches: weights are divided by the stretch at the neighbour, and
/// the system is solved anew, as long as the stretch of the whole falls (Yoshizawa, Belyaev and Seidel, "A fast and simple
/// stretch-minimizing mesh parameterization", 2004; here for clouds).
///
/// The stretch at a point is the root mean square of the singular values of the map's derivative, which its row's neighbours
/// tell by least squares; that of the whole is its root mean square over the interior.
/// @param rows       averages that the parameters obey; changed by every round, the last one that was not worthwhile too
/// @param parameters count x 2
/// @return as averages_solve()
bat_status stretch_minimize(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double *parameters,
                            bat_error *error);

#endif
