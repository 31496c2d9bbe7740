#ifndef SURFACE_NETWORK_POLYNOMIAL_PATCH_H
#define SURFACE_NETWORK_POLYNOMIAL_PATCH_H

#include "batten/base.h"

/// @file
/// Least-squares polynomial patch through a cloud with parameters: features for a network, and foot points.
///     X(u, v) = sum over a, b <= PATCH_DEGREE of c_ab P_a(2 u - 1) P_b(2 v - 1)
/// P_a is the Legendre polynomial of degree a. A small penalty on (a^2 + b^2)^2 |c_ab|^2 makes the fit unique where there
/// are few points.

enum
{
    PATCH_DEGREE = 6,
    PATCH_TERMS = (PATCH_DEGREE + 1) * (PATCH_DEGREE + 1), ///< term (a, b) has index a (PATCH_DEGREE + 1) + b
    PATCH_FEATURES = 3 * (PATCH_TERMS - 1)                 ///< number of features of a patch
};

/// A patch.
typedef struct polynomial_patch
{
    double terms[PATCH_TERMS][3]; ///< coefficients c_ab
    double residual;              ///< root mean square of |X(u_i) - x_i|
} polynomial_patch;

/// The Legendre polynomials of degrees 0 to `degree` (at least 1) at 2 t - 1.
void legendre_polynomials(double t, int degree, double *values);

/// Fit a patch.
/// @param points     count x 3, in the unit box, at least one
/// @param parameters count x 2
/// @param noise      standard deviation of a coordinate; increases the penalty
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_NO_CONVERGENCE for parameters that are not finite
bat_status polynomial_patch_fit(const double *points, const double *parameters, size_t count, double noise,
                                polynomial_patch *descriptor, bat_error *error);

/// One Gauss-Newton step from a point's parameters towards its foot on the patch.
void polynomial_patch_step(const polynomial_patch *descriptor, const double point[3], const double parameter[2],
                           double step[2]);

/// The coefficients except c_00, in a normalized frame: the first axis is along c_10, the second in the plane of c_10 and
/// c_01, and |c_10 x c_01| = 1. They are invariant under translation, rotation and scaling of the cloud. Under reflection
/// the third coordinates change sign.
/// @param features receives PATCH_FEATURES numbers
/// @return false when c_10 and c_01 are parallel or zero; `features` is then undefined
bool polynomial_patch_features(const polynomial_patch *descriptor, double *features);

#endif
