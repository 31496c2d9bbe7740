#pragma once

#include "base/lanes.h"

/// @file
/// The number type of the learning core: float, or double when the sources are compiled with LEARN_DOUBLE. The double build
/// is for tests: central differences check derivatives to many digits there. A program links one of the two. The elementary
/// functions in single precision have no branches, as those of base/lanes.h; their coefficients come from
/// scripts/fit-polynomials.py.

#if defined(LEARN_DOUBLE)

typedef double real;

static inline double real_exp(double x)
{
    return exp(x);
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

/// exp(x) to two units in the last place; below -87 it is exp(-87), above 88 exp(88).
static inline float real_exp(float x)
{
    x = x > -87.0F ? x : -87.0F;
    x = x < 88.0F ? x : 88.0F;
    // x = n log 2 + r. Adding 1.5 * 2^23 rounds to a whole number, whose bits then stand at the end of the sum's.
    const float rounder = 0x1.8p+23F;
    float shifted = x * 0x1.715476p+0F + rounder;
    float n = shifted - rounder;
    float r = (x - n * 0x1.62e4p-1F) - n * 0x1.7f7d1cp-20F;
    float p = 0x1.6d10fcp-10F;
    p = p * r + 0x1.120b62p-7F;
    p = p * r + 0x1.55551ap-5F;
    p = p * r + 0x1.5554dep-3F;
    p = p * r + 0.5F;
    float value = (p * r) * r + r + 1.0F;
    // Adding n to the exponent multiplies by 2^n.
    uint32_t bits, exponent;
    memcpy(&bits, &value, sizeof bits);
    memcpy(&exponent, &shifted, sizeof exponent);
    bits += exponent << 23;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/// tanh(x) to 3e-7 relative.
static inline float real_tanh(float x)
{
    float z = x * x;
    float p = -0x1.8f8de4p-8F;
    p = p * z + 0x1.58048ep-6F;
    p = p * z - 0x1.b9258ap-5F;
    p = p * z + 0x1.110e1cp-3F;
    p = p * z - 0x1.555552p-2F;
    float near = x + x * (z * p);
    float far = 1.0F - 2.0F / (1.0F + real_exp(2.0F * fabsf(x)));
    return z <= 0.390625F ? near : copysignf(far, x);
}

/// The normal distribution: returns the chance of a number below `x`, to 1e-7, and the density at x.
static inline float real_normal(float x, float *density)
{
    float a = fabsf(x);
    float e = real_exp(-0.5F * a * a);
    float t = 1.0F / (1.0F + 0.28F * a);
    float p = 0x1.58322cp-6F;
    p = p * t - 0x1.32456ep-4F;
    p = p * t + 0x1.ab9eb2p-5F;
    p = p * t + 0x1.4dc5aep-5F;
    p = p * t + 0x1.44e9p-5F;
    p = p * t + 0x1.909ff6p-4F;
    p = p * t + 0x1.977782p-4F;
    p = p * t + 0x1.cb8e7cp-4F;
    p = p * t + 0x1.c96c44p-4F;
    float tail = e * t * p;
    *density = 0x1.988454p-2F * e;
    return x < 0 ? tail : 1.0F - tail;
}

#endif

/// GELU(x) = x P(X < x) for a standard normal X (Hendrycks and Gimpel 2016), the exact one.
static inline real real_gelu(real x)
{
    real density;
    return x * real_normal(x, &density);
}
