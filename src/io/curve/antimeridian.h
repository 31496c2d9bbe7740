#ifndef IO_CURVE_ANTIMERIDIAN_H
#define IO_CURVE_ANTIMERIDIAN_H

#include "base/array_grow.h"
#include "io/common/degrees.h"

/// Curves on the sphere cut where they cross the meridian of 180 degrees, as RFC 7946, section 3.1.9, asks.
///
/// A vertex that shows as 180 degrees lies on the meridian and goes with the vertex before it, on whichever side that is. A
/// vertex that shows as a pole has no longitude of its own and shows that of the vertex before it. (At the beginning of an
/// open curve: of the vertex after it.)

/// The grid of degrees.
typedef struct degree_grid
{
    int64_t half_turn;    ///< 180 degrees in units
    int64_t quarter_turn; ///< 90 degrees in units
    double units_per_radian;
} degree_grid;

degree_grid degree_grid_of(int decimals);

/// A curve on its way to a file.
typedef struct globe_curve
{
    const double *points;    ///< count x 3
    const double *altitudes; ///< of the first point; null without
    size_t altitude_stride;  ///< doubles from one point's altitude to the next
    degree_units *shown;     ///< count; filled by globe_curve_show()
    size_t count;
    bool closed;
    size_t cut_count; ///< edges that cross the meridian; found by globe_curve_show()
} globe_curve;

/// Find out how the points of a curve show, and where it crosses the meridian. False when a point is not finite.
bool globe_curve_show(const degree_grid *grid, globe_curve *curve);

typedef struct globe_position
{
    degree_units shown;
    double altitude; ///< 0 without
} globe_position;

/// Lines (or rings, the first position not repeated) one after the other: line i ends before ends[i]. All zero: none. After
/// an allocation fails, `failed` stays set.
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

/// Add the pieces of a curve that crosses the meridian: each begins and ends at the crossing point, which both sides have,
/// save for the two ends of an open curve.
void globe_curve_cut(const degree_grid *grid, const globe_curve *curve, globe_lines *pieces);

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
