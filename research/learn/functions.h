#ifndef RESEARCH_LEARN_FUNCTIONS_H
#define RESEARCH_LEARN_FUNCTIONS_H

#include "learn/real.h"

#include <stddef.h>

/// @file
/// Functions of single numbers and of rows that networks in training have beside those of inference.

/// 1 / (1 + exp(-x))
static inline real real_sigmoid(real x)
{
    return 1 / (1 + real_exp(-x));
}

/// The derivative of GELU.
static inline real real_gelu_slope(real x)
{
    real density;
    real below = real_normal(x, &density);
    return below + x * density;
}

static inline real real_sqrt(real x)
{
#if defined(LEARN_DOUBLE)
    return sqrt(x);
#else
    return sqrtf(x);
#endif
}

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
