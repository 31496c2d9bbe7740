#ifndef IO_CURVE_GLOBE_POLYGON_H
#define IO_CURVE_GLOBE_POLYGON_H

#include "io/curve/antimeridian.h"

/// Polygons of longitude and latitude, each an outer ring and its holes.
typedef struct globe_polygons
{
    globe_lines rings;   ///< of all polygons, one after the other; the first position of a ring is not repeated
    size_t *ring_counts; ///< of each polygon
    size_t count, capacity;
} globe_polygons;

/// Add the parts of a polygon some of whose rings cross the meridian of 180 degrees: no part crosses it, and the borders of
/// the parts run along it.
///
/// A ring that goes once around the axis encloses a pole: the one on the side with the smaller area (with equal areas, the
/// one on its left). Such a polygon is closed along the meridian, over the pole. Two such rings, one of them a hole, bound a
/// belt.
///
/// @param rings the outer ring and the holes, shown on the grid
/// @return false when out of memory
bool globe_polygon_cut(const degree_grid *grid, const globe_curve *rings, size_t ring_count, globe_polygons *parts);

void globe_polygons_free(globe_polygons *polygons);

#endif
