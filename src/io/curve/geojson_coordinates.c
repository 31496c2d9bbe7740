#include "io/curve/geojson.h"

#include "base/error.h"
#include "io/common/number_text.h"
#include "space/degrees.h"

#include <stdarg.h>

/// @file
/// Coordinates of GeoJSON geometries (RFC 7946, section 3.1), read from text without a parse tree.

static const size_t NOWHERE = BAT_NO_INDEX;

/// The current place: "feature 6 (id 'ATA'), polygon 7, ring 0, position 381".
static void describe_place(const geojson_reader *reader, char *text, size_t size)
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
    describe_place(reader, where, sizeof where);
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

/// Count an edge whose longitudes may be meant the long way round. A crossing near the antimeridian is not.
static void note_wide(geojson_reader *reader, double from, double to)
{
    static const double NEAR = 170; // degrees; farther ones are near the antimeridian
    double less = fmin(fabs(from), fabs(to)), more = fmax(fabs(from), fabs(to));
    if (fabs(to - from) > 180 && less <= NEAR && more <= 180 && reader->findings.wide++ == 0)
        describe_place(reader, reader->findings.first_wide, sizeof reader->findings.first_wide);
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
    {
        if (reader->strict)
            return geojson_fault(reader, "the position repeats the one before it");
        if (reader->findings.repeats++ == 0)
            describe_place(reader, reader->findings.first_repeat, sizeof reader->findings.first_repeat);
        return BAT_OK;
    }
    fault = builder_admit(&reader->builder);
    if (fault != NULL)
        return builder_refuse(&reader->builder, geojson_fault(reader, "the point is %s", fault), reader->error);
    if (!reader->degrees)
        return BAT_OK;
    if (reader->builder.point_count > 1)
        note_wide(reader, reader->positions[2 * (reader->position_count - 1)], numbers[0]);
    if (!ARRAY_GROW(reader->positions, reader->position_capacity, 2 * reader->position_count + 2))
        return geojson_no_memory(reader);
    memcpy(reader->positions + 2 * reader->position_count++, numbers, 2 * sizeof *numbers);
    return BAT_OK;
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

/// Count a part that is dropped, at the reader's place.
static void note_degenerate(geojson_reader *reader)
{
    if (reader->findings.degenerate++ == 0)
        describe_place(reader, reader->findings.first_degenerate, sizeof reader->findings.first_degenerate);
}

/// Read an array of positions as a curve; none of an empty array. Lines are closed when the geometry is complete.
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
    if (count < fewest && reader->strict) // else it is dropped when the geometry is complete
        return geojson_fault(reader, "a %s needs at least %zu positions", reader->rings ? "ring" : "line", fewest);
    if (count == 0)
    {
        note_degenerate(reader);
        return BAT_OK;
    }
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

static bat_status read_parts(geojson_reader *reader, json_scanner *scan)
{
    if (!json_scan_take(scan, '[') || (reader->strict && json_scan_at(scan, ']')))
        return geojson_fault(reader, "the coordinates must be an array of arrays of positions");
    if (json_scan_at(scan, ']')) // of a polygon among others
        note_degenerate(reader);
    bat_status status = BAT_OK;
    for (size_t i = 0; status == BAT_OK && json_scan_element(scan, i); i++)
    {
        reader->place.part = i;
        status = read_part(reader, scan);
    }
    reader->place.part = NOWHERE;
    return status;
}

/// Forget the curves from one on.
static void drop_curves(geojson_reader *reader, size_t first_curve)
{
    for (size_t i = first_curve; i < reader->builder.curve_count; i++)
        bat_curve_free(&reader->builder.curves[i]);
    reader->builder.curve_count = reader->document.curve_count = first_curve;
}

static bat_status read_polygon(geojson_reader *reader, json_scanner *scan)
{
    geojson_document *document = &reader->document;
    if (!geojson_document_reserve(document, document->polygon_count + 1, document->curve_count))
        return geojson_no_memory(reader);
    size_t first = document->curve_count, positions = reader->position_count;
    bat_status status = read_parts(reader, scan);
    if (document->curve_count > first && document->origins[first].ring > 0) // an empty outer ring
    {
        drop_curves(reader, first);
        reader->position_count = positions;
    }
    if (document->curve_count > first)
        document->polygons[document->polygon_count++] = (stitch_polygon){.rings = document->curve_count - first};
    return status;
}

static bat_status read_polygons(geojson_reader *reader, json_scanner *scan)
{
    (void)json_scan_take(scan, '[');
    bat_status status = BAT_OK;
    for (size_t i = 0; status == BAT_OK && json_scan_element(scan, i); i++)
    {
        reader->place.polygon = i;
        status = read_polygon(reader, scan);
    }
    reader->place.polygon = NOWHERE;
    return status;
}

// Completion of GeoJSON geometries whose coordinates have been read: parts that the file cuts at the antimeridian are
// joined, lines are closed, lines and rings with too few different points are dropped.

/// Make a line closed when its ends are equal; `closed` as in bat_curve_read_options.
static void close_line(bat_curve *curve, int closed)
{
    static const int RING_POSITIONS = 4;
    size_t dim = curve->space->point_dim, last = curve->count - 1, channels = curve->channel_count;
    bool returns = last > 0 && points_equal(curve->points, curve->points + last * dim, dim);
    for (size_t k = 0; k < channels && returns; k++)
        returns = curve->channels[k] == curve->channels[last * channels + k];
    curve->closed = closed < 0 ? returns && curve->count >= RING_POSITIONS : closed > 0;
    if (curve->closed && returns)
        curve->count--;
}

/// Make one point of neighbours that are the same point of the sphere.
static void merge_aliases(bat_curve *curve)
{
    size_t count = 1, channels = curve->channel_count;
    double *points = curve->points;
    for (size_t i = 1; i < curve->count; i++)
    {
        if (points_equal(points + 3 * i, points + 3 * (count - 1), 3))
            continue;
        memmove(points + 3 * count, points + 3 * i, 3 * sizeof *points);
        if (channels > 0)
            memmove(curve->channels + count * channels, curve->channels + i * channels, channels * sizeof *points);
        count++;
    }
    while (curve->closed && count > 1 && points_equal(points, points + 3 * (count - 1), 3))
        count--;
    curve->count = count;
}

/// Move the last curves of the builder, and the polygons, into a geometry. Null arrays when out of memory.
static bool take_geometry(geojson_reader *reader, size_t first_curve, size_t first_polygon, stitch_geometry *geometry)
{
    curve_builder *builder = &reader->builder;
    geojson_document *document = &reader->document;
    size_t curves = builder->curve_count - first_curve, polygons = document->polygon_count - first_polygon;
    *geometry = (stitch_geometry){.curves = memory_array(curves, sizeof *geometry->curves),
                                  .origins = memory_array(curves, sizeof *geometry->origins),
                                  .polygons = memory_array(polygons, sizeof *geometry->polygons)};
    if (geometry->curves == NULL || geometry->origins == NULL || geometry->polygons == NULL)
    {
        stitch_geometry_free(geometry);
        return false;
    }
    memcpy(geometry->curves, builder->curves + first_curve, curves * sizeof *geometry->curves);
    memcpy(geometry->origins, document->origins + first_curve, curves * sizeof *geometry->origins);
    if (polygons > 0)
        memcpy(geometry->polygons, document->polygons + first_polygon, polygons * sizeof *geometry->polygons);
    geometry->count = curves;
    geometry->polygon_count = polygons;
    builder->curve_count = first_curve;
    document->curve_count = first_curve;
    document->polygon_count = first_polygon;
    return true;
}

/// Move the curves of a geometry to the builder, and its polygons to the document.
static bool give_geometry(geojson_reader *reader, stitch_geometry *geometry)
{
    geojson_document *document = &reader->document;
    size_t curves = document->curve_count, polygons = document->polygon_count;
    curve_builder part = {.curves = geometry->curves, .curve_count = geometry->count};
    if (!geojson_document_reserve(document, polygons + geometry->polygon_count, curves + geometry->count) ||
        !builder_append(&reader->builder, &part))
        return false;
    memcpy(document->origins + curves, geometry->origins, geometry->count * sizeof *geometry->origins);
    if (geometry->polygon_count > 0)
        memcpy(document->polygons + polygons, geometry->polygons, geometry->polygon_count * sizeof *geometry->polygons);
    document->curve_count += geometry->count;
    document->polygon_count += geometry->polygon_count;
    geometry->count = 0;
    return true;
}

/// Join what is cut at the antimeridian. The geometry is the curves from `first_curve` on.
static bat_status join_parts(geojson_reader *reader, size_t first_curve, size_t first_polygon, bool *represented)
{
    stitch_geometry geometry;
    stitch_report report = {0};
    geojson_findings *findings = &reader->findings;
    const stitch_tolerance tolerance = stitch_tolerance_of(reader->positions, reader->position_count);
    if (!take_geometry(reader, first_curve, first_polygon, &geometry))
        return geojson_no_memory(reader);
    bool done = reader->rings ? stitch_polygons(&geometry, reader->positions, &tolerance, &report)
                              : stitch_lines(&geometry, reader->positions, &tolerance, reader->closed != 0, &report);
    done = done && give_geometry(reader, &geometry);
    stitch_geometry_free(&geometry);
    if (!done)
        return geojson_no_memory(reader);
    stitch_report *sum = reader->rings ? &findings->polygons : &findings->lines;
    if (report.joins > 0 && findings->lines.joins + findings->polygons.joins == 0)
        describe_place(reader, findings->first_join, sizeof findings->first_join);
    if (report.poles > 0 && findings->polygons.poles == 0)
        describe_place(reader, findings->first_pole, sizeof findings->first_pole);
    stitch_report_add(sum, &report);
    *represented = report.unrepresented == 0;
    return BAT_OK;
}

static bool is_degenerate(const bat_curve *curve)
{
    enum
    {
        LINE_POINTS = 2,
        RING_POINTS = 3
    };
    return curve->count < (curve->closed ? (size_t)RING_POINTS : (size_t)LINE_POINTS);
}

/// Remove rings and lines with too few points, and polygons whose outer ring has too few.
static bat_status drop_degenerate(geojson_reader *reader, size_t first_curve, size_t first_polygon)
{
    curve_builder *builder = &reader->builder;
    geojson_document *document = &reader->document;
    size_t ring = first_curve, kept = first_curve, kept_polygons = first_polygon, end = builder->curve_count;
    size_t polygon = first_polygon;
    while (ring < end)
    {
        size_t rings = reader->rings ? document->polygons[polygon].rings : 1, before = kept;
        bool dropped = is_degenerate(&builder->curves[ring]);
        for (size_t i = 0; i < rings; i++, ring++)
        {
            bat_curve *curve = &builder->curves[ring];
            stitch_origin origin = document->origins[ring];
            bool degenerate = is_degenerate(curve);
            if (degenerate)
            {
                geojson_place *place = &reader->place;
                const geojson_place outer = *place;
                if (reader->multiple && reader->rings)
                    place->polygon = origin.part;
                if (reader->multiple || reader->rings)
                    place->part = reader->rings ? origin.ring : origin.part;
                if (reader->strict)
                    return geojson_fault(reader, "the %s has too few different positions", reader->rings ? "ring" : "line");
                note_degenerate(reader);
                *place = outer;
            }
            if (degenerate || dropped)
            {
                bat_curve_free(curve);
                continue;
            }
            bat_curve moved = *curve;
            *curve = (bat_curve){0};
            builder->curves[kept] = moved;
            document->origins[kept++] = origin;
        }
        if (!reader->rings)
            continue;
        if (kept > before)
            document->polygons[kept_polygons++] = (stitch_polygon){kept - before, document->polygons[polygon].pole};
        polygon++;
    }
    builder->curve_count = document->curve_count = kept;
    document->polygon_count = kept_polygons;
    return BAT_OK;
}

/// Join, close and clean the curves of a geometry that has been read.
static bat_status complete_geometry(geojson_reader *reader, size_t first_curve, size_t first_polygon)
{
    curve_builder *builder = &reader->builder;
    bool represented = true, degenerate = false;
    // Curves get the space of the set at the end; until then that of the builder.
    for (size_t i = first_curve; i < builder->curve_count; i++)
        builder->curves[i].space = &builder->space;
    if (reader->degrees && stitch_concerns(reader->positions, reader->position_count))
    {
        bat_status status = join_parts(reader, first_curve, first_polygon, &represented);
        if (status != BAT_OK)
            return status;
    }
    for (size_t i = first_curve; i < builder->curve_count; i++)
    {
        if (!reader->rings && !builder->curves[i].closed)
            close_line(&builder->curves[i], reader->closed);
        if (reader->aliases)
            merge_aliases(&builder->curves[i]);
        degenerate = degenerate || is_degenerate(&builder->curves[i]);
    }
    bat_status status = degenerate && represented ? drop_degenerate(reader, first_curve, first_polygon) : BAT_OK;
    if (status == BAT_OK && (!represented || builder->curve_count == first_curve))
    {
        // The geometry passes unchanged.
        drop_curves(reader, first_curve);
        reader->document.polygon_count = first_polygon;
        if (reader->findings.unchanged++ == 0)
            describe_place(reader, reader->findings.first_unchanged, sizeof reader->findings.first_unchanged);
    }
    return status;
}

bat_status geojson_read_coordinates(geojson_reader *reader, geometry_kind kind, json_scanner *scan)
{
    size_t first_curve = reader->builder.curve_count, first_polygon = reader->document.polygon_count;
    reader->rings = kind == GEOMETRY_POLYGON || kind == GEOMETRY_POLYGONS;
    reader->multiple = kind == GEOMETRY_LINES || kind == GEOMETRY_POLYGONS;
    reader->number_count = 0;
    reader->position_count = 0;
    reader->aliases = false;
    bat_status status = kind == GEOMETRY_LINE      ? read_part(reader, scan)
                        : kind == GEOMETRY_LINES   ? read_parts(reader, scan)
                        : kind == GEOMETRY_POLYGON ? read_polygon(reader, scan)
                                                   : read_polygons(reader, scan);
    return status == BAT_OK ? complete_geometry(reader, first_curve, first_polygon) : status;
}
