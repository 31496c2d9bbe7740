#include "io/curve/geojson_feature.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "io/common/number_text.h"
#include "space/degrees.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/// @file
/// Coordinates of GeoJSON geometries (RFC 7946, section 3.1), read from text without a parse tree.

static const size_t NOWHERE = BAT_NO_INDEX;

static void describe(char *text, size_t size, const char *what, size_t index)
{
    size_t used = strlen(text);
    if (index != NOWHERE)
        (void)snprintf(text + used, size - used, "%s%s %zu", used > 0 ? ", " : "", what, index);
}

bat_status geojson_fault(geojson_reader *reader, const char *format, ...)
{
    char where[120] = "", what[160];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    describe(where, sizeof where, "feature", reader->place.feature);
    describe(where, sizeof where, "geometry", reader->place.geometry);
    describe(where, sizeof where, "polygon", reader->place.polygon);
    describe(where, sizeof where, reader->rings ? "ring" : "line", reader->place.part);
    describe(where, sizeof where, "position", reader->place.position);
    return error_set(reader->error, BAT_BAD_FILE, reader->place.position, reader->place.line, "%s%s%s", where,
                     where[0] != '\0' ? ": " : "", what);
}

bat_status geojson_no_memory(geojson_reader *reader)
{
    return error_memory(reader->error, reader->builder.point_capacity * sizeof(double));
}

static bat_status bad_position(geojson_reader *reader)
{
    return geojson_fault(reader, "a position must be an array of 2 or 3 numbers");
}

static bool is_of_number(char c)
{
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
}

static bat_status read_number(geojson_reader *reader, json_scanner *scan, double *number)
{
    json_scan_blanks(scan);
    const char *begin = scan->at;
    while (scan->at < scan->end && is_of_number(*scan->at))
        scan->at++;
    if (scan->at == begin)
        return bad_position(reader);
    const char *fault = number_read(begin, scan->at, number);
    return fault == NULL ? BAT_OK : geojson_fault(reader, "a number %s", fault);
}

/// Append a position to the current curve.
static bat_status add_point(geojson_reader *reader, const double *numbers, size_t count)
{
    double *altitude;
    double *point = builder_next(&reader->builder, count - 2, &altitude);
    if (point == NULL)
        return geojson_no_memory(reader);
    const char *fault = reader->degrees ? degrees_fault(numbers[0], numbers[1]) : NULL;
    if (fault != NULL)
        return geojson_fault(reader, "%s", fault);
    if (reader->degrees)
        degrees_to_point(numbers[0], numbers[1], point);
    else
        memcpy(point, numbers, 2 * sizeof *point);
    if (count == 3)
        *altitude = numbers[2];
    fault = builder_admit(&reader->builder);
    return fault == NULL ? BAT_OK : geojson_fault(reader, "the point is %s", fault);
}

static bat_status read_position(geojson_reader *reader, json_scanner *scan)
{
    double numbers[3] = {0};
    size_t count = 0;
    if (!json_scan_take(scan, '['))
        return bad_position(reader);
    for (; json_scan_element(scan, count); count++)
    {
        if (count == sizeof numbers / sizeof *numbers)
            return bad_position(reader);
        bat_status status = read_number(reader, scan, &numbers[count]);
        if (status != BAT_OK)
            return status;
    }
    if (count < 2)
        return bad_position(reader);
    if (reader->number_count == 0)
        reader->number_count = count;
    if (count != reader->number_count)
        return geojson_fault(reader, "only some positions of the geometry have an altitude");
    return add_point(reader, numbers, count);
}

/// Read an array of positions as a curve.
static bat_status read_part(geojson_reader *reader, json_scanner *scan)
{
    enum
    {
        LINE_POSITIONS = 2,
        RING_POSITIONS = 4 ///< also the fewest of a line that is read as a closed curve
    };
    size_t count = 0, fewest = reader->rings ? RING_POSITIONS : LINE_POSITIONS;
    if (!json_scan_take(scan, '['))
        return geojson_fault(reader, "the positions must be an array");
    for (; json_scan_element(scan, count); count++)
    {
        reader->place.position = count;
        bat_status status = read_position(reader, scan);
        if (status != BAT_OK)
            return status;
    }
    reader->place.position = NOWHERE;
    if (count < fewest)
        return geojson_fault(reader, "a %s needs at least %zu positions", reader->rings ? "ring" : "line", fewest);
    bool returns = builder_returns(&reader->builder);
    if (reader->rings && !returns)
        return geojson_fault(reader, "the last position of a ring must repeat the first");
    bool closed = reader->rings || (reader->closed < 0 ? returns && count >= RING_POSITIONS : reader->closed > 0);
    if (closed && returns)
        builder_drop_last(&reader->builder);
    return builder_end_curve(&reader->builder, closed) ? BAT_OK : geojson_no_memory(reader);
}

static bat_status read_parts(geojson_reader *reader, json_scanner *scan, size_t *count)
{
    *count = 0;
    if (!json_scan_take(scan, '[') || json_scan_at(scan, ']'))
        return geojson_fault(reader, "the coordinates must be an array of arrays of positions");
    for (; json_scan_element(scan, *count); (*count)++)
    {
        reader->place.part = *count;
        bat_status status = read_part(reader, scan);
        if (status != BAT_OK)
            return status;
    }
    reader->place.part = NOWHERE;
    return BAT_OK;
}

static bat_status read_polygon(geojson_reader *reader, json_scanner *scan)
{
    geojson_document *document = &reader->document;
    void *counts = document->ring_counts;
    bool grown =
        array_grow(&counts, &document->polygon_capacity, document->polygon_count + 1, sizeof *document->ring_counts);
    document->ring_counts = counts;
    if (!grown)
        return geojson_no_memory(reader);
    return read_parts(reader, scan, &document->ring_counts[document->polygon_count++]);
}

static bat_status read_polygons(geojson_reader *reader, json_scanner *scan)
{
    (void)json_scan_take(scan, '[');
    for (size_t i = 0; json_scan_element(scan, i); i++)
    {
        reader->place.polygon = i;
        bat_status status = read_polygon(reader, scan);
        if (status != BAT_OK)
            return status;
    }
    reader->place.polygon = NOWHERE;
    return BAT_OK;
}

bat_status geojson_read_coordinates(geojson_reader *reader, curve_kind kind, json_scanner *scan)
{
    size_t unused;
    reader->rings = kind == CURVE_POLYGON || kind == CURVE_POLYGONS;
    reader->number_count = 0;
    switch (kind)
    {
    case CURVE_LINE:
        return read_part(reader, scan);
    case CURVE_LINES:
        return read_parts(reader, scan, &unused);
    case CURVE_POLYGON:
        return read_polygon(reader, scan);
    default:
        return read_polygons(reader, scan);
    }
}
