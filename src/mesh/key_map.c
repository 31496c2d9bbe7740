#include "mesh/key_map.h"

#include "base/memory.h"

#include <stdlib.h>

/// @file
/// Open addressing with linear probing; at most half of the slots are used.

#define FIRST_ROOM ((size_t)1 << 12)

static size_t slot_of(const key_map *map, uint64_t key)
{
    // The finalizer of splitmix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
    uint64_t z = key;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    size_t slot = (size_t)(z ^ (z >> 31)) & (map->room - 1);
    while (map->keys[slot] != key && map->keys[slot] != KEY_MAP_NO_KEY)
        slot = (slot + 1) & (map->room - 1);
    return slot;
}

/// Double the number of slots. False when out of memory.
static bool grow(key_map *map)
{
    key_map larger = {.room = map->room == 0 ? FIRST_ROOM : 2 * map->room, .count = map->count};
    larger.keys = memory_array(larger.room, sizeof *larger.keys);
    larger.values = memory_array(larger.room, sizeof *larger.values);
    if (larger.keys == NULL || larger.values == NULL)
    {
        key_map_free(&larger);
        return false;
    }
    for (size_t i = 0; i < larger.room; i++)
        larger.keys[i] = KEY_MAP_NO_KEY;
    for (size_t i = 0; i < map->room; i++)
    {
        if (map->keys[i] == KEY_MAP_NO_KEY)
            continue;
        size_t slot = slot_of(&larger, map->keys[i]);
        larger.keys[slot] = map->keys[i];
        larger.values[slot] = map->values[i];
    }
    key_map smaller = *map;
    *map = larger;
    key_map_free(&smaller);
    return true;
}

uint32_t *key_map_at(key_map *map, uint64_t key)
{
    if (2 * (map->count + 1) > map->room && !grow(map))
        return NULL;
    size_t slot = slot_of(map, key);
    if (map->keys[slot] == KEY_MAP_NO_KEY)
    {
        map->keys[slot] = key;
        map->values[slot] = UINT32_MAX;
        map->count++;
    }
    return &map->values[slot];
}

uint32_t key_map_find(const key_map *map, uint64_t key)
{
    if (map->room == 0)
        return UINT32_MAX;
    size_t slot = slot_of(map, key);
    return map->keys[slot] == key ? map->values[slot] : UINT32_MAX;
}

void key_map_free(key_map *map)
{
    free(map->keys);
    free(map->values);
    *map = (key_map){0};
}
