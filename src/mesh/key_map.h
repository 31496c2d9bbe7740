#ifndef MESH_KEY_MAP_H
#define MESH_KEY_MAP_H

#include "batten/base.h"

/// @file
/// A hash table from 64-bit keys to 32-bit numbers.

/// A reserved value that marks empty slots; no key may be equal to it.
#define KEY_MAP_NO_KEY UINT64_MAX

/// The table; all zero is an empty one.
typedef struct key_map
{
    uint64_t *keys;
    uint32_t *values;
    size_t room; ///< the number of slots: a power of two
    size_t count;
} key_map;

/// The address of a key's value; a new key gets the value UINT32_MAX. Null when out of memory. The address is valid until
/// the next call.
uint32_t *key_map_at(key_map *map, uint64_t key);
/// The value of a key, or UINT32_MAX for an unknown key.
uint32_t key_map_find(const key_map *map, uint64_t key);
void key_map_free(key_map *map);

/// The key of an unordered pair.
static inline uint64_t key_of_pair(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

#endif
