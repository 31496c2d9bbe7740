#include "research/shapes/noise.h"

#include <math.h>

static uint64_t mix(uint64_t z)
{
    // the finalizer of splitmix64 (Steele, Lea, Flood 2014)
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// The scalar product of an offset with the gradient of a point of whole numbers.
static double pull(uint64_t seed, int64_t i, int64_t j, int64_t k, double x, double y, double z)
{
    static const double GRADIENTS[16][3] = {{1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
                                            {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1},
                                            {1, 1, 0},  {-1, 1, 0},  {0, -1, 1}, {0, -1, -1}};
    uint64_t place =
        (uint64_t)i * 0x9e3779b97f4a7c15u + (uint64_t)j * 0xc2b2ae3d27d4eb4fu + (uint64_t)k * 0x165667b19e3779f9u;
    const double *g = GRADIENTS[mix(seed + place) >> 60];
    return g[0] * x + g[1] * y + g[2] * z;
}

static double fade(double t)
{
    return t * t * t * (t * (6 * t - 15) + 10);
}

static double blend(double a, double b, double share)
{
    return a + share * (b - a);
}

double noise_at(uint64_t seed, double x, double y, double z)
{
    double fx = floor(x), fy = floor(y), fz = floor(z);
    int64_t i = (int64_t)fx, j = (int64_t)fy, k = (int64_t)fz;
    x -= fx;
    y -= fy;
    z -= fz;
    double u = fade(x), v = fade(y), w = fade(z), levels[2];
    for (int up = 0; up < 2; up++)
    {
        double low = blend(pull(seed, i, j, k + up, x, y, z - up), pull(seed, i + 1, j, k + up, x - 1, y, z - up), u);
        double high =
            blend(pull(seed, i, j + 1, k + up, x, y - 1, z - up), pull(seed, i + 1, j + 1, k + up, x - 1, y - 1, z - up), u);
        levels[up] = blend(low, high, v);
    }
    return blend(levels[0], levels[1], w);
}

double noise_sum_at(const noise_sum *noise, const double point[3])
{
    double sum = 0, amplitude = noise->amplitude, frequency = noise->frequency;
    for (int octave = 0; octave < noise->octaves; octave++)
    {
        double value =
            noise_at(noise->seed + (uint64_t)octave, frequency * point[0], frequency * point[1], frequency * point[2]);
        if (noise->ridge > 0)
            value = 1 - 2 * sqrt(value * value + noise->ridge * noise->ridge);
        sum += amplitude * value;
        amplitude *= noise->gain;
        frequency *= 2;
    }
    return sum;
}

double noise_sum_reach(const noise_sum *noise)
{
    double sum = 0, amplitude = fabs(noise->amplitude);
    for (int octave = 0; octave < noise->octaves; octave++)
    {
        // Gradient noise stays within 1.04; folded, it is 1 at most and -1.2 at least.
        sum += 1.2 * amplitude;
        amplitude *= noise->gain;
    }
    return sum;
}
