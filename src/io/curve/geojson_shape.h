#pragma once

#include "base/text_buffer.h"
#include "batten/curve_file.h"
#include "io/curve/stitch.h"
#include "space/degrees.h"

/// @file
/// GeoJSON geometries during writing.

// Curves and polygons on the sphere, cut at the antimeridian as RFC 7946, section 3.1.9, requires.
//
// A vertex with a rounded longitude of 180 degrees lies on the antimeridian and takes the sign of the vertex before it. A
// vertex that rounds to a pole takes the longitude of the vertex before it. At the start of an open curve both use the
// vertex after it. After an edge of a polygon along the antimeridian, the sign is that of the interior.

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
    int pole_turn;    ///< at the north pole a polygon's border turns 1 eastwards, -1 westwards; 0 for lines and off poles
    size_t cut_count; ///< the number of edges that cross the antimeridian, set by globe_curve_show()
} globe_curve;

/// Round the coordinates of a curve and count its crossings of the antimeridian. False when a point is not finite.
bool globe_curve_show(const degree_grid *grid, globe_curve *curve);

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

void globe_lines_free(globe_lines *lines);
static inline size_t globe_line_begin(const globe_lines *lines, size_t line)
{
    return line == 0 ? 0 : lines->ends[line - 1];
}

/// Append a curve that does not cross the antimeridian.
void globe_curve_add(const globe_curve *curve, bool repeat_first, globe_lines *lines);

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

/// The form of positions.
typedef struct geojson_style
{
    bool globe;       ///< longitude and latitude, cut at the antimeridian; else plain coordinates
    int decimals;     ///< of degrees
    degree_grid grid; ///< of degrees
    size_t altitude;  ///< the channel of the third number, or BAT_NO_INDEX
    bool further;     ///< the channels after it are further numbers
    bool located;     ///< curves have places as their last channels, as in GPX, and altitudes before them where there are
                      ///< any; every point is written, for geojson_shape_values()
} geojson_style;

/// Whether the interior of the polygon is on the left of a ring, after globe_curve_show().
bool geojson_interior_is_left(const geojson_style *style, const globe_curve *ring);

/// Whether two positions that follow each other need one between them: a border that reaches a pole at the longitude of one
/// vertex leaves it at that of the next.
static inline bool geojson_turns_at_pole(const geojson_style *style, degree_units before, degree_units after)
{
    int64_t pole = before.latitude < 0 ? -before.latitude : before.latitude;
    return style->globe && pole == style->grid.quarter_turn && before.latitude != after.latitude &&
           before.longitude != after.longitude;
}

/// The curves of one geometry, prepared for output. All zero: empty. A shape is reused, and keeps its memory.
typedef struct geojson_shape
{
    const char *type; ///< the type of the geometry in the file

    globe_curve *curves;
    size_t curve_count, curve_capacity;
    degree_units *shown; ///< for all curves, as in globe_curve
    size_t shown_capacity;
    const stitch_polygon *polygons; ///< null for lines
    size_t polygon_count;
    stitch_polygon *kept; ///< the polygons without the rings that were left out; `polygons` points to it
    size_t kept_capacity;
    size_t left_out;       ///< rings without an extent at the decimals of the file, of all geometries
    size_t first_left_out; ///< the least of their curves
    size_t value_count;    ///< the numbers of a position after the first two

    bool cut;             ///< write `pieces` or `parts` in place of the curves
    globe_lines pieces;   ///< of lines
    globe_polygons parts; ///< of polygons
} geojson_shape;

/// Prepare lines. `type` was "LineString" or "MultiLineString" before the cut; `first` is the first curve's index.
/// @return BAT_OK, BAT_INVALID_POINT, BAT_UNSUPPORTED (too few points, or no extent at the decimals) or BAT_NO_MEMORY
bat_status geojson_shape_lines(geojson_shape *shape, const geojson_style *style, const char *type, const bat_curve *curves,
                               size_t count, size_t first, bat_error *error);

/// Prepare polygons. `type` is "Polygon" or "MultiPolygon". The curves are the rings of one polygon after the other. Poles
/// are as in globe_polygon_cut(). Rings that have no extent at the decimals of the file are left out and counted; a geometry
/// needs one with an extent.
bat_status geojson_shape_polygons(geojson_shape *shape, const geojson_style *style, const char *type,
                                  const bat_curve *curves, const stitch_polygon *polygons, size_t polygon_count,
                                  size_t first, bat_error *error);

/// Append the value of a position: of point `index` of curve `curve` of the shape, or at a share of the edge after it.
typedef void geojson_value_writer(const void *context, size_t curve, size_t index, double share, text_buffer *text);

/// Write a value for each position of lines of a style that is located, in arrays as geojson_shape_write() does.
void geojson_shape_values(const geojson_shape *shape, geojson_value_writer *write, const void *context, text_buffer *text);

void geojson_shape_write(const geojson_shape *shape, const geojson_style *style, text_buffer *text);

void geojson_shape_free(geojson_shape *shape);

// What a refined map must not be: polygons that cross themselves or have lost area, and borders that are no longer shared.

/// Judge the polygons of a geometry as a file will hold them. They must not cross or touch themselves unless the given ones
/// do, and their area must be that of the given ones and what lies between the borders; where given vertices have moved, the
/// area is not judged.
///
/// @param given  the shape of the given curves
/// @param fine   that of the refined ones
/// @param first  the index of the first curve, for messages
/// @return BAT_OK, BAT_UNSUPPORTED or BAT_NO_MEMORY
bat_status judge_polygons(const geojson_shape *given, const geojson_shape *fine, const geojson_style *style, size_t first,
                          bat_error *error);

/// Judge shared edges: what became of one is the same in every curve. Curves with moved or dropped vertices do not count.
/// @return BAT_OK, BAT_UNSUPPORTED or BAT_NO_MEMORY
bat_status judge_borders(const bat_curve_set *given, const bat_curve_set *fine, bat_error *error);
