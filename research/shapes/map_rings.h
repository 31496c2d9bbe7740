#ifndef RESEARCH_SHAPES_MAP_RINGS_H
#define RESEARCH_SHAPES_MAP_RINGS_H

#include "research/shapes/map_land.h"

/// @file
/// The rings of a generated map. Neighbours share the vertices of their border.
///
/// A border between two cells runs from the centroid of a triangle over a point of the edge between the two sites to the
/// centroid of the next triangle. Each half has a quadrilateral of its own and is displaced within that alone. The
/// quadrilaterals of all borders are disjoint, so that borders cannot cross.

/// The units of a degree: coordinates are whole numbers of them.
#define MAP_UNITS 1000000
enum
{
    MAP_DECIMALS = 6
};

/// Indices of vertices; the first one is not repeated.
typedef struct map_ring
{
    uint32_t *vertices;
    size_t count, capacity;
} map_ring;

/// An outer ring, counter-clockwise, and holes, clockwise.
typedef struct map_polygon
{
    map_ring *rings;
    size_t count, capacity;
    bool pole; ///< the outer ring goes around the axis of the Earth
} map_polygon;

typedef struct map_area
{
    map_kind kind;
    map_polygon *polygons;
    size_t count, capacity;
} map_area;

typedef struct map_vertex
{
    int64_t longitude, latitude; ///< in units; the longitude is above -180 and up to 180 degrees
} map_vertex;

typedef struct map_rings
{
    map_vertex *vertices;
    size_t vertex_count, vertex_capacity;
    map_area *areas; ///< one for each feature
    size_t area_count, area_capacity;
    bool failed; ///< out of memory
} map_rings;

/// Trace the features of a map. A border between two cells has 2^detail edges; `detail` is 1 to 10. False when out of
/// memory.
bool map_rings_make(const map_grid *grid, const map_land *land, size_t detail, uint64_t seed, map_rings *map);

/// Cut countries in two along meridians, which have no vertices between the ends, or parallels, `count` times. False when
/// out of memory.
bool map_rings_split(map_rings *map, size_t count, bat_random *random);

void map_rings_free(map_rings *map);

// What the two stages share.

/// Append a vertex, or an index to a ring; they set `failed`.
uint32_t map_vertex_add(map_rings *map, double longitude, double latitude);
void map_ring_add(map_rings *map, map_ring *ring, uint32_t vertex);
/// Append a polygon of one ring to an area. The polygon takes the ring. Null when out of memory.
map_polygon *map_polygon_add(map_rings *map, map_area *area, map_ring *ring);
/// Append a hole. The polygon takes the ring.
void map_hole_add(map_rings *map, map_polygon *polygon, map_ring *ring);
map_area *map_area_add(map_rings *map, map_kind kind);

/// The difference of longitudes in units that is nearest to 0.
int64_t map_step(int64_t units);
/// Whether a vertex lies inside a ring that does not go around the axis.
bool map_ring_holds(const map_rings *map, const map_ring *ring, map_vertex vertex);

#endif
