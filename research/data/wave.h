#ifndef RESEARCH_DATA_WAVE_H
#define RESEARCH_DATA_WAVE_H

#include "batten/base.h"

#include <math.h>

/// @file
/// Uniform draws, cosines and sines at evenly spaced parameters, and short trigonometric sums: what random closed curves are
/// made of.

#define WAVE_PI 3.14159265358979323846

/// low … high, uniform.
static inline double draw_between(bat_random *random, double low, double high)
{
    return low + (high - low) * bat_random_uniform(random);
}

/// One of the whole numbers first … last.
static inline int draw_whole(bat_random *random, int first, int last)
{
    return first + (int)((last - first + 1) * bat_random_uniform(random));
}

static inline double draw_angle(bat_random *random)
{
    return draw_between(random, 0, 2 * WAVE_PI);
}

static inline bool draw_coin(bat_random *random)
{
    return bat_random_uniform(random) < 0.5;
}

/// The cosine and sine of frequency t + phase at t = 0, then one step further at every wave_step(). After n steps they are
/// off by about n 1e-16.
typedef struct wave
{
    double cosine, sine;
    double step_cosine, step_sine;
} wave;

/// `count` steps go once round.
static inline wave wave_make(double frequency, double phase, size_t count)
{
    double step = frequency * (2 * WAVE_PI) / (double)count;
    return (wave){cos(phase), sin(phase), cos(step), sin(step)};
}

static inline void wave_step(wave *w)
{
    double cosine = w->cosine * w->step_cosine - w->sine * w->step_sine;
    w->sine = w->sine * w->step_cosine + w->cosine * w->step_sine;
    w->cosine = cosine;
}

enum
{
    HARMONICS_MAX = 6
};

/// The function sum over k = 1 … count of cosine[k - 1] cos(k t) + sine[k - 1] sin(k t).
typedef struct harmonics
{
    int count;
    double cosine[HARMONICS_MAX], sine[HARMONICS_MAX];
} harmonics;

/// Both coefficients of term k normal, of deviation k^-decay.
harmonics harmonics_draw(bat_random *random, int count, double decay);

/// Term k is c cos(k t + phase) with c normal of deviation k^-decay and the phase uniform.
harmonics harmonics_draw_phased(bat_random *random, int count, double decay);

/// Scale the terms so that their amplitudes add up to `bound` where they exceed it.
void harmonics_limit(harmonics *h, double bound);

/// The value at the parameter whose cosine and sine are given.
static inline double harmonics_at(const harmonics *h, double cosine, double sine)
{
    double c = cosine, s = sine, sum = 0;
    for (int k = 0; k < h->count; k++)
    {
        sum += h->cosine[k] * c + h->sine[k] * s;
        double next = c * cosine - s * sine;
        s = s * cosine + c * sine;
        c = next;
    }
    return sum;
}

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
