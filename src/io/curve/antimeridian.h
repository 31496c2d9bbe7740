#ifndef IO_CURVE_ANTIMERIDIAN_H
#define IO_CURVE_ANTIMERIDIAN_H

#include "base/array_grow.h"
#include "space/degrees.h"

/// @file
/// Curves and polygons on the sphere, cut at the antimeridian as RFC 7946, section 3.1.9, requires.
///
/// A vertex with a rounded longitude of 180 degrees lies on the antimeridian and takes the sign of the vertex before it. A
/// vertex that rounds to a pole takes the longitude of the vertex before it. At the start of an open curve both use the
/// vertex after it.

/// The integer grid of longitudes and latitudes.
typedef struct degree_grid
{
    int64_t half_turn;    ///< 180 degrees in units
    int64_t quarter_turn; ///< 90 degrees in units
    double units_per_radian;
} degree_grid;

degree_grid degree_grid_of(int decimals);

/// A curve to be written.
typedef struct globe_curve
{
    const double *points;    ///< count x 3
    const double *altitudes; ///< the altitude of the first point, or null
    size_t altitude_stride;  ///< the step from one point's altitude to the next, in doubles
    degree_units *shown;     ///< count: the rounded coordinates, set by globe_curve_show()
    size_t count;
    bool closed;
    size_t cut_count; ///< the number of edges that cross the antimeridian, set by globe_curve_show()
} globe_curve;

/// Round the coordinates of a curve and count its crossings of the antimeridian. False when a point is not finite.
bool globe_curve_show(const degree_grid *grid, globe_curve *curve);

typedef struct globe_position
{
    degree_units shown;
    double altitude; ///< 0 without altitudes
} globe_position;

/// A sequence of lines, or of rings without a repeated first position; line i ends before ends[i]. All zero: empty. After a
/// failed allocation `failed` stays set.
typedef struct globe_lines
{
    globe_position *positions;
    size_t position_count, position_capacity;
    size_t *ends;
    size_t count, capacity;
    bool failed;
} globe_lines;

void globe_lines_add(globe_lines *lines, globe_position position);
void globe_lines_end(globe_lines *lines);
void globe_lines_free(globe_lines *lines);
static inline size_t globe_line_begin(const globe_lines *lines, size_t line)
{
    return line == 0 ? 0 : lines->ends[line - 1];
}

globe_position globe_curve_position(const globe_curve *curve, size_t index);

/// Append the pieces of a curve that crosses the antimeridian. Each piece begins and ends at a crossing, except at the ends
/// of an open curve.
void globe_curve_cut(const degree_grid *grid, const globe_curve *curve, globe_lines *pieces);

/// Polygons in longitude and latitude: an outer ring and its holes.
typedef struct globe_polygons
{
    globe_lines rings;   ///< the rings of all polygons, without repeated first positions
    size_t *ring_counts; ///< for each polygon
    size_t count, capacity;
} globe_polygons;

/// Append the parts of a polygon that crosses the antimeridian. No part crosses it; the parts' borders run along it.
///
/// A ring that winds once around the axis encloses the pole on the side with the smaller area. When both areas are equal, it
/// is the pole on its left. Such a polygon is closed along the antimeridian through the pole. Two such rings, one of them a
/// hole, bound a belt.
///
/// @param rings the outer ring and the holes, after globe_curve_show()
/// @return false when out of memory
bool globe_polygon_cut(const degree_grid *grid, const globe_curve *rings, size_t ring_count, globe_polygons *parts);

void globe_polygons_free(globe_polygons *polygons);

#endif
