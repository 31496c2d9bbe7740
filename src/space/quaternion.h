#pragma once

#include "linalg/vector.h"

/// @file
/// Unit quaternions (w, x, y, z) as rotations, and the functions of angles that their exponential and logarithm need.

/// p and q whose product's scalar part is below this are half a turn apart: the sense of the rotation is lost in rounding.
#define QUATERNION_HALF_TURN 5e-15

static inline double quaternion_dot(const double *p, const double *q)
{
    return (p[0] * q[0] + p[1] * q[1]) + (p[2] * q[2] + p[3] * q[3]);
}

static inline void quaternion_normalize(double *q)
{
    vector_scale(4, 1 / sqrt(quaternion_dot(q, q)), q);
}

/// The same, sooner, for a quaternion whose length is 1 but for rounding and the tolerance of points.
static inline void quaternion_renormalize(double *q)
{
    double excess = quaternion_dot(q, q) - 1;
    if (fabs(excess) < 1e-8)
        vector_scale(4, 1 - 0.5 * excess, q);
    else
        quaternion_normalize(q);
}

/// The rotation from p to q, seen from p: conj(p) q or conj(p)(-q), whichever turns by at most pi.
typedef struct quaternion_step
{
    double cosine;       ///< of half the angle, >= 0
    double x, y, z;      ///< the axis times the sine of half the angle
    double squared_sine; ///< of half the angle
} quaternion_step;

/// The vector part is that of conj(p)(q - p) as well, and differences of near quaternions are exact.
static inline quaternion_step quaternion_step_between(const double *p, const double *q)
{
    double dot = quaternion_dot(p, q);
    double sign = dot < 0 ? -1 : 1;
    double w = sign * q[0] - p[0], x = sign * q[1] - p[1], y = sign * q[2] - p[2], z = sign * q[3] - p[3];
    quaternion_step step;
    step.cosine = sign * dot;
    step.x = p[0] * x - p[1] * w - p[2] * z + p[3] * y;
    step.y = p[0] * y - p[2] * w - p[3] * x + p[1] * z;
    step.z = p[0] * z - p[3] * w - p[1] * y + p[2] * x;
    step.squared_sine = step.x * step.x + step.y * step.y + step.z * step.z;
    return step;
}

// The series below are summed in pairs, not by Horner's rule: logarithms wait for exponentials and exponentials for
// logarithms, so what counts is how soon a sum is there.

/// atan2(s, c) / s from s^2 and c > 0, half an angle over its sine; a common factor of s and c divides it.
static inline double quaternion_angle_over_sine(double squared_sine, double cosine)
{
    double inverse = 1 / cosine;
    double x = squared_sine * (inverse * inverse); // squared tangent
    if (x > 1.0 / 64)
    {
        double sine = sqrt(squared_sine);
        return atan2(sine, cosine) / sine;
    }
    double x2 = x * x, x4 = x2 * x2;
    double low = (1 - x * (1.0 / 3)) + x2 * (1.0 / 5 - x * (1.0 / 7));
    double high = (1.0 / 9 - x * (1.0 / 11)) + x2 * (1.0 / 13 - x * (1.0 / 15)) + x4 * (1.0 / 17);
    return (low + x4 * high) * inverse;
}

/// cos(a) and sin(a) / a from a^2.
static inline void quaternion_cosine_and_ratio(double squared_angle, double *cosine, double *sine_ratio)
{
    double x = squared_angle;
    if (x > 1.0 / 16)
    {
        double angle = sqrt(x);
        *cosine = cos(angle);
        *sine_ratio = sin(angle) / angle;
        return;
    }
    double x2 = x * x, x4 = x2 * x2;
    double even = (1.0 / 24 - x * (1.0 / 720)) + x2 * (1.0 / 40320 - x * (1.0 / 3628800)) + x4 * (1.0 / 479001600);
    *cosine = (1 - x * (1.0 / 2)) + x2 * even;
    double odd = (1.0 / 120 - x * (1.0 / 5040)) + x2 * (1.0 / 362880 - x * (1.0 / 39916800)) + x4 * (1.0 / 6227020800.0);
    *sine_ratio = (1 - x * (1.0 / 6)) + x2 * odd;
}

/// q = p (cos|v|/2, sin|v|/2 v/|v|) for v = (x, y, z), brought to unit length, so that rounding does not add up.
static inline void quaternion_turn(const double *p, double x, double y, double z, double *q)
{
    double cosine, ratio;
    quaternion_cosine_and_ratio(0.25 * (x * x + y * y + z * z), &cosine, &ratio);
    x *= 0.5 * ratio;
    y *= 0.5 * ratio;
    z *= 0.5 * ratio;
    q[0] = p[0] * cosine - p[1] * x - p[2] * y - p[3] * z;
    q[1] = p[0] * x + p[1] * cosine + p[2] * z - p[3] * y;
    q[2] = p[0] * y + p[2] * cosine + p[3] * x - p[1] * z;
    q[3] = p[0] * z + p[3] * cosine + p[1] * y - p[2] * x;
    quaternion_renormalize(q);
}
