#ifndef LINALG_VECTOR_H
#define LINALG_VECTOR_H

#include <math.h>

/// @file
/// Places in the plane.

/// Twice the signed area of the triangle a b c: positive where it is counter-clockwise.
static inline double vector2_turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Vectors of three numbers.

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
