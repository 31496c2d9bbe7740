#ifndef LEARN_REAL_H
#define LEARN_REAL_H

#include "base/lanes_single.h"

/// @file
/// The number type of the learning core: float, or double when the sources are compiled with LEARN_DOUBLE. The double build
/// is for tests: central differences check derivatives to many digits there. A program links one of the two.

#if defined(LEARN_DOUBLE)

typedef double real;

static inline double real_exp(double x)
{
    return exp(x);
}

static inline double real_sqrt(double x)
{
    return sqrt(x);
}

static inline double real_sigmoid(double x)
{
    return 1 / (1 + exp(-x));
}

static inline double real_tanh(double x)
{
    return tanh(x);
}

/// The chance of a standard normal number below x, and the density at x.
static inline double real_normal(double x, double *density)
{
    *density = 0.39894228040143267794 * exp(-0.5 * x * x);
    return 0.5 * erfc(-0.70710678118654752440 * x);
}

#else

typedef float real;

static inline float real_exp(float x)
{
    return lane_single_exp(x);
}

static inline float real_sqrt(float x)
{
    return sqrtf(x);
}

static inline float real_sigmoid(float x)
{
    return lane_single_sigmoid(x);
}

static inline float real_tanh(float x)
{
    return lane_single_tanh(x);
}

/// The chance of a standard normal number below x, and the density at x.
static inline float real_normal(float x, float *density)
{
    return lane_single_normal(x, density);
}

#endif

/// GELU(x) = x P(X < x) for a standard normal X (Hendrycks and Gimpel 2016), the exact one.
static inline real real_gelu(real x)
{
    real density;
    return x * real_normal(x, &density);
}

/// The derivative of GELU.
static inline real real_gelu_slope(real x)
{
    real density;
    real below = real_normal(x, &density);
    return below + x * density;
}

#endif
