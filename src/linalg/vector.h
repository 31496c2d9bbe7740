#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// @file
/// Angles in radians, and short vectors. First: places in the plane.

#define ANGLE_PI 3.14159265358979323846
#define ANGLE_TURN 6.28318530717958647693
#define ANGLE_DEGREE (ANGLE_PI / 180)

/// Twice the signed area of the triangle a b c: positive where it is counter-clockwise.
static inline double vector2_turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Vectors of n numbers.

static inline double vector_dot(size_t n, const double *u, const double *v)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += u[i] * v[i];
    return sum;
}

static inline double vector_square(size_t n, const double *v)
{
    return vector_dot(n, v, v);
}

/// The distance of two points.
static inline double vector_distance(size_t n, const double *p, const double *q)
{
    double square = 0;
    for (size_t i = 0; i < n; i++)
        square += (p[i] - q[i]) * (p[i] - q[i]);
    return sqrt(square);
}

/// The largest absolute value.
static inline double vector_largest(size_t n, const double *v)
{
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(v[i]));
    return largest;
}

/// sum += factor v.
static inline void vector_add(size_t n, double factor, const double *v, double *sum)
{
    for (size_t i = 0; i < n; i++)
        sum[i] += factor * v[i];
}

static inline void vector_subtract(size_t n, const double *a, const double *b, double *difference)
{
    for (size_t i = 0; i < n; i++)
        difference[i] = a[i] - b[i];
}

/// v *= factor.
static inline void vector_scale(size_t n, double factor, double *v)
{
    for (size_t i = 0; i < n; i++)
        v[i] *= factor;
}

static inline bool vector_is_finite(size_t n, const double *v)
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(v[i]))
            return false;
    return true;
}

// Vectors of three numbers.

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

static inline double vector3_determinant(const double a[3], const double b[3], const double c[3])
{
    double product[3];
    vector3_cross(b, c, product);
    return vector3_dot(a, product);
}

static inline void vector3_subtract(const double a[3], const double b[3], double difference[3])
{
    vector_subtract(3, a, b, difference);
}

/// (b - a) x (c - a): perpendicular to a triangle, with twice its area.
static inline void vector3_triangle(const double a[3], const double b[3], const double c[3], double product[3])
{
    double u[3], v[3];
    vector3_subtract(b, a, u);
    vector3_subtract(c, a, v);
    vector3_cross(u, v, product);
}

/// The same for three of the points of an array.
static inline void vector3_face(const double *points, const uint32_t corners[3], double product[3])
{
    vector3_triangle(points + 3 * (size_t)corners[0], points + 3 * (size_t)corners[1], points + 3 * (size_t)corners[2],
                     product);
}

static inline double vector3_length(const double a[3])
{
    return sqrt(vector3_dot(a, a));
}

/// Scale to length 1. False for a vector of length 0, which stays.
static inline bool vector3_normalize(double a[3])
{
    double length = vector3_length(a);
    for (int c = 0; c < 3 && length > 0; c++)
        a[c] /= length;
    return length > 0;
}

/// The angle between two vectors, accurate at 0 and at pi.
static inline double vector3_angle(const double a[3], const double b[3])
{
    double product[3];
    vector3_cross(a, b, product);
    return atan2(vector3_length(product), vector3_dot(a, b));
}

static inline double vector3_distance(const double a[3], const double b[3])
{
    return vector_distance(3, a, b);
}

/// The squared chord between two points.
static inline double chord_square(const double *p, const double *q)
{
    double dx = q[0] - p[0], dy = q[1] - p[1], dz = q[2] - p[2];
    return dx * dx + dy * dy + dz * dz;
}

/// The angle between two points of the sphere, accurate when they are near.
static inline double chord_angle(const double *p, const double *q)
{
    return 2 * atan2(sqrt(chord_square(p, q)), sqrt(chord_square(p, (double[3]){-q[0], -q[1], -q[2]})));
}

/// Complete a frame whose last axis has any length (Duff et al., "Building an orthonormal basis, revisited", 2017).
static inline void vector3_complete(double axes[3][3])
{
    (void)vector3_normalize(axes[2]);
    double x = axes[2][0], y = axes[2][1], sign = copysign(1, axes[2][2]), a = -1 / (sign + axes[2][2]);
    const double first[2][3] = {{1 + sign * x * x * a, sign * x * y * a, -sign * x}, {x * y * a, sign + y * y * a, -y}};
    for (int k = 0; k < 6; k++)
        axes[k / 3][k % 3] = first[k / 3][k % 3];
}

// Boxes along the axes of n dimensions, from `low` to `high`.

/// Make a box empty: every point widens it.
static inline void box_clear(size_t n, double *low, double *high)
{
    for (size_t k = 0; k < n; k++)
    {
        low[k] = INFINITY;
        high[k] = -INFINITY;
    }
}

/// Widen a box so that it contains a point. Of two zeros the first stays, and what is no number is left out.
static inline void box_include(size_t n, const double *point, double *low, double *high)
{
    for (size_t k = 0; k < n; k++)
    {
        low[k] = point[k] < low[k] ? point[k] : low[k];
        high[k] = point[k] > high[k] ? point[k] : high[k];
    }
}

/// The box of `count` points; empty without any.
static inline void box_of_points(size_t n, const double *points, size_t count, double *low, double *high)
{
    box_clear(n, low, high);
    for (size_t i = 0; i < count; i++)
        box_include(n, points + n * i, low, high);
}
