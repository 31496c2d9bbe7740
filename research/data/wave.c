/// @file
/// Trigonometric sums and random closed curves; see wave.h.

#include "research/data/wave.h"

#include <stdlib.h>

harmonics harmonics_draw(bat_random *random, int count, double decay)
{
    harmonics h = {.count = count};
    for (int k = 0; k < count; k++)
    {
        double deviation = pow(k + 1, -decay);
        h.cosine[k] = deviation * bat_random_normal(random);
        h.sine[k] = deviation * bat_random_normal(random);
    }
    return h;
}

harmonics harmonics_draw_phased(bat_random *random, int count, double decay)
{
    harmonics h = {.count = count};
    for (int k = 0; k < count; k++)
    {
        double amplitude = pow(k + 1, -decay) * bat_random_normal(random), phase = draw_angle(random);
        h.cosine[k] = amplitude * cos(phase);
        h.sine[k] = -amplitude * sin(phase);
    }
    return h;
}

void harmonics_limit(harmonics *h, double bound)
{
    double sum = 0;
    for (int k = 0; k < h->count; k++)
        sum += hypot(h->cosine[k], h->sine[k]);
    double scale = sum > bound ? bound / sum : 1;
    for (int k = 0; k < h->count; k++)
    {
        h->cosine[k] *= scale;
        h->sine[k] *= scale;
    }
}

void centre_and_scale(size_t count, double radius, double *points)
{
    double sum_x = 0, sum_y = 0, squared = 0;
    for (size_t i = 0; i < count; i++)
    {
        sum_x += points[2 * i];
        sum_y += points[2 * i + 1];
    }
    double mean_x = sum_x / (double)count, mean_y = sum_y / (double)count;
    for (size_t i = 0; i < count; i++)
    {
        double x = points[2 * i] -= mean_x;
        double y = points[2 * i + 1] -= mean_y;
        squared = fmax(squared, x * x + y * y);
    }
    double scale = radius / sqrt(squared);
    for (size_t i = 0; i < 2 * count; i++)
        points[i] *= scale;
}

void fourier_curve(bat_random *random, int terms, double decay, double radius, size_t count, double *points)
{
    harmonics x = harmonics_draw(random, terms, decay), y = harmonics_draw(random, terms, decay);
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
    {
        points[2 * i] = harmonics_at(&x, t.cosine, t.sine);
        points[2 * i + 1] = harmonics_at(&y, t.cosine, t.sine);
    }
    centre_and_scale(count, radius, points);
}

harmonics draw_lobes(bat_random *random)
{
    double strength = draw_between(random, 0.2, 1);
    harmonics h = harmonics_draw(random, draw_whole(random, 3, 5), 1.5);
    h.cosine[0] = h.sine[0] = 0; // approximately a translation
    for (int k = 1; k < h.count; k++)
    {
        h.cosine[k] *= strength;
        h.sine[k] *= strength;
    }
    harmonics_limit(&h, 0.6);
    return h;
}

trochoid trochoid_draw(bat_random *random)
{
    static const int FREQUENCIES[] = {-3, -2, 2, 3};
    int frequency = FREQUENCIES[draw_whole(random, 0, 3)];
    return (trochoid){frequency, draw_between(random, 0.15, abs(frequency) == 3 ? 0.3 : 0.7)};
}

void ellipse_curve(double x, double y, double a, double b, double angle, size_t count, double *points)
{
    double cosine = cos(angle), sine = sin(angle);
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
    {
        double u = a * t.cosine, v = b * t.sine;
        points[2 * i] = x + cosine * u - sine * v;
        points[2 * i + 1] = y + sine * u + cosine * v;
    }
}
