#ifndef SURFACE_NETWORK_POLYNOMIAL_PATCH_H
#define SURFACE_NETWORK_POLYNOMIAL_PATCH_H

#include "batten/base.h"

/// @file
/// A cloud with parameters as a polynomial patch, by least squares: what a network sees of it, and where points have their
/// feet.
///
///     X(u, v) = sum over a, b up to PATCH_DEGREE of c_ab P_a(2 u - 1) P_b(2 v - 1)
///
/// P are Legendre's polynomials. High coefficients cost a little, by the square of a^2 + b^2, which decides where points are
/// few.

enum
{
    PATCH_DEGREE = 6,
    PATCH_TERMS = (PATCH_DEGREE + 1) * (PATCH_DEGREE + 1), ///< term (a, b) has place a (PATCH_DEGREE + 1) + b
    PATCH_FEATURES = 3 * (PATCH_TERMS - 1)                 ///< numbers that a network sees
};

typedef struct polynomial_patch
{
    double terms[PATCH_TERMS][3];
    double residual; ///< root of the mean square distance of points from the patch at their parameters
} polynomial_patch;

/// Legendre's polynomials 0 to `degree`, at least 1, of 2 t - 1.
void legendre_polynomials(double t, int degree, double *values);

/// @param points     count x 3, in the unit box, at least one
/// @param parameters count x 2
/// @param noise      the points', as the standard deviation of a coordinate: the more, the more coefficients cost
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_NO_CONVERGENCE for parameters that are not finite
bat_status polynomial_patch_fit(const double *points, const double *parameters, size_t count, double noise,
                                polynomial_patch *descriptor, bat_error *error);

/// How far a point's parameters are from those of its foot on the patch: a Gauss-Newton step.
void polynomial_patch_step(const polynomial_patch *descriptor, const double point[3], const double parameter[2],
                           double step[2]);

/// The coefficients but the first, turned and scaled so that that of P_1(u) lies along the first axis and spans, with that
/// of P_1(v), a parallelogram of area 1 in the plane of the first two: nothing that depends on where the cloud lies, how it
/// is turned, and how large it is. Of a mirror image the third coordinates change sign.
/// @param seen receives PATCH_FEATURES numbers
/// @return false when these two are parallel or zero, and the numbers are none
bool polynomial_patch_features(const polynomial_patch *descriptor, double *features);

#endif
