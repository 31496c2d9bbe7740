#ifndef LINALG_VECTOR2_H
#define LINALG_VECTOR2_H

/// @file
/// Places in the plane.

/// Twice the signed area of the triangle a b c: positive where it is counter-clockwise.
static inline double vector2_turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

#endif
