#ifndef IO_CURVE_ANTIMERIDIAN_H
#define IO_CURVE_ANTIMERIDIAN_H

#include "base/array_grow.h"
#include "space/degrees.h"

/// @file
/// Curves and polygons on the sphere, cut at the antimeridian as RFC 7946, section 3.1.9, requires.
///
/// A vertex with a rounded longitude of 180 degrees lies on the antimeridian and takes the sign of the vertex before it. A
/// vertex that rounds to a pole takes the longitude of the vertex before it. At the start of an open curve both use the
/// vertex after it. After an edge of a polygon along the antimeridian, the sign is that of the interior.

/// The integer grid of longitudes and latitudes.
typedef struct degree_grid
{
    int64_t half_turn;    ///< 180 degrees in units
    int64_t quarter_turn; ///< 90 degrees in units
    double units_per_radian;
} degree_grid;

degree_grid degree_grid_of(int decimals);

/// What a curve bounds.
typedef enum globe_role
{
    GLOBE_LINE, ///< nothing
    GLOBE_OUTER,
    GLOBE_HOLE
} globe_role;

typedef struct globe_curve
{
    const double *points; ///< count x 3
    const double *values; ///< the further numbers of the first point, such as its altitude, or null
    size_t value_stride;  ///< the step from one point's numbers to the next, in doubles
    degree_units *shown;  ///< count: the rounded coordinates, set by globe_curve_show()
    size_t count;
    bool closed;
    globe_role role;  ///< of a closed curve
    int pole;         ///< of an outer ring around the axis, as in globe_polygon_cut()
    size_t cut_count; ///< the number of edges that cross the antimeridian, set by globe_curve_show()
} globe_curve;

/// Round the coordinates of a curve and count its crossings of the antimeridian. False when a point is not finite.
bool globe_curve_show(const degree_grid *grid, globe_curve *curve);

/// Whether the smaller side of a ring around the axis contains the south pole, after globe_curve_show().
bool globe_ring_encloses_south(const degree_grid *grid, const globe_curve *ring);

typedef struct globe_position
{
    degree_units shown;
    const double *values; ///< its further numbers; null without any
    const double *after;  ///< at a crossing: those of the next vertex, between which and `values` its numbers are
    double share;         ///< 0 at a vertex
    size_t start;         ///< not 0: a ring begins here, 1 for the first one
} globe_position;

/// A further number of a position.
double globe_position_value(const globe_position *position, size_t index);

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
/// of an open curve. `start` is the `start` of the first vertex of a closed curve.
void globe_curve_cut(const degree_grid *grid, const globe_curve *curve, size_t start, globe_lines *pieces);

/// Polygons in longitude and latitude: an outer ring and its holes.
typedef struct globe_polygons
{
    globe_lines rings;   ///< the rings of all polygons, without repeated first positions
    size_t *ring_counts; ///< for each polygon
    size_t count, capacity;
} globe_polygons;

/// Append the parts of a polygon that crosses the antimeridian. No part crosses it; the parts' borders run along it.
///
/// A ring that winds once around the axis encloses the pole that its `pole` names, 1 for the north or -1 for the south. With
/// 0 it is the pole on the side with the smaller area; when both areas are equal, the pole on its left. Such a polygon is
/// closed along the antimeridian through the pole. Two such rings, one of them a hole, bound a belt. A part with the first
/// vertex of a ring begins there, the others at a crossing.
///
/// @param rings the outer ring and the holes, after globe_curve_show()
/// @return false when out of memory
bool globe_polygon_cut(const degree_grid *grid, const globe_curve *rings, size_t ring_count, globe_polygons *parts);

void globe_polygons_free(globe_polygons *polygons);

#endif
