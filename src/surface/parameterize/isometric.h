#ifndef SURFACE_PARAMETERIZE_ISOMETRIC_H
#define SURFACE_PARAMETERIZE_ISOMETRIC_H

#include "surface/parameterize/averages.h"

/// @file
/// Parameters of least distortion. The points are triangulated in given parameters (Floater and Reimers, 2001). Then the
/// symmetric Dirichlet energy of the triangles,
///     E = sum over triangles of area (s_1^2 + s_2^2 + s_1^-2 + s_2^-2),
/// is minimized by scalable locally injective mappings: Rabinovich, Poranne, Panozzo and Sorkine-Hornung (2017). s_1 and s_2
/// are the singular values of the map from the triangle to the parameters, scaled so that the total area is that of the
/// square. The energy is infinite where a triangle degenerates, so that no triangle turns over. Points of the boundary slide
/// along their side of the square, those at its corners stay. The triangles of a mesh are its own, with new points in the
/// middles of edges that join boundary points through the interior.

/// Minimize the distortion of parameters.
/// @param cloud      points in spatial order, scaled to unit size, with a boundary
/// @param rows       weights that the parameters satisfy; changed where points crowd, which are spread first (stretch.h)
/// @param parameters count x 2, in [0, 1]^2; unchanged where they have no triangulation without degenerate triangles
/// @return see averages_solve()
bat_status isometric_minimize(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double *parameters,
                              bat_error *error);

#endif
