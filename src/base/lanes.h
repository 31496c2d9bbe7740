#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/// @file
/// Elementary functions without branches or calls, so that a loop over arrays becomes vector code, and the attribute that
/// compiles such a loop once for each vector width. Errors are a few units in the last place. The coefficients come from
/// scripts/fit-polynomials.py.

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
/// One binary holds the function for AVX-512, AVX2 and plain x86-64; the dynamic linker picks.
#define LANES_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define LANES_CLONES
#endif

static const double LANES_HALF_PI = 1.57079632679489661923;
static const double LANES_PI = 3.14159265358979323846;
static const double LANES_TAN_PI_8 = 0.41421356237309504880;

/// copysign(magnitude, sign) for a magnitude of 0 or more. Compilers to WebAssembly make no vector code of copysign().
static inline double lane_copysign(double magnitude, double sign)
{
    uint64_t a, b;
    memcpy(&a, &magnitude, sizeof a);
    memcpy(&b, &sign, sizeof b);
    a |= b & UINT64_C(1) << 63;
    memcpy(&magnitude, &a, sizeof a);
    return magnitude;
}

/// (atan(r) / r - 1) / r^2 as a function of z = r^2, |r| <= tan(pi/8).
static inline double lane_atan_tail(double z)
{
    // In pairs (Estrin's scheme): the chain of dependent products is half as long as Horner's.
    double z2 = z * z, z4 = z2 * z2;
    double low = (0x1.999999999934cp-3 * z - 0x1.5555555555555p-2) + z2 * (0x1.c71c71853d7fap-4 * z - 0x1.2492492436201p-3);
    double middle =
        (0x1.3b1263064f6b9p-4 * z - 0x1.745d0b28a7e37p-4) + z2 * (0x1.dfe6497e96323p-5 * z - 0x1.10fa77b1a6d57p-4);
    double high = (0x1.4162c02b1dda3p-5 * z - 0x1.a0999c632b6edp-5) - z2 * 0x1.3a31b1c0fd3b7p-6;
    return low + z4 * (middle + z4 * high);
}

/// atan(sqrt(z)) / sqrt(z) for 0 <= z <= tan(pi/8)^2.
static inline double lane_atan_over_root(double z)
{
    return 1 + z * lane_atan_tail(z);
}

/// atan2(y, x), and 0 at the origin.
static inline double lane_atan2(double y, double x)
{
    double ay = fabs(y), ax = fabs(x);
    double low = ay < ax ? ay : ax, high = ay < ax ? ax : ay;
    // atan(low / high) lies in [0, pi/4]; above pi/8 it is pi/4 less the angle of (high - low, high + low).
    bool upper = low > LANES_TAN_PI_8 * high;
    double numerator = upper ? low - high : low;
    double denominator = upper ? low + high : high;
    denominator = denominator > 0 ? denominator : 1;
    double r = numerator / denominator;
    double z = r * r;
    double angle = r + r * (z * lane_atan_tail(z));
    angle = upper ? 0.5 * LANES_HALF_PI + angle : angle;
    angle = ay < ax ? angle : LANES_HALF_PI - angle;
    angle = high > 0 ? angle : 0;
    angle = x < 0 ? LANES_PI - angle : angle;
    return lane_copysign(angle, y);
}

/// tan(x) for |x| <= pi/4.
static inline double lane_tan(double x)
{
    const double squared_half_pi = 0x1.3bd3cc9be45dep+1;
    double z = x * x;
    double z2 = z * z;
    double low = (squared_half_pi - 0x1.6b96676b3e154p-3 * z) - z2 * (0x1.68b80174a21cfp-13 * z + 0x1.1cda811844c12p-8);
    double high =
        (-0x1.63ecaf96e6ce6p-22 * z - 0x1.f438abc49aeb0p-18) - z2 * (0x1.9af1808dc3037p-31 * z + 0x1.fbcc415f7cd4cp-27);
    double p = low + z2 * z2 * high;
    return x * (p / (squared_half_pi - z));
}

/// cos(sqrt(s)) for 0 <= s <= pi^2, to 1e-15.
static inline double lane_cos_root(double s)
{
    double p = 0x1.c3d6c072b667bp-80;
    p = p * s - 0x1.0b9ba160f0376p-70;
    p = p * s + 0x1.e52dba7f18b95p-62;
    p = p * s - 0x1.682716e1bbfb2p-53;
    p = p * s + 0x1.ae7f3b54f4a5ap-45;
    p = p * s - 0x1.93974a7caca9ap-37;
    p = p * s + 0x1.1eed8eff59c41p-29;
    p = p * s - 0x1.27e4fb77890bdp-22;
    p = p * s + 0x1.a01a01a019fc5p-16;
    p = p * s - 0x1.6c16c16c16c16p-10;
    p = p * s + 0x1.5555555555555p-5;
    p = p * s - 0.5;
    return p * s + 1;
}

/// sin(sqrt(s)) / sqrt(s) for 0 <= s <= pi^2, to 1e-15; 1 at 0.
static inline double lane_sinc_root(double s)
{
    double p = 0x1.2350491810873p-84;
    p = p * s - 0x1.7494e00549c04p-75;
    p = p * s + 0x1.71ac6e34ac75ap-66;
    p = p * s - 0x1.2f49721385a06p-57;
    p = p * s + 0x1.952c75276b3b4p-49;
    p = p * s - 0x1.ae7f3e6a14f36p-41;
    p = p * s + 0x1.6124613a67f61p-33;
    p = p * s - 0x1.ae64567f53c2dp-26;
    p = p * s + 0x1.71de3a556c71ap-19;
    p = p * s - 0x1.a01a01a01a01ap-13;
    p = p * s + 0x1.1111111111111p-7;
    p = p * s - 0x1.5555555555555p-3;
    return p * s + 1;
}
