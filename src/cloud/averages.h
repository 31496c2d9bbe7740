#ifndef CLOUD_AVERAGES_H
#define CLOUD_AVERAGES_H

#include "batten/cloud.h"
#include "linalg/sparse_rows.h"

/// Solve u_i = sum_k rows_ik u_k for the interior points.
/// @param rows     what weights_build() gives, each point joined to the boundary
/// @param boundary boundary_count x 2
/// @param direct   by decomposition at any size; else by iteration
/// @param parameters receives count x 2, within the box of the boundary's
/// @return BAT_OK, BAT_NO_CONVERGENCE or BAT_NO_MEMORY
bat_status averages_solve(const bat_cloud *cloud, const sparse_rows *rows, const double *boundary, bool direct,
                          double *parameters, bat_error *error);

#endif
