#include "batten/base.h"

#include <math.h>

static const double TWO_PI = 6.283185307179586476925286766559;

static uint64_t rotate_left(uint64_t x, int k)
{
    return (x << k) | (x >> (64 - k));
}

bat_random bat_random_seed(uint64_t seed)
{
    bat_random random;
    for (int i = 0; i < 4; i++)
    {
        // splitmix64 (Steele, Lea, Flood 2014)
        seed += 0x9e3779b97f4a7c15u;
        uint64_t z = seed;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        random.state[i] = z ^ (z >> 31);
    }
    return random;
}

uint64_t bat_random_bits(bat_random *random)
{
    uint64_t *s = random->state;
    uint64_t result = rotate_left(s[0] + s[3], 23) + s[0];
    uint64_t t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotate_left(s[3], 45);
    return result;
}

double bat_random_uniform(bat_random *random)
{
    return (double)(bat_random_bits(random) >> 11) * 0x1p-53;
}

double bat_random_normal(bat_random *random)
{
    // Box and Muller; 1 - u lies in (0, 1], so the logarithm is finite. The second number is not kept: no hidden state.
    double u = 1.0 - bat_random_uniform(random);
    double v = bat_random_uniform(random);
    return sqrt(-2.0 * log(u)) * cos(TWO_PI * v);
}
