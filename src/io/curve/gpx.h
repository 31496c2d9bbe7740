#pragma once

#include "io/curve/csv.h"
#include "io/curve/geojson.h"
#include "io/curve/geojson_shape.h"

/// @file
/// GPX 1.0 and 1.1 (https://www.topografix.com/gpx.asp). A file is kept as its own text, in UTF-8, around the points of its
/// tracks and routes, so that all of it comes back. Values of points are columns, as those of CSV: new points get values
/// between.

/// More values than these are kept at the given points alone.
#define GPX_MAX_COLUMNS 64

/// A part of a text.
typedef struct text_range
{
    size_t begin, end;
} text_range;

/// A value of points: an element with text, told apart from others by its tags.
typedef struct gpx_column
{
    text_range parents; ///< the start tags of the elements around it, in gpx_source::tags
    text_range tag;     ///< its own start tag
    text_range name;    ///< its name without a prefix, in gpx_source::tags
    csv_kind kind;      ///< CSV_TIME, CSV_GAPS or CSV_TEXT
    int decimals;       ///< the most of a number
    int rank;           ///< among the children of a point, as the schema orders them
    size_t index;       ///< by the first values
    bool direct;        ///< no element but the point is around it
} gpx_column;

/// A value of a point.
typedef struct gpx_value
{
    size_t column;
    text_range text;
} gpx_value;

/// A point element of the file. Points that repeat the one before them are not among those of the curve.
typedef struct gpx_row
{
    size_t content; ///< where its content begins in gpx_source::contents; the next row's begins at its end
    size_t value;   ///< where its values begin, likewise
} gpx_row;

/// The points of a track segment or route.
typedef struct gpx_curve
{
    size_t frame;      ///< where they stand in gpx_source::frame
    text_range tag;    ///< the name of their elements, in gpx_source::tags
    text_range indent; ///< the blanks before each
    size_t row, row_count;
    size_t point;   ///< its first among the points of all curves
    bool returning; ///< the last row repeats the first point of the closed curve
} gpx_curve;

/// What is kept of a file.
typedef struct gpx_source
{
    text_buffer frame; ///< the text of the file without the points of the curves
    text_buffer tags, contents, texts;
    text_range bounds; ///< the start tag <bounds> in the frame; empty for none
    double box[4];     ///< its least longitude and latitude, and its greatest
    gpx_column *columns;
    size_t column_count, column_capacity;
    gpx_curve *curves;
    size_t curve_count, curve_capacity;
    gpx_row *rows; ///< and one behind the last
    size_t row_count, row_capacity;
    gpx_value *values;
    size_t value_count, value_capacity;
    size_t *point_rows; ///< the row of each point of the curves
    size_t point_count, point_capacity;
    size_t altitude; ///< the column of altitudes, which are channels where all points of a feature have one; or BAT_NO_INDEX
    size_t waypoints;
    size_t repeats; ///< rows that repeat the point before
} gpx_source;

/// The column of an element by its start tags and its name without a prefix, also a new one.
/// @param key    the start tags of the elements in the point down to it; its own begins at byte `own`
/// @return BAT_NO_INDEX where there are too many, or, with `tags` failed, when out of memory
size_t gpx_column_find(gpx_source *source, const char *key, size_t size, size_t own, const char *name);

/// The altitude of the last row, NaN for none.
double gpx_altitude(const gpx_source *source, size_t row);

/// Put the columns in the order of the schema, and find their kinds, after the last row.
void gpx_columns_sort(gpx_source *source);

/// A place between the rows of the file.
typedef struct gpx_place
{
    size_t from, to; ///< rows
    double share;    ///< 0 at `from`
} gpx_place;

/// The length of the name in a start tag, which begins with '<' and has no final zero.
size_t gpx_name_size(const char *tag, const char *end);

/// The rows around a place among the points of a curve, as cells_places() gives it.
gpx_place gpx_place_of(const gpx_source *source, size_t curve, double place);

/// Append the value of a column at a place: a text at a row alone. False, without appending, for none.
bool gpx_value_write(const gpx_source *source, size_t column, gpx_place place, text_buffer *text);

/// Append a number with the decimals of a column.
void gpx_number_write(const gpx_column *column, double value, text_buffer *text);

/// The columns of a set that was read, as those of a CSV file, for points with `altitude` in their first channel or without.
bat_curve_attributes *gpx_attributes_make(const gpx_source *source, const curve_builder *builder, bool altitude,
                                          bool degrees);

void gpx_source_free(gpx_source *source);

/// What of a set from GPX another format has no place for, in words; null for nothing, and for other sets.
const char *gpx_lost(const bat_curve_set *set, bat_curve_format format);

/// The member "coordinateProperties" of a feature of GeoJSON, as togeojson writes it: the values of its points.
/// @param first the curve of the set that the shape begins with
/// @return false when out of memory
bool gpx_properties_write(const bat_curve_set *set, const geojson_shape *shape, size_t first, text_buffer *text);
