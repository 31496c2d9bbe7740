#ifndef SURFACE_CLOUD_LOCAL_QUADRATIC_H
#define SURFACE_CLOUD_LOCAL_QUADRATIC_H

#include "surface/cloud/local_plane.h"

/// @file
/// Quadratic polynomials over tangent planes, by least squares.

enum
{
    LOCAL_QUADRATIC_TERMS = 6 ///< of a quadratic polynomial of two variables
};

/// Heights z = t_0 + t_1 x + t_2 y + t_3 x^2 + t_4 x y + t_5 y^2 above a plane, with x and y relative to its centre and in
/// units of `scale`.
typedef struct local_quadratic
{
    local_plane plane;
    double scale;
    double terms[LOCAL_QUADRATIC_TERMS]; ///< those that the points do not determine are 0
} local_quadratic;

/// Fit a polynomial to the listed points.
/// @param plane with positive variance along its first axis
local_quadratic local_quadratic_fit(const double *points, const neighbour_list *near, const local_plane *plane);

/// The height of a point above the polynomial, along the plane's normal.
double local_quadratic_height(const local_quadratic *quadratic, const double point[3]);

#endif
