#ifndef SEARCH_SEGMENT_H
#define SEARCH_SEGMENT_H

#include <float.h>
#include <stddef.h>

/// @file
/// Squared Euclidean distances for any finite coordinates up to DBL_MAX / 2. Squares leave the range of a double long before
/// their roots do, so every function takes a power of two, `scale`, that differences are multiplied by: 1 first, and where
/// segment_scale() says so, once more by another.

/// The scale to measure with, given what came out with scale 1: 1 where that is good.
static inline double segment_scale(double squared)
{
    return squared < 0x1p-900 ? 0x1p600 : squared <= DBL_MAX ? 1 : 0x1p-600;
}

/// From p to q.
static inline double point_squared(const double *p, const double *q, size_t dim, double scale)
{
    double sum = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double difference = (p[axis] - q[axis]) * scale;
        sum += difference * difference;
    }
    return sum;
}

/// segment_share() for segments of any length, and of length 0.
double segment_share_of_any(const double *a, const double *b, const double *point, size_t dim);

/// Where on the segment from `a` to `b` it is nearest to the point: 0 at `a`, 1 at `b`.
static inline double segment_share(const double *a, const double *b, const double *point, size_t dim)
{
    double along = 0, squared = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double side = b[axis] - a[axis];
        along += (point[axis] - a[axis]) * side;
        squared += side * side;
    }
    // Elsewhere one of the two sums may have left the range, or lost digits at its lower end.
    if (!(squared >= 0x1p-200 && squared <= 0x1p900 && along >= -DBL_MAX && along <= DBL_MAX))
        return segment_share_of_any(a, b, point, dim);
    return along <= 0 ? 0 : along >= squared ? 1 : along / squared;
}

/// From the segment from `a` to `b` to the point.
static inline double segment_squared(const double *a, const double *b, const double *point, size_t dim, double scale)
{
    double share = segment_share(a, b, point, dim);
    if (share == 0 || share == 1)
        return point_squared(share == 0 ? a : b, point, dim, scale);
    double sum = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double difference = ((point[axis] - a[axis]) - share * (b[axis] - a[axis])) * scale;
        sum += difference * difference;
    }
    return sum;
}

#endif
