#ifndef RESEARCH_DATA_MERSENNE_H
#define RESEARCH_DATA_MERSENNE_H

#include "batten/base.h"

/// @file
/// The random stream of NumPy's legacy `RandomState`, number for number, to regenerate data that others drew from it. For
/// anything new use bat_random.

enum
{
    MERSENNE_WORDS = 624
};

/// The Mersenne twister MT19937 (Matsumoto and Nishimura 1998) with the spare number of the polar method.
typedef struct mersenne
{
    uint32_t words[MERSENNE_WORDS];
    size_t next;  ///< the word that is drawn next; MERSENNE_WORDS when they are used up
    double spare; ///< the second normal number of a pair, when has_spare
    bool has_spare;
} mersenne;

/// `RandomState(seed)`.
mersenne mersenne_seed(uint32_t seed);
/// The next 32 random bits.
uint32_t mersenne_bits(mersenne *stream);
/// `rand()`: uniform on [0, 1), a multiple of 2^-53.
double mersenne_uniform(mersenne *stream);
/// `randn()`: standard normal, by Marsaglia's polar method.
double mersenne_normal(mersenne *stream);
/// `randint(0, bound)`: uniform on 0 … bound - 1, bound >= 1; the index that `choice` takes from a list of `bound` values.
uint32_t mersenne_below(mersenne *stream, uint32_t bound);
/// `permutation(count)` for count <= 2^32.
void mersenne_permutation(mersenne *stream, size_t *order, size_t count);

#endif
