#ifndef LINALG_VECTOR3_H
#define LINALG_VECTOR3_H

#include <math.h>

/// @file
/// Vectors of three numbers.

/// a . b
static inline double vector3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// product = a x b; it may not lie where a or b does.
static inline void vector3_cross(const double a[3], const double b[3], double product[3])
{
    product[0] = a[1] * b[2] - a[2] * b[1];
    product[1] = a[2] * b[0] - a[0] * b[2];
    product[2] = a[0] * b[1] - a[1] * b[0];
}

/// difference = a - b
static inline void vector3_subtract(const double a[3], const double b[3], double difference[3])
{
    for (int c = 0; c < 3; c++)
        difference[c] = a[c] - b[c];
}

/// The distance of two points.
static inline double vector3_distance(const double a[3], const double b[3])
{
    double difference[3];
    vector3_subtract(a, b, difference);
    return sqrt(vector3_dot(difference, difference));
}

#endif
