#ifndef SURFACE_PARAMETERIZE_AVERAGES_H
#define SURFACE_PARAMETERIZE_AVERAGES_H

#include "batten/cloud.h"
#include "linalg/sparse_rows.h"

/// How a system is solved: by decomposition, or by iteration with some threads.
typedef struct average_solver
{
    bool direct;
    int threads; ///< of the iteration, as many as OpenMP gives when 0; the result is the same
} average_solver;

/// Solve u_i = sum_k rows_ik u_k for some interior points, the others being given.
/// @param rows       what weights_build() gives, each point joined to the boundary
/// @param moved      count: which points are solved for, never on the boundary; null for the whole interior
/// @param way        how
/// @param parameters count x 2; what is given is read, the rest receives numbers within the box of what is given
/// @return BAT_OK, BAT_NO_CONVERGENCE or BAT_NO_MEMORY
bat_status averages_solve(const bat_cloud *cloud, const sparse_rows *rows, const bool *moved, average_solver solver,
                          double *parameters, bat_error *error);

#endif
