#ifndef SPACE_ROTATION_H
#define SPACE_ROTATION_H

#include "batten/space.h"

/// @file
/// The functions of the rotation group, for the spaces that contain it as well: none reads `space`. Tangent vectors are
/// rotation vectors in the body's frame.

const char *rotation_fault(const bat_space *space, const double *point);
bat_status rotation_project(const bat_space *space, const double *coordinates, double *point);
double rotation_distance(const bat_space *space, const double *p, const double *q);
bat_status rotation_log(const bat_space *space, const double *p, const double *q, double *tangent);
bat_status rotation_exp(const bat_space *space, const double *p, const double *tangent, double *q);
bat_status rotation_transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                              double *transported);
void rotation_random(const bat_space *space, bat_random *random, double *point);
bat_status rotation_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point);

#endif
