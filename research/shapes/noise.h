#ifndef RESEARCH_SHAPES_NOISE_H
#define RESEARCH_SHAPES_NOISE_H

#include "batten/base.h"

/// @file
/// Smooth random functions of space.

/// Gradient noise (Perlin, "Improving Noise", 2002) with the gradients of a seed: zero at points of whole numbers, about -1
/// to 1, with two continuous derivatives and slopes up to about 2.
double noise_at(uint64_t seed, double x, double y, double z);

/// Several octaves of it: sum over k < octaves of amplitude gain^k noise(2^k frequency p).
typedef struct noise_sum
{
    uint64_t seed;
    double frequency; ///< of the first octave, per unit of length
    double amplitude; ///< of the first octave
    double gain;      ///< from one octave to the next
    int octaves;
    double ridge; ///< 0: as it is; above: octaves are folded, 1 - 2 |noise| smoothed over this height, which gives ridges
} noise_sum;

/// No value is farther from zero than this.
double noise_sum_reach(const noise_sum *noise);

double noise_sum_at(const noise_sum *noise, const double point[3]);

#endif
