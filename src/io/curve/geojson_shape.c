#include "io/curve/geojson_shape.h"

#include "io/curve/csv.h"
#include "linalg/vector.h"

/// @file
/// Curves as the coordinates of a GeoJSON geometry, cut at the antimeridian where needed.

static void clear_lines(globe_lines *lines)
{
    lines->position_count = 0;
    lines->count = 0;
}

static bool values_finite(const globe_curve *curve, size_t value_count)
{
    for (size_t i = 0; curve->values != NULL && i < curve->count; i++)
        if (!vector_is_finite(value_count, curve->values + i * curve->value_stride))
            return false;
    return true;
}

/// Whether a line has two different positions, or a ring encloses an area, at the decimals of the file.
static bool shows_extent(const globe_curve *curve, bool ring)
{
    const double exact = 0x1p25; // Differences below it have exact products and sums.
    const degree_units *first = curve->shown;
    double area = 0, before[2] = {0, 0};
    for (size_t i = 1; i < curve->count; i++)
    {
        double here[2] = {(double)(first[i].longitude - first->longitude), (double)(first[i].latitude - first->latitude)};
        if (fabs(here[0]) > exact || fabs(here[1]) > exact || (!ring && (here[0] != 0 || here[1] != 0)))
            return true;
        area += before[0] * here[1] - before[1] * here[0];
        memcpy(before, here, sizeof before);
    }
    return area != 0;
}

static bat_status no_extent(const geojson_style *style, size_t curve, bat_error *error)
{
    (void)error_set(error, BAT_UNSUPPORTED, curve, 0, "curve %zu has no extent at %d decimals", curve, style->decimals);
    return error_remedy(error, BAT_UNSUPPORTED, "precision", "can keep more decimals");
}

/// `polygons` is null for lines.
static bat_status shape_begin(geojson_shape *shape, const geojson_style *style, const char *type, const bat_curve *curves,
                              size_t count, const stitch_polygon *polygons, size_t first, bat_error *error)
{
    bool lines = polygons == NULL;
    size_t ring = 0, points = 0;
    for (size_t i = 0; i < count; i++)
        points += curves[i].count;
    if (!ARRAY_GROW(shape->curves, shape->curve_capacity, count) ||
        !ARRAY_GROW(shape->shown, shape->shown_capacity, style->globe ? points : 0))
        return error_memory(error, points * sizeof *shape->shown);
    shape->type = type;
    shape->curve_count = count;
    shape->cut = false;
    shape->value_count = 0;
    if (count > 0 && style->located)
        shape->value_count = curves[0].channel_count - CSV_PLACE_CHANNELS;
    else if (count > 0 && style->altitude < curves[0].channel_count)
        shape->value_count = style->further ? curves[0].channel_count - style->altitude : 1;
    clear_lines(&shape->pieces);
    clear_lines(&shape->parts.rings);
    shape->parts.count = 0;
    degree_units *shown = shape->shown;
    for (size_t i = 0; i < count; i++)
    {
        const bat_curve *curve = &curves[i];
        if (curve->count < (curve->closed ? 3 : 2))
            return error_set(error, BAT_UNSUPPORTED, first + i, 0, "GeoJSON cannot hold curve %zu, which has too few points",
                             first + i);
        if (curve->channel_count != curves[0].channel_count)
            return error_set(error, BAT_UNSUPPORTED, first + i, 0,
                             "curve %zu has %zu channels, curve %zu of its geometry %zu", first + i, curve->channel_count,
                             first, curves[0].channel_count);
        shape->curves[i] = (globe_curve){.points = curve->points,
                                         .values = shape->value_count > 0 ? curve->channels + style->altitude
                                                   : style->located       ? curve->channels
                                                                          : NULL,
                                         .value_stride = curve->channel_count,
                                         .shown = shown,
                                         .count = curve->count,
                                         .closed = curve->closed};
        if (polygons != NULL)
        {
            shape->curves[i].role = ring == 0 ? GLOBE_OUTER : GLOBE_HOLE;
            shape->curves[i].pole = ring == 0 ? polygons->pole : 0;
            ring = ring + 1 < polygons->rings ? ring + 1 : 0;
            polygons += ring == 0;
        }
        bool finite = style->globe ? globe_curve_show(&style->grid, &shape->curves[i])
                                   : vector_is_finite(2 * shape->curves[i].count, shape->curves[i].points);
        if (!finite || !values_finite(&shape->curves[i], shape->value_count))
            return error_set(error, BAT_INVALID_POINT, first + i, 0, "a point of curve %zu is not finite", first + i);
        if (style->globe && lines && !shows_extent(&shape->curves[i], false))
            return no_extent(style, first + i, error);
        shape->cut = shape->cut || shape->curves[i].cut_count > 0;
        shown = style->globe ? shown + curve->count : shown;
    }
    return BAT_OK;
}

/// Keep the rings that have an extent at the decimals of the file. A polygon without its outer ring goes as a whole.
static bool keep_extents(geojson_shape *shape, const stitch_polygon *polygons, size_t polygon_count, size_t first)
{
    if (!ARRAY_GROW(shape->kept, shape->kept_capacity, polygon_count))
        return false;
    shape->polygon_count = 0;
    size_t given = 0, kept = 0;
    for (size_t i = 0; i < polygon_count; i++)
    {
        size_t before = kept, end = given + polygons[i].rings;
        bool outer = true;
        for (size_t k = given; k < end; k++)
        {
            bool shown = outer && shows_extent(&shape->curves[k], true);
            outer = k == given ? shown : outer;
            if (shown)
                shape->curves[kept++] = shape->curves[k];
            else if (shape->left_out++ == 0 || first + k < shape->first_left_out)
                shape->first_left_out = first + k;
        }
        given = end;
        if (kept > before)
            shape->kept[shape->polygon_count++] = (stitch_polygon){.rings = kept - before};
    }
    shape->curve_count = kept;
    shape->polygons = shape->kept;
    return true;
}

bat_status geojson_shape_lines(geojson_shape *shape, const geojson_style *style, const char *type, const bat_curve *curves,
                               size_t count, size_t first, bat_error *error)
{
    bat_status status = shape_begin(shape, style, type, curves, count, NULL, first, error);
    shape->polygons = NULL;
    if (status != BAT_OK || !shape->cut)
        return status;
    for (size_t i = 0; i < count; i++)
    {
        const globe_curve *curve = &shape->curves[i];
        if (curve->cut_count > 0)
            globe_curve_cut(&style->grid, curve, 0, &shape->pieces);
        else
            globe_curve_add(curve, curve->closed, &shape->pieces);
    }
    if (shape->pieces.failed)
        return error_memory(error, shape->pieces.position_count * sizeof(globe_position));
    if (shape->pieces.count > 1)
        shape->type = "MultiLineString";
    return BAT_OK;
}

/// Append a polygon that does not cross the antimeridian to parts of polygons that do.
static bool add_uncut_polygon(const globe_curve *rings, size_t ring_count, globe_polygons *parts)
{
    if (!ARRAY_ADD(parts->ring_counts, parts->capacity, parts->count, ring_count))
        return false;
    for (size_t i = 0; i < ring_count; i++)
        globe_curve_add(&rings[i], false, &parts->rings);
    return !parts->rings.failed;
}

bat_status geojson_shape_polygons(geojson_shape *shape, const geojson_style *style, const char *type,
                                  const bat_curve *curves, const stitch_polygon *polygons, size_t polygon_count,
                                  size_t first, bat_error *error)
{
    size_t count = 0;
    for (size_t i = 0; i < polygon_count; i++)
        count += polygons[i].rings;
    bat_status status = shape_begin(shape, style, type, curves, count, polygons, first, error);
    shape->polygons = polygons;
    shape->polygon_count = polygon_count;
    if (status == BAT_OK && style->globe && !keep_extents(shape, polygons, polygon_count, first))
        return error_memory(error, polygon_count * sizeof *polygons);
    if (status == BAT_OK && shape->polygon_count == 0)
        return no_extent(style, first, error);
    if (status != BAT_OK || !shape->cut)
        return status;
    const globe_curve *rings = shape->curves;
    for (size_t i = 0; i < shape->polygon_count; i++)
    {
        size_t ring_count = shape->polygons[i].rings;
        bool cut = false;
        for (size_t k = 0; k < ring_count; k++)
            cut = cut || rings[k].cut_count > 0;
        bool added = cut ? globe_polygon_cut(&style->grid, rings, ring_count, &shape->parts)
                         : add_uncut_polygon(rings, ring_count, &shape->parts);
        if (!added)
            return error_memory(error, count * sizeof *rings);
        rings += ring_count;
    }
    if (shape->parts.count > 1)
        shape->type = "MultiPolygon";
    return BAT_OK;
}

static void write_values(const geojson_shape *shape, const globe_position *position, text_buffer *text)
{
    for (size_t k = 0; k < shape->value_count; k++)
        text_append_real(text, ",", globe_position_value(position, k));
    text_append_string(text, "]");
}

static void write_position(const geojson_shape *shape, const geojson_style *style, const globe_position *position,
                           text_buffer *text)
{
    text_append_fixed(text, "[", position->shown.longitude, style->decimals);
    text_append_fixed(text, ",", position->shown.latitude, style->decimals);
    write_values(shape, position, text);
}

static void write_curve_position(const geojson_shape *shape, const geojson_style *style, const globe_curve *curve,
                                 size_t index, size_t before, text_buffer *text)
{
    globe_position position = {.values = curve->values != NULL ? curve->values + index * curve->value_stride : NULL};
    if (style->globe)
    {
        position.shown = curve->shown[index];
        if (before != index && geojson_turns_at_pole(style, curve->shown[before], position.shown))
        {
            globe_position turned = {.shown = {position.shown.longitude, curve->shown[before].latitude}};
            turned.values = curve->values != NULL ? curve->values + before * curve->value_stride : NULL;
            write_position(shape, style, &turned, text);
            text_append_string(text, ",");
        }
        write_position(shape, style, &position, text);
        return;
    }
    text_append_real(text, "[", curve->points[2 * index]);
    text_append_real(text, ",", curve->points[2 * index + 1]);
    write_values(shape, &position, text);
}

static bool same_units(degree_units a, degree_units b)
{
    return a.longitude == b.longitude && a.latitude == b.latitude;
}

/// Write a curve as an array of positions; a closed one repeats the first. Those that rounding makes equal are left out.
static void write_curve(const geojson_shape *shape, const geojson_style *style, const globe_curve *curve, text_buffer *text)
{
    bool merges = style->globe && shape->value_count == 0 && !style->located;
    const degree_units *shown = curve->shown;
    const char *separator = "[";
    size_t end = curve->count;
    while (merges && curve->closed && end > 1 && same_units(shown[end - 1], shown[0]))
        end--;
    for (size_t i = 0; i < end + curve->closed; i++)
    {
        if (merges && i > 0 && i < end && same_units(shown[i], shown[i - 1]))
            continue;
        text_append_string(text, separator);
        write_curve_position(shape, style, curve, i < end ? i : 0, i > 0 ? i - 1 : i, text);
        separator = ",";
    }
    text_append_string(text, "]");
}

/// Write a piece as an array of positions; a ring repeats the first.
static void write_piece(const geojson_shape *shape, const geojson_style *style, const globe_lines *lines, size_t line,
                        bool ring, text_buffer *text)
{
    const char *separator = "[";
    size_t begin = globe_line_begin(lines, line), end = lines->ends[line];
    for (size_t i = begin; i < end + ring; i++)
    {
        const globe_position *position = &lines->positions[i < end ? i : begin];
        bool inside = i > begin && i < end && shape->value_count == 0 && !style->located;
        if (inside && same_units(position->shown, lines->positions[i - 1].shown))
            continue;
        text_append_string(text, separator);
        if (i > begin && geojson_turns_at_pole(style, lines->positions[i - 1].shown, position->shown))
        {
            globe_position turned = lines->positions[i - 1];
            turned.shown.longitude = position->shown.longitude;
            write_position(shape, style, &turned, text);
            text_append_string(text, ",");
        }
        write_position(shape, style, position, text);
        separator = ",";
    }
    text_append_string(text, "]");
}

/// Write line or ring `index` of the curves or of their pieces.
static void write_part(const geojson_shape *shape, const geojson_style *style, size_t index, text_buffer *text)
{
    if (!shape->cut)
        write_curve(shape, style, &shape->curves[index], text);
    else if (shape->polygons == NULL)
        write_piece(shape, style, &shape->pieces, index, false, text);
    else
        write_piece(shape, style, &shape->parts.rings, index, true, text);
}

static void write_parts(const geojson_shape *shape, const geojson_style *style, size_t first, size_t count,
                        text_buffer *text)
{
    text_append_string(text, "[");
    for (size_t i = 0; i < count; i++)
    {
        text_append_string(text, i > 0 ? "," : "");
        write_part(shape, style, first + i, text);
    }
    text_append_string(text, "]");
}

void geojson_shape_write(const geojson_shape *shape, const geojson_style *style, text_buffer *text)
{
    bool multiple = strncmp(shape->type, "Multi", 5) == 0;
    if (shape->polygons == NULL)
    {
        size_t count = shape->cut ? shape->pieces.count : shape->curve_count;
        if (multiple)
            write_parts(shape, style, 0, count, text);
        else
            write_part(shape, style, 0, text);
        return;
    }
    size_t polygons = shape->cut ? shape->parts.count : shape->polygon_count;
    text_append_string(text, multiple ? "[" : "");
    for (size_t i = 0, first = 0, rings; i < polygons; i++, first += rings)
    {
        text_append_string(text, i > 0 ? "," : "");
        rings = shape->cut ? shape->parts.ring_counts[i] : shape->polygons[i].rings;
        write_parts(shape, style, first, rings, text);
    }
    text_append_string(text, multiple ? "]" : "");
}

/// The value of a position of a piece.
static void write_piece_value(const geojson_shape *shape, const globe_position *position, geojson_value_writer *write,
                              const void *context, text_buffer *text)
{
    size_t i = 0;
    while (i + 1 < shape->curve_count &&
           !(position->values >= shape->curves[i].values &&
             position->values < shape->curves[i].values + shape->curves[i].count * shape->curves[i].value_stride))
        i++;
    const globe_curve *curve = &shape->curves[i];
    write(context, i, (size_t)(position->values - curve->values) / curve->value_stride, position->share, text);
}

void geojson_shape_values(const geojson_shape *shape, geojson_value_writer *write, const void *context, text_buffer *text)
{
    bool multiple = strncmp(shape->type, "Multi", 5) == 0;
    size_t lines = shape->cut ? shape->pieces.count : shape->curve_count;
    text_append_string(text, multiple ? "[" : "");
    for (size_t line = 0; line < lines; line++)
    {
        const globe_curve *curve = &shape->curves[shape->cut ? 0 : line];
        size_t begin = shape->cut ? globe_line_begin(&shape->pieces, line) : 0;
        size_t end = shape->cut ? shape->pieces.ends[line] : curve->count + curve->closed;
        for (size_t i = begin; i < end; i++)
        {
            text_append_string(text, i > begin ? "," : line > 0 ? ",[" : "[");
            if (shape->cut)
                write_piece_value(shape, &shape->pieces.positions[i], write, context, text);
            else
                write(context, line, i < curve->count ? i : 0, 0, text);
        }
        text_append_string(text, "]");
    }
    text_append_string(text, multiple ? "]" : "");
}

void geojson_shape_free(geojson_shape *shape)
{
    free(shape->curves);
    free(shape->shown);
    free(shape->kept);
    globe_lines_free(&shape->pieces);
    globe_polygons_free(&shape->parts);
    *shape = (geojson_shape){0};
}
