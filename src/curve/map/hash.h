#ifndef CURVE_MAP_HASH_H
#define CURVE_MAP_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/// @file
/// Hashes of numbers and points, for tables whose order never reaches a result.

static inline size_t hash_mix(size_t hash, uint64_t value)
{
    uint64_t mixed = ((uint64_t)hash ^ value) * UINT64_C(0x9e3779b97f4a7c15);
    return (size_t)(mixed ^ (mixed >> 29));
}

/// The hash of `count` doubles; 0 and -0 are the same.
static inline size_t doubles_hash(const double *values, size_t count)
{
    size_t hash = count;
    for (size_t i = 0; i < count; i++)
    {
        double value = values[i] + 0.0;
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = hash_mix(hash, bits);
    }
    return hash;
}

#endif
