#pragma once

#include <stddef.h>
#include <stdint.h>

/// What hash_bytes() begins with.
#define HASH_BEGIN UINT64_C(0xcbf29ce484222325)

/// Go on with a hash over further bytes: FNV-1a, Fowler, Noll and Vo.
static inline uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ byte[i]) * UINT64_C(0x100000001b3);
    return hash;
}
