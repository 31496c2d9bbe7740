#pragma once

#include "batten/base.h"

/// @file
/// Hash tables: from 64-bit keys to 32-bit numbers, and of points.

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

/// The address of a key's value, valid until the next call; UINT32_MAX is a new key's value. Null when out of memory.
uint32_t *key_map_at(key_map *map, uint64_t key);
/// The value of a key, or UINT32_MAX for an unknown key.
uint32_t key_map_find(const key_map *map, uint64_t key);
void key_map_free(key_map *map);

/// The key of an unordered pair.
static inline uint64_t key_of_pair(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

// Search for equal and near points.

/// A hash table of point indices, by coordinates or by the cell of a cubic grid. All zero but `points`, `cell`: empty.
typedef struct point_table
{
    const double *points; ///< rows of 3 finite coordinates; the array may move while points are added
    double cell;          ///< the side of a grid cell; 0: points are found by their coordinates
    uint32_t *slots;      ///< point indices; BAT_MESH_NONE marks an empty slot
    size_t slot_count;    ///< the number of slots: a power of two
    size_t count;
} point_table;

/// Reserve slots for `count` points.
/// @return false when out of memory, here and below
bool point_table_reserve(point_table *table, size_t count);
void point_table_free(point_table *table);

/// Add the point with this index in `points`.
bool point_table_add(point_table *table, uint32_t index);

/// The index of a point with the same coordinates, for a table without a grid; BAT_MESH_NONE for none.
uint32_t point_table_find(const point_table *table, const double point[3]);

/// The smallest index of a point within the distance `cell`, for a table with a grid; BAT_MESH_NONE for none.
uint32_t point_table_near(const point_table *table, const double point[3]);
