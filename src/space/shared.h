#ifndef SPACE_SHARED_H
#define SPACE_SHARED_H

#include "batten/space.h"

/// @file
/// Functions that spaces share.

/// "not finite" where a point has such a coordinate, else null.
const char *space_not_finite(const bat_space *space, const double *point);
/// bat_space::project where every valid point is its own nearest one, and others have none.
bat_status space_project_valid(const bat_space *space, const double *coordinates, double *point);
/// bat_space::inner of orthonormal coordinates.
double space_inner(const bat_space *space, const double *p, const double *u, const double *v);

#endif
