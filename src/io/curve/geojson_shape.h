#ifndef IO_CURVE_GEOJSON_SHAPE_H
#define IO_CURVE_GEOJSON_SHAPE_H

#include "base/text_buffer.h"
#include "batten/curve_file.h"
#include "io/curve/antimeridian.h"
#include "io/curve/stitch.h"

/// @file
/// GeoJSON geometries during writing.

/// The form of positions.
typedef struct geojson_style
{
    bool globe;       ///< longitude and latitude, cut at the antimeridian; else plain coordinates
    int decimals;     ///< of degrees
    degree_grid grid; ///< of degrees
    size_t altitude;  ///< the channel of the third number, or BAT_NO_INDEX
    bool further;     ///< the channels after it are further numbers
} geojson_style;

/// The curves of one geometry, prepared for output. All zero: empty. A shape is reused for many geometries and keeps its
/// memory.
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

/// Prepare lines. `type` is their type before the cut, "LineString" or "MultiLineString". `first` is the index of the first
/// curve, for messages.
/// @return BAT_OK, BAT_INVALID_POINT, BAT_UNSUPPORTED (too few points, or no extent at the decimals) or BAT_NO_MEMORY
bat_status geojson_shape_lines(geojson_shape *shape, const geojson_style *style, const char *type, const bat_curve *curves,
                               size_t count, size_t first, bat_error *error);

/// Prepare polygons. `type` is "Polygon" or "MultiPolygon". The curves are the rings of one polygon after the other. Poles
/// are as in globe_polygon_cut(). Rings that have no extent at the decimals of the file are left out and counted; a geometry
/// needs one with an extent.
bat_status geojson_shape_polygons(geojson_shape *shape, const geojson_style *style, const char *type,
                                  const bat_curve *curves, const stitch_polygon *polygons, size_t polygon_count,
                                  size_t first, bat_error *error);

void geojson_shape_write(const geojson_shape *shape, const geojson_style *style, text_buffer *text);

void geojson_shape_free(geojson_shape *shape);

#endif
