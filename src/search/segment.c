#include "search/nearest.h"

#include <math.h>
#include <stdbool.h>

/// The exponent that brings the largest component of q - p to 1/2 … 1; false when they are equal.
static bool exponent_of_difference(const double *p, const double *q, size_t dim, int *exponent)
{
    double largest = 0;
    for (size_t axis = 0; axis < dim; axis++)
        largest = fmax(largest, fabs(q[axis] - p[axis]));
    (void)frexp(largest, exponent);
    return largest > 0;
}

double segment_share_of_any(const double *a, const double *b, const double *point, size_t dim)
{
    int of_side, of_point;
    if (!exponent_of_difference(a, b, dim, &of_side) || !exponent_of_difference(a, point, dim, &of_point))
        return 0;
    double along = 0, squared = 0;
    for (size_t axis = 0; axis < dim; axis++)
    {
        double side = ldexp(b[axis] - a[axis], -of_side);
        along += ldexp(point[axis] - a[axis], -of_point) * side;
        squared += side * side;
    }
    double share = ldexp(along / squared, of_point - of_side);
    return share <= 0 ? 0 : share >= 1 ? 1 : share;
}
