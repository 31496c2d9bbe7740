#ifndef MESH_KEY_MAP_H
#define MESH_KEY_MAP_H

#include "batten/base.h"

/// @file
/// A table from 64-bit keys to 32-bit numbers, by open addressing.

/// No key may be this one.
#define KEY_MAP_NO_KEY UINT64_MAX

/// All zero: empty.
typedef struct key_map
{
    uint64_t *keys;
    uint32_t *values;
    size_t room; ///< a power of two
    size_t count;
} key_map;

/// The place of a key's value; a new key is entered with the value UINT32_MAX. Null when out of memory. The place holds
/// until the next call.
uint32_t *key_map_at(key_map *map, uint64_t key);
/// The value of a key, or UINT32_MAX.
uint32_t key_map_find(const key_map *map, uint64_t key);
void key_map_free(key_map *map);

/// The key of a pair in either order.
static inline uint64_t key_of_pair(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

#endif
