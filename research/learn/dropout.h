#ifndef RESEARCH_LEARN_DROPOUT_H
#define RESEARCH_LEARN_DROPOUT_H

#include "research/learn/tape.h"

/// @file
/// The mask of a dropout. It is a function of a key and the number's position: the backward pass computes it again instead
/// of storing it, and it does not depend on the order of execution.

typedef struct dropout_mask
{
    uint32_t key[2];
    uint32_t threshold; ///< drop below; 0: nothing is dropped
    real scale;         ///< the factor of the others
} dropout_mask;

/// 64 pseudo-random bits of a key and a counter.
static inline uint64_t dropout_mix(uint64_t key, uint64_t count)
{
    // splitmix64 (Steele, Lea and Flood 2014)
    uint64_t z = key + 0x9e3779b97f4a7c15u * (count + 1);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// The mask of the tape's next dropout, 0 <= rate < 1.
static inline dropout_mask dropout_next(learn_tape *tape, double rate)
{
    if (!tape->drops || rate <= 0)
        return (dropout_mask){.threshold = 0, .scale = 1};
    uint64_t key = dropout_mix(tape->dropout_key, tape->dropout_uses++);
    return (dropout_mask){.key = {(uint32_t)key, (uint32_t)(key >> 32)},
                          .threshold = (uint32_t)(rate * 4294967296.0),
                          .scale = (real)(1 / (1 - rate))};
}

/// The factor of number `place`: 0 or mask.scale.
static inline real dropout_factor(dropout_mask mask, uint32_t place)
{
    uint32_t h = place ^ mask.key[0];
    h ^= h >> 16;
    h *= 0x7feb352du;
    h = (h ^ (h >> 15)) + mask.key[1];
    h *= 0x846ca68bu;
    h ^= h >> 16;
    return h < mask.threshold ? 0 : mask.scale;
}

#endif
