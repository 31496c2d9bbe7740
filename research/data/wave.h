#ifndef RESEARCH_DATA_WAVE_H
#define RESEARCH_DATA_WAVE_H

#include "batten/base.h"

#include <math.h>

/// @file
/// Building blocks of random closed curves: uniform draws, cosines and sines by recurrence, short trigonometric sums, and
/// closed curves of the plane that are also used in other spaces.

#define WAVE_PI 3.14159265358979323846

/// A uniform number between low and high.
static inline double draw_between(bat_random *random, double low, double high)
{
    return low + (high - low) * bat_random_uniform(random);
}

/// A uniform integer from first to last.
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

/// The cosine and sine of frequency t + phase, at t = 0 and then at t = 2 pi n / count after n calls of wave_step(). The
/// error after n steps is about n 1e-16.
typedef struct wave
{
    double cosine, sine;
    double step_cosine, step_sine;
} wave;

/// Start a wave with `count` steps in a period of t.
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

/// The function h(t) = sum over k = 1 … count of cosine[k - 1] cos(k t) + sine[k - 1] sin(k t).
typedef struct harmonics
{
    int count;
    double cosine[HARMONICS_MAX], sine[HARMONICS_MAX];
} harmonics;

/// Draw both coefficients of term k from the normal distribution with standard deviation k^-decay.
harmonics harmonics_draw(bat_random *random, int count, double decay);

/// Draw terms c cos(k t + phase), with c normal of standard deviation k^-decay and a uniform phase.
harmonics harmonics_draw_phased(bat_random *random, int count, double decay);

/// Scale the terms so that the sum of their amplitudes is at most `bound`.
void harmonics_limit(harmonics *h, double bound);

/// The value at the parameter with the given cosine and sine.
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

/// Translate points of the plane to mean 0, and scale them to a maximum norm of `radius`.
void centre_and_scale(size_t count, double radius, double *points);

/// A Fourier curve: both coordinates are sums of `terms` harmonics with normal coefficients of standard deviation k^-decay;
/// then centre_and_scale().
void fourier_curve(bat_random *random, int terms, double decay, double radius, size_t count, double *points);

/// The harmonics of a radius function 1 + h(t) between 0.4 and 1.6, for a star-shaped curve.
harmonics draw_lobes(bat_random *random);

/// The curve exp(it) + share exp(i frequency t): an epitrochoid (frequency > 0) or hypotrochoid.
typedef struct trochoid
{
    int frequency;
    double share;
} trochoid;

/// Draw a trochoid. With frequency 2 or -2 it may have loops; with 3 or -3 it has none.
trochoid trochoid_draw(bat_random *random);

/// The ellipse with centre (x, y) and semi-axes a and b, rotated by `angle`.
void ellipse_curve(double x, double y, double a, double b, double angle, size_t count, double *points);

#endif
