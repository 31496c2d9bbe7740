#ifndef SURFACE_PARAMETERIZE_ISOMETRIC_H
#define SURFACE_PARAMETERIZE_ISOMETRIC_H

#include "surface/parameterize/averages.h"

/// @file
/// Parameters of least distortion. The points are triangulated in given parameters (Floater and Reimers, 2001). Then the
/// symmetric Dirichlet energy of the triangles is minimized (dirichlet.h). The triangles of a mesh are its own, with new
/// points in the middles of edges that join boundary points through the interior.

/// Minimize the distortion of parameters.
/// @param cloud      points in spatial order, scaled to unit size, with a boundary
/// @param rows       weights that the parameters satisfy; changed where points crowd, which are spread first (stretch.h)
/// @param parameters count x 2, in [0, 1]^2; unchanged where they have no triangulation without degenerate triangles
/// @return see averages_solve()
bat_status isometric_minimize(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double *parameters,
                              bat_error *error);

#endif
