#ifndef MESH_POINT_TABLE_H
#define MESH_POINT_TABLE_H

#include "batten/base.h"

/// @file
/// Search for equal and near points.

/// A hash table of point indices. It finds points by their coordinates or by the cell of a cubic grid. All zero except for
/// `points` and `cell`: empty.
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

#endif
