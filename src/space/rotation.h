#ifndef SPACE_ROTATION_H
#define SPACE_ROTATION_H

#include "batten/space.h"

/// @file
/// The rotation group as it is used by the spaces that contain it. Tangent vectors are rotation vectors in the body's frame.

const char *rotation_fault(const double *point);
bat_status rotation_project(const double *coordinates, double *point);
double rotation_distance(const double *p, const double *q);
bat_status rotation_log(const double *p, const double *q, double *tangent);
bat_status rotation_exp(const double *p, const double *tangent, double *q);
bat_status rotation_transport(const double *p, const double *q, const double *tangent, double *transported);
void rotation_random(bat_random *random, double *point);
bat_status rotation_geodesic(const double *p, const double *q, double t, double *point);

#endif
