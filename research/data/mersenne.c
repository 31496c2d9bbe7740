#include "research/data/mersenne.h"

#include <math.h>

enum
{
    MIDDLE = 397 ///< the recurrence's second word
};

mersenne mersenne_seed(uint32_t seed)
{
    mersenne stream = {.next = MERSENNE_WORDS};
    stream.words[0] = seed;
    for (uint32_t i = 1; i < MERSENNE_WORDS; i++)
    {
        uint32_t last = stream.words[i - 1];
        stream.words[i] = 1812433253u * (last ^ (last >> 30)) + i;
    }
    return stream;
}

static void twist(mersenne *stream)
{
    uint32_t *words = stream->words;
    for (size_t i = 0; i < MERSENNE_WORDS; i++)
    {
        uint32_t mixed = (words[i] & 0x80000000u) | (words[(i + 1) % MERSENNE_WORDS] & 0x7fffffffu);
        words[i] = words[(i + MIDDLE) % MERSENNE_WORDS] ^ (mixed >> 1) ^ ((mixed & 1) ? 0x9908b0dfu : 0);
    }
    stream->next = 0;
}

uint32_t mersenne_bits(mersenne *stream)
{
    if (stream->next == MERSENNE_WORDS)
        twist(stream);
    uint32_t y = stream->words[stream->next++];
    y ^= y >> 11;
    y ^= (y << 7) & 0x9d2c5680u;
    y ^= (y << 15) & 0xefc60000u;
    return y ^ (y >> 18);
}

double mersenne_uniform(mersenne *stream)
{
    uint32_t high = mersenne_bits(stream) >> 5;
    uint32_t low = mersenne_bits(stream) >> 6;
    return ((double)high * 0x1p26 + (double)low) * 0x1p-53;
}

double mersenne_normal(mersenne *stream)
{
    if (stream->has_spare)
    {
        stream->has_spare = false;
        return stream->spare;
    }
    double x, y, squared;
    do
    {
        x = 2.0 * mersenne_uniform(stream) - 1.0;
        y = 2.0 * mersenne_uniform(stream) - 1.0;
        squared = x * x + y * y;
    } while (squared >= 1.0 || squared == 0.0);
    double factor = sqrt(-2.0 * log(squared) / squared);
    stream->spare = factor * x;
    stream->has_spare = true;
    return factor * y;
}

uint32_t mersenne_below(mersenne *stream, uint32_t bound)
{
    uint32_t largest = bound - 1;
    if (largest == 0)
        return 0;
    uint32_t mask = largest;
    for (int shift = 1; shift < 32; shift *= 2)
        mask |= mask >> shift;
    uint32_t value;
    do
        value = mersenne_bits(stream) & mask;
    while (value > largest);
    return value;
}

void mersenne_permutation(mersenne *stream, size_t *order, size_t count)
{
    for (size_t i = 0; i < count; i++)
        order[i] = i;
    for (size_t i = count; i-- > 1;)
    {
        size_t j = i == UINT32_MAX ? mersenne_bits(stream) : mersenne_below(stream, (uint32_t)(i + 1));
        size_t kept = order[i];
        order[i] = order[j];
        order[j] = kept;
    }
}
