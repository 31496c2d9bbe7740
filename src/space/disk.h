#ifndef SPACE_DISK_H
#define SPACE_DISK_H

#include <math.h>

/// 1 - |z|^2 with one rounding of the order of the result, however close to the rim.
static inline double disk_complement(const double *z)
{
    // The squares as unevaluated sums: xx + x_low and yy + y_low are exact.
    double xx = z[0] * z[0], yy = z[1] * z[1];
    double x_low = fma(z[0], z[0], -xx), y_low = fma(z[1], z[1], -yy);
    double larger = xx > yy ? xx : yy, smaller = xx > yy ? yy : xx;
    return ((1 - larger) - smaller) - (x_low + y_low);
}

/// w = (-p) + q, the Möbius translation that takes p to the origin: (q - p) / D with D = 1 - conj(p) q, written as
/// (1 - |p|^2) - conj(p) (q - p) so that near points lose nothing. `denominator` receives D.
static inline void disk_centre(const double *p, const double *q, double *w, double *denominator)
{
    double x = q[0] - p[0], y = q[1] - p[1];
    double re = disk_complement(p) - (p[0] * x + p[1] * y);
    double im = -(p[0] * y - p[1] * x);
    double inverse = 1 / (re * re + im * im);
    w[0] = (x * re + y * im) * inverse;
    w[1] = (y * re - x * im) * inverse;
    denominator[0] = re;
    denominator[1] = im;
}

/// The Möbius sum p + z = (p + z) / (1 + conj(p) z), written as p + (1 - |p|^2) z / (1 + conj(p) z).
static inline void disk_translate(const double *p, const double *z, double *q)
{
    double re = 1 + (p[0] * z[0] + p[1] * z[1]);
    double im = p[0] * z[1] - p[1] * z[0];
    double scale = disk_complement(p) / (re * re + im * im);
    q[0] = p[0] + scale * (z[0] * re + z[1] * im);
    q[1] = p[1] + scale * (z[1] * re - z[0] * im);
}

#endif
