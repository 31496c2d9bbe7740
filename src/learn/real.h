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

/// The normal distribution: returns the chance of a number below `x`, to 3e-7 and 0 below -5.4, and the density at x.
static inline float real_normal(float x, float *density)
{
    const float far = 5.4F;
    *density = 0x1.988454p-2F * real_exp(-0.5F * x * x);
    float near = x < far ? x : far;
    near = near > -far ? near : -far;
    float z = near * near;
    float p = -0x1.7ddf0cp-34F;
    p = p * z + 0x1.edbfb8p-25F;
    p = p * z + 0x1.24faf4p-17F;
    p = p * z + 0x1.5cf1b4p-13F;
    p = p * z + 0x1.3a9b66p-8F;
    p = p * z + 0x1.076c18p-5F;
    p = p * z + 0x1.988454p-2F;
    float q = 0x1.1cd198p-19F;
    q = q * z + 0x1.57738ap-14F;
    q = q * z + 0x1.f73b6p-10F;
    q = q * z + 0x1.cebf48p-6F;
    q = q * z + 0x1.fa68eap-3F;
    q = q * z + 1.0F;
    return x > -far ? 0.5F + near * p / q : 0.0F;
}

#endif

/// GELU(x) = x P(X < x) for a standard normal X (Hendrycks and Gimpel 2016), the exact one.
static inline real real_gelu(real x)
{
    real density;
    return x * real_normal(x, &density);
}
