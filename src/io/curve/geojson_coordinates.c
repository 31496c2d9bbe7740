#include "io/curve/geojson.h"

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

void geojson_describe_place(const geojson_reader *reader, char *text, size_t size)
{
    const geojson_place *place = &reader->place;
    const geojson_document *document = &reader->document;
    text[0] = '\0';
    geojson_append_place(text, size, "feature", place->feature);
    if (place->feature != NOWHERE && document->feature_count > 0)
        geojson_append_id(text, size, document->features[document->feature_count - 1].tree);
    geojson_append_place(text, size, "geometry", place->geometry);
    geojson_append_place(text, size, "polygon", place->polygon);
    geojson_append_place(text, size, reader->rings ? "ring" : "line", place->part);
    geojson_append_place(text, size, "position", place->position);
}

bat_status geojson_fault(geojson_reader *reader, const char *format, ...)
{
    char where[120], what[160];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    geojson_describe_place(reader, where, sizeof where);
    return error_set(reader->error, BAT_BAD_FILE, reader->place.position, reader->place.line, "%s%s%s", where,
                     where[0] != '\0' ? ": " : "", what);
}

bat_status geojson_no_memory(geojson_reader *reader)
{
    return error_memory(reader->error, reader->builder.point_capacity * sizeof(double));
}

static bat_status bad_position(geojson_reader *reader)
{
    return geojson_fault(reader, "a position must be an array of 2 or more numbers");
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

static bool keep_degrees(geojson_reader *reader, const double *numbers)
{
    if (!ARRAY_GROW(reader->positions, reader->position_capacity, 2 * reader->position_count + 2))
        return false;
    memcpy(reader->positions + 2 * reader->position_count++, numbers, 2 * sizeof *numbers);
    return true;
}

/// Whether the position at `point` repeats the one before it, number by number. A position with other numbers can be the
/// same point of the sphere, at a pole or on the antimeridian: such outlines are joined later.
static bool repeats(geojson_reader *reader, const double *numbers, const double *point)
{
    const curve_builder *builder = &reader->builder;
    size_t dim = builder->space.point_dim;
    if (builder->point_count == 0 || !points_equal(point, point - dim, dim))
        return false;
    if (!reader->degrees)
        return true;
    const double *before = reader->positions + 2 * (reader->position_count - 1);
    bool same = before[0] == numbers[0] && before[1] == numbers[1];
    reader->aliases = reader->aliases || !same;
    return same;
}

static bat_status drop_repeat(geojson_reader *reader)
{
    if (reader->strict)
        return geojson_fault(reader, "the position repeats the one before it");
    if (reader->findings.repeats++ == 0)
        geojson_describe_place(reader, reader->findings.first_repeat, sizeof reader->findings.first_repeat);
    return BAT_OK;
}

static bat_status add_point(geojson_reader *reader, const double *numbers, double *point)
{
    const char *fault = reader->degrees ? degrees_fault(numbers[0], numbers[1]) : NULL;
    if (fault != NULL)
        return error_remedy(reader->error, geojson_fault(reader, "%s", fault), "space", "plane takes plane coordinates");
    if (reader->degrees)
        degrees_to_point(numbers[0], numbers[1], point);
    else
        memcpy(point, numbers, 2 * sizeof *point);
    if (repeats(reader, numbers, point))
        return drop_repeat(reader);
    fault = builder_admit(&reader->builder);
    if (fault != NULL)
        return builder_refuse(&reader->builder, geojson_fault(reader, "the point is %s", fault), reader->error);
    return !reader->degrees || keep_degrees(reader, numbers) ? BAT_OK : geojson_no_memory(reader);
}

/// Count the numbers of a position, which is valid JSON.
static size_t count_numbers(json_scanner scan)
{
    size_t count = 0;
    for (; json_scan_element(&scan, count); count++)
        if (!json_scan_value(&scan))
            break;
    return count;
}

static bat_status read_position(geojson_reader *reader, json_scanner *scan)
{
    double numbers[2] = {0};
    size_t count = 0;
    if (!json_scan_take(scan, '['))
        return bad_position(reader);
    if (reader->number_count == 0)
    {
        reader->number_count = count_numbers(*scan);
        if (reader->number_count < 2 || reader->number_count > BAT_SPACE_MAX_DIM)
            return bad_position(reader);
    }
    double *channels = NULL;
    double *point = builder_next(&reader->builder, reader->number_count - 2, &channels);
    if (point == NULL)
        return geojson_no_memory(reader);
    for (; json_scan_element(scan, count); count++)
    {
        double beyond;
        double *number = count < 2 ? &numbers[count] : count < reader->number_count ? &channels[count - 2] : &beyond;
        bat_status status = read_number(reader, scan, number);
        if (status != BAT_OK)
            return status;
    }
    if (count < 2)
        return bad_position(reader);
    if (count != reader->number_count && (count == 2 || reader->number_count == 2))
        return geojson_fault(reader, "only some positions of the geometry have an altitude");
    if (count != reader->number_count)
        return geojson_fault(reader, "the position has %zu numbers, the one before it %zu", count, reader->number_count);
    return add_point(reader, numbers, point);
}

/// Read an array of positions as a curve. Lines are closed when the geometry is complete.
static bat_status read_part(geojson_reader *reader, json_scanner *scan)
{
    enum
    {
        LINE_POSITIONS = 2,
        RING_POSITIONS = 4
    };
    geojson_document *document = &reader->document;
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
    // Only repetitions were read when a single point is left.
    bool returns = builder_returns(&reader->builder) || reader->builder.point_count == 1;
    if (reader->rings && !returns)
        return geojson_fault(reader, "the last position of a ring must repeat the first");
    if (reader->rings && reader->builder.point_count > 1)
    {
        builder_drop_last(&reader->builder);
        reader->position_count -= reader->degrees;
    }
    size_t curves = reader->builder.curve_count;
    if (!geojson_document_reserve(document, document->polygon_count, curves + 1) ||
        !builder_end_curve(&reader->builder, reader->rings))
        return geojson_no_memory(reader);
    size_t part = reader->rings ? reader->place.polygon : reader->place.part, ring = reader->rings ? reader->place.part : 0;
    document->origins[curves] = (stitch_origin){part != NOWHERE ? part : 0, ring};
    document->curve_count = curves + 1;
    return BAT_OK;
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
    if (!geojson_document_reserve(document, document->polygon_count + 1, document->curve_count))
        return geojson_no_memory(reader);
    size_t count;
    bat_status status = read_parts(reader, scan, &count);
    document->polygons[document->polygon_count++] = (stitch_polygon){.rings = count};
    return status;
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
    size_t unused, first_curve = reader->builder.curve_count, first_polygon = reader->document.polygon_count;
    reader->rings = kind == CURVE_POLYGON || kind == CURVE_POLYGONS;
    reader->multiple = kind == CURVE_LINES || kind == CURVE_POLYGONS;
    reader->number_count = 0;
    reader->position_count = 0;
    reader->aliases = false;
    bat_status status;
    switch (kind)
    {
    case CURVE_LINE:
        status = read_part(reader, scan);
        break;
    case CURVE_LINES:
        status = read_parts(reader, scan, &unused);
        break;
    case CURVE_POLYGON:
        status = read_polygon(reader, scan);
        break;
    default:
        status = read_polygons(reader, scan);
    }
    return status == BAT_OK ? geojson_complete_geometry(reader, first_curve, first_polygon) : status;
}
