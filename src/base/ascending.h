#ifndef BASE_ASCENDING_H
#define BASE_ASCENDING_H

/// The order of two doubles, for qsort(): the lesser first. Neither is NaN.
static inline int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#endif
