#include "mesh/hash_table.h"

#include "base/memory.h"
#include "batten/mesh.h"

#include <math.h>
#include <string.h>

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

// A hash table with linear probing. Its keys are the coordinates themselves or floor(coordinate / cell).

/// The key of a point: its coordinates, with -0 replaced by 0, or the indices of its grid cell.
typedef struct point_key
{
    double at[3];
} point_key;

static point_key key_of(const point_table *table, const double point[3])
{
    point_key key;
    for (int k = 0; k < 3; k++)
        key.at[k] = (table->cell > 0 ? floor(point[k] / table->cell) : point[k]) + 0.0;
    return key;
}

/// The slot where a search for the key begins. The bits are mixed by the finalizer of MurmurHash3.
static size_t first_slot(const point_table *table, const point_key *key)
{
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++)
    {
        uint64_t bits;
        memcpy(&bits, &key->at[k], sizeof bits);
        hash = (hash ^ bits) * UINT64_C(0xff51afd7ed558ccd);
        hash ^= hash >> 33;
    }
    hash *= UINT64_C(0xc4ceb9fe1a85ec53);
    return (size_t)(hash ^ hash >> 33) & (table->slot_count - 1);
}

static void put(point_table *table, uint32_t index)
{
    point_key key = key_of(table, table->points + 3 * (size_t)index);
    size_t slot = first_slot(table, &key);
    while (table->slots[slot] != BAT_MESH_NONE)
        slot = (slot + 1) & (table->slot_count - 1);
    table->slots[slot] = index;
}

bool point_table_reserve(point_table *table, size_t count)
{
    static const int FIRST_SLOTS = 64;
    size_t wanted = table->slot_count > 0 ? table->slot_count : FIRST_SLOTS;
    while (wanted / 2 < count)
    {
        if (wanted > SIZE_MAX / 2)
            return false;
        wanted *= 2;
    }
    if (wanted == table->slot_count)
        return true;
    uint32_t *old = table->slots, *slots = memory_array(wanted, sizeof *slots);
    size_t old_count = table->slot_count;
    if (slots == NULL)
        return false;
    memset(slots, 0xff, wanted * sizeof *slots);
    table->slots = slots;
    table->slot_count = wanted;
    for (size_t i = 0; i < old_count; i++)
        if (old[i] != BAT_MESH_NONE)
            put(table, old[i]);
    free(old);
    return true;
}

void point_table_free(point_table *table)
{
    free(table->slots);
    *table = (point_table){0};
}

bool point_table_add(point_table *table, uint32_t index)
{
    if (!point_table_reserve(table, table->count + 1))
        return false;
    put(table, index);
    table->count++;
    return true;
}

uint32_t point_table_find(const point_table *table, const double point[3])
{
    if (table->slot_count == 0)
        return BAT_MESH_NONE;
    point_key key = key_of(table, point);
    for (size_t slot = first_slot(table, &key);; slot = (slot + 1) & (table->slot_count - 1))
    {
        uint32_t index = table->slots[slot];
        if (index == BAT_MESH_NONE)
            return index;
        const double *other = table->points + 3 * (size_t)index;
        if (other[0] == point[0] && other[1] == point[1] && other[2] == point[2])
            return index;
    }
}

/// The smallest index below `best` of a point in one cell within the distance `cell` of `point`.
static uint32_t near_in_cube(const point_table *table, const point_key *cube, const double point[3], uint32_t best)
{
    for (size_t slot = first_slot(table, cube); table->slots[slot] != BAT_MESH_NONE;
         slot = (slot + 1) & (table->slot_count - 1))
    {
        uint32_t index = table->slots[slot];
        if (index >= best)
            continue;
        const double *other = table->points + 3 * (size_t)index;
        point_key key = key_of(table, other);
        double distance = hypot(hypot(other[0] - point[0], other[1] - point[1]), other[2] - point[2]);
        bool inside = key.at[0] == cube->at[0] && key.at[1] == cube->at[1] && key.at[2] == cube->at[2];
        if (inside && distance <= table->cell)
            best = index;
    }
    return best;
}

uint32_t point_table_near(const point_table *table, const double point[3])
{
    static const int CUBES = 27;
    uint32_t best = BAT_MESH_NONE;
    if (table->slot_count == 0)
        return best;
    point_key middle = key_of(table, point);
    for (int i = 0; i < CUBES; i++)
    {
        const int steps[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
        point_key cube;
        for (int k = 0; k < 3; k++)
            cube.at[k] = middle.at[k] + steps[k] + 0.0;
        best = near_in_cube(table, &cube, point, best);
    }
    return best;
}
