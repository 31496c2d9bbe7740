#ifndef LEARN_ROW_STATISTICS_H
#define LEARN_ROW_STATISTICS_H

#include "learn/real.h"

#include <stddef.h>

/// Added to the variance of a normalization.
static const real NORMALIZATION_EPSILON = (real)1e-5;

/// The mean of a row and one over its deviation.
static inline void row_statistics(const real *x, size_t columns, real *mean, real *rate)
{
    real sum = 0, squares = 0;
#pragma omp simd reduction(+ : sum)
    for (size_t c = 0; c < columns; c++)
        sum += x[c];
    real m = sum / (real)columns;
#pragma omp simd reduction(+ : squares)
    for (size_t c = 0; c < columns; c++)
        squares += (x[c] - m) * (x[c] - m);
    *mean = m;
    *rate = 1 / real_sqrt(squares / (real)columns + NORMALIZATION_EPSILON);
}

#endif
