#ifndef MESH_POINT_TABLE_H
#define MESH_POINT_TABLE_H

#include "batten/base.h"

/// Finds points by their three coordinates, or by the cubes of a grid that they lie in: a hash table of their indices. All
/// zero but `points` and `cell`: empty.
typedef struct point_table
{
    const double *points; ///< rows of 3, finite; may move while points are added
    double cell;          ///< the side of a cube of the grid; 0: by the coordinates themselves
    uint32_t *slots;      ///< indices of points, or BAT_MESH_NONE
    size_t slot_count;    ///< a power of two
    size_t count;
} point_table;

/// Make room for so many points beforehand.
/// @return false when out of memory, here and below
bool point_table_reserve(point_table *table, size_t count);
void point_table_free(point_table *table);

/// Add a point that is already in `points`.
bool point_table_add(point_table *table, uint32_t index);

/// The point with the same coordinates, for a table without a grid; BAT_MESH_NONE when there is none.
uint32_t point_table_find(const point_table *table, const double point[3]);

/// The least index of a point within the distance `cell`, for a table with a grid; BAT_MESH_NONE when there is none.
uint32_t point_table_near(const point_table *table, const double point[3]);

#endif
