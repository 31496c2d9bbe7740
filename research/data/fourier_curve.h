#ifndef RESEARCH_DATA_FOURIER_CURVE_H
#define RESEARCH_DATA_FOURIER_CURVE_H

#include "research/data/wave.h"

/// @file
/// Random closed curves of the plane that other spaces use, too.

/// Move plane points to mean 0 and scale them to largest distance `radius` from there.
void centre_and_scale(size_t count, double radius, double *points);

/// Both coordinates are sums of `terms` harmonics with normal coefficients of deviation k^-decay; centred, with largest
/// radius `radius`.
void fourier_curve(bat_random *random, int terms, double decay, double radius, size_t count, double *points);

/// A positive function 1 + sum of harmonics, of mean 1, between 0.4 and 1.6: the radius of a star-shaped curve.
harmonics draw_lobes(bat_random *random);

/// The curve exp(it) + share exp(i frequency t): an epitrochoid (frequency > 0) or hypotrochoid.
typedef struct trochoid
{
    int frequency;
    double share;
} trochoid;

/// With frequency 2 or -2 it may have loops; with 3 or -3 it has none.
trochoid trochoid_draw(bat_random *random);

/// An ellipse about (x, y) with half axes a and b, turned by `angle`.
void ellipse_curve(double x, double y, double a, double b, double angle, size_t count, double *points);

#endif
