#include "io/curve/gpx.h"

#include "io/gis/gis.h"
#include "linalg/vector.h"

/// @file
/// Writer of GPX: a file of GPX again, or a new one.

typedef struct gpx_writer
{
    const bat_curve_set *set;
    int decimals;
    text_sink *sink;
    text_buffer text;
    text_buffer open, value; ///< the start tags of the open elements in a point; a value
    text_buffer lines;       ///< of a new file: the tracks, which follow the waypoints
    bool flat;               ///< the third number of a position is a measure
    bat_error *error;
} gpx_writer;

/// Write what there is when it is much.
static bat_status flush(gpx_writer *writer, bool all)
{
    static const int MUCH = 1 << 20;
    if (writer->text.failed || writer->open.failed || writer->value.failed)
        return error_memory(writer->error, writer->text.size);
    if (!all && writer->text.size < MUCH)
        return BAT_OK;
    bat_status status = sink_write(writer->sink, &writer->text, writer->error);
    writer->text.size = 0;
    return status;
}

/// Append a text with references in place of the characters that XML gives a meaning. Control characters are left out.
static void append_escaped(text_buffer *text, const char *begin, const char *end)
{
    for (; begin < end; begin++)
    {
        const char *reference = *begin == '&'   ? "&amp;"
                                : *begin == '<' ? "&lt;"
                                : *begin == '>' ? "&gt;"
                                : *begin == '"' ? "&quot;"
                                                : NULL;
        if (reference != NULL)
            text_append_string(text, reference);
        else if ((unsigned char)*begin >= ' ' || strchr("\t\r\n", *begin) != NULL)
            text_append(text, begin, 1);
    }
}

/// Append `<trkpt lat="1" lon="2`, up to the last quote. False for a point that is not finite.
static bool append_point(gpx_writer *writer, const char *name, size_t size, const double *point)
{
    text_buffer *text = &writer->text;
    size_t dim = writer->set->space->point_dim;
    if (!vector_is_finite(dim, point))
        return false;
    text_append_string(text, "<");
    text_append(text, name, size);
    if (dim == 2)
    {
        text_append_real(text, " lat=\"", point[1]);
        text_append_real(text, "\" lon=\"", point[0]);
        return true;
    }
    degree_units shown = degrees_of_point(point, degree_units_per_radian(writer->decimals));
    text_append_fixed(text, " lat=\"", shown.latitude, writer->decimals);
    text_append_fixed(text, "\" lon=\"", shown.longitude, writer->decimals);
    return true;
}

static void append_end(text_buffer *text, const char *name, size_t size)
{
    text_append_string(text, "</");
    text_append(text, name, size);
    text_append_string(text, ">");
}

/// The end of the start tag that begins a text.
static const char *tag_end(const char *at, const char *end)
{
    char quote = '\0';
    for (; at < end && (quote != '\0' || *at != '>'); at++)
        quote = quote != '\0' ? (*at == quote ? '\0' : quote) : *at == '"' || *at == '\'' ? *at : '\0';
    return at < end ? at + 1 : end;
}

/// Close the open elements behind the first `kept` bytes of their start tags.
static void close_tags(gpx_writer *writer, size_t kept)
{
    while (writer->open.size > kept)
    {
        const char *at = writer->open.data + kept, *end = writer->open.data + writer->open.size, *last = at;
        for (const char *next = at; next < end; next = tag_end(next, end))
            last = next;
        append_end(&writer->text, last + 1, gpx_name_size(last, end));
        writer->open.size = (size_t)(last - writer->open.data);
    }
}

/// Open the elements around a column, and close others.
static void open_tags(gpx_writer *writer, const char *parents, size_t size)
{
    const text_buffer *open = &writer->open;
    size_t kept = 0;
    while (kept < open->size)
    {
        const char *at = open->data + kept;
        size_t length = (size_t)(tag_end(at, open->data + open->size) - at);
        if (length > size - kept || memcmp(parents + kept, at, length) != 0)
            break;
        kept += length;
    }
    close_tags(writer, kept);
    text_append(&writer->text, parents + kept, size - kept);
    text_append(&writer->open, parents + kept, size - kept);
}

/// Append the values of a new point.
static void append_between(gpx_writer *writer, const gpx_source *source, gpx_place place, const double *altitude)
{
    for (size_t i = 0; i < source->column_count; i++)
    {
        const gpx_column *column = &source->columns[i];
        writer->value.size = 0;
        if (i == source->altitude && altitude != NULL)
            gpx_number_write(column, *altitude, &writer->value);
        else if (!gpx_value_write(source, i, place, &writer->value))
            continue;
        const char *tags = source->tags.data, *tag = tags + column->tag.begin, *end = tags + column->tag.end;
        open_tags(writer, tags + column->parents.begin, column->parents.end - column->parents.begin);
        text_append(&writer->text, tag, (size_t)(end - tag));
        append_escaped(&writer->text, writer->value.data, writer->value.data + writer->value.size);
        append_end(&writer->text, tag + 1, gpx_name_size(tag, end));
    }
    close_tags(writer, 0);
}

/// Append the element of a point, with the content of a row, or with values between rows.
static bool append_row(gpx_writer *writer, const gpx_source *source, const gpx_curve *curve, const double *point,
                       gpx_place place, const double *altitude)
{
    const char *tags = source->tags.data, *name = tags + curve->tag.begin;
    size_t size = curve->tag.end - curve->tag.begin;
    text_append(&writer->text, tags + curve->indent.begin, curve->indent.end - curve->indent.begin);
    if (!append_point(writer, name, size, point))
        return false;
    text_append_string(&writer->text, "\">");
    size_t begin = writer->text.size, content = source->rows[place.from].content;
    size_t content_size = source->rows[place.from + 1].content - content;
    if (place.share > 0)
        append_between(writer, source, place, altitude);
    else if (content_size > 0)
        text_append(&writer->text, source->contents.data + content, content_size);
    if (writer->text.size == begin && begin > 0)
    {
        writer->text.size--;
        text_append_string(&writer->text, "/>");
    }
    else
        append_end(&writer->text, name, size);
    return true;
}

/// Append the points of a curve: those of the file with all that they had, the others with values between.
static bat_status append_curve(gpx_writer *writer, const gpx_source *source, size_t index)
{
    const bat_curve *fine = &writer->set->curves[index];
    const gpx_curve *curve = &source->curves[index];
    size_t dim = fine->space->point_dim, last = curve->row + curve->row_count - 1;
    double *places = memory_array(fine->count, sizeof *places);
    if (places == NULL)
        return error_memory(writer->error, fine->count * sizeof *places);
    cells_places(&writer->set->attributes->csv->cells, fine, index, places);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < fine->count && status == BAT_OK; i++)
    {
        const double *point = fine->points + i * dim;
        const double *altitude = fine->channel_count > CSV_PLACE_CHANNELS ? fine->channels + i * fine->channel_count : NULL;
        gpx_place place = gpx_place_of(source, index, places[i]), after = gpx_place_of(source, index, places[i] + 0.5);
        bool done = append_row(writer, source, curve, point, place, altitude);
        // Rows that repeat this one.
        for (size_t row = place.from + 1; place.share == 0 && row <= after.from && done; row++)
            done = append_row(writer, source, curve, point, (gpx_place){row, row, 0}, NULL);
        status = done ? flush(writer, false)
                      : error_set(writer->error, BAT_INVALID_POINT, i, 0, "point %zu of curve %zu is not finite", i, index);
    }
    // A last row of the file, or what values the first row has.
    gpx_place end = curve->returning ? (gpx_place){last, last, 0} : (gpx_place){curve->row, curve->row, 1};
    if (status == BAT_OK && fine->closed)
        (void)append_row(writer, source, curve, fine->points, end, NULL);
    free(places);
    return status;
}

/// Make a box contain the longitudes and latitudes of a curve. Longitudes stay where it crosses the antimeridian.
static void grow_box(const bat_curve *curve, int decimals, double box[4])
{
    static const double HALF_TURN = 180;
    double units = degree_units_per_radian(decimals), unit = (double)degree_units_per_degree(decimals), grown[4], before = 0;
    bool cut = box[0] > box[2];
    memcpy(grown, box, sizeof grown);
    for (size_t i = 0; i < curve->count; i++)
    {
        const double *point = curve->points + i * curve->space->point_dim;
        degree_units shown = curve->space->point_dim == 3 ? degrees_of_point(point, units) : (degree_units){0, 0};
        double x = curve->space->point_dim == 3 ? (double)shown.longitude / unit : point[0];
        double y = curve->space->point_dim == 3 ? (double)shown.latitude / unit : point[1];
        cut = cut || (i > 0 && fabs(x - before) > HALF_TURN);
        grown[0] = fmin(grown[0], x);
        grown[1] = fmin(grown[1], y);
        grown[2] = fmax(grown[2], x);
        grown[3] = fmax(grown[3], y);
        before = x;
    }
    box[1] = grown[1];
    box[3] = grown[3];
    box[0] = cut ? box[0] : grown[0];
    box[2] = cut ? box[2] : grown[2];
}

/// Write the file that the set is from, with its refined points.
static bat_status write_again(gpx_writer *writer, const gpx_source *source)
{
    size_t at = source->bounds.end;
    bat_status status = BAT_OK;
    text_append(&writer->text, source->frame.data, source->bounds.begin);
    if (at > 0)
    {
        static const char *const names[] = {" minlon=\"", " minlat=\"", " maxlon=\"", " maxlat=\""};
        const char *tag = source->frame.data + source->bounds.begin, *end = source->frame.data + source->bounds.end;
        double box[4];
        memcpy(box, source->box, sizeof box);
        for (size_t i = 0; i < writer->set->count; i++)
            grow_box(&writer->set->curves[i], writer->decimals, box);
        text_append(&writer->text, tag, 1 + gpx_name_size(tag, end));
        for (size_t i = 0; i < 4; i++)
        {
            text_append_real(&writer->text, names[i], box[i]);
            text_append_string(&writer->text, "\"");
        }
        text_append_string(&writer->text, end[-2] == '/' ? "/>" : ">");
    }
    for (size_t i = 0; i < source->curve_count && status == BAT_OK; i++)
    {
        text_append(&writer->text, source->frame.data + at, source->curves[i].frame - at);
        at = source->curves[i].frame;
        status = append_curve(writer, source, i);
    }
    text_append(&writer->text, source->frame.data + at, source->frame.size - at);
    return status;
}

// New files.

/// The members of GPX that are properties, in the order of the schema. Others are extensions, as GDAL writes them.
static const char *const MEMBERS[] = {"time",   "magvar", "geoidheight", "name", "cmt", "desc", "src",  "link",
                                      "number", "sym",    "type",        "fix",  "sat", "hdop", "vdop", "pdop"};
static const int MEMBER_COUNT = sizeof MEMBERS / sizeof *MEMBERS;

static bool is_member(const char *name, bool waypoint)
{
    bool number = strcmp(name, "number") == 0;
    for (size_t i = 0; i < MEMBER_COUNT; i++)
        if (strcmp(MEMBERS[i], name) == 0)
        {
            bool of_both = (i >= 3 && i <= 7) || strcmp(name, "type") == 0;
            return of_both || number == !waypoint;
        }
    return false;
}

/// Append a value as the text of an element.
static void append_value(text_buffer *text, const json_t *value)
{
    text_buffer tree = {0};
    if (json_is_string(value))
    {
        append_escaped(text, json_string_value(value), json_string_value(value) + json_string_length(value));
        return;
    }
    json_text(&tree, value);
    append_escaped(text, tree.data, tree.data + tree.size);
    text_free(&tree);
}

/// Append a tag that begins with `before`; characters that names of XML lack become underscores.
static void append_tag(text_buffer *text, const char *before, const char *name)
{
    text_append_string(text, before);
    for (const char *at = name; *at != '\0'; at++)
    {
        bool letter = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') || (unsigned char)*at >= 0x80;
        bool inner = at > name && ((*at >= '0' && *at <= '9') || *at == '-' || *at == '.');
        text_append(text, letter || inner ? at : "_", 1);
    }
    text_append_string(text, name[0] == '\0' ? "_>" : ">");
}

static void append_extension(text_buffer *text, const char *name, const json_t *value)
{
    append_tag(text, "<ogr:", name);
    append_value(text, value);
    append_tag(text, "</ogr:", name);
}

/// Append the properties of a feature, those that GPX has no element for as extensions.
static void append_properties(text_buffer *text, const json_t *feature, bool waypoint)
{
    json_t *properties = json_object_get(feature, "properties"), *value;
    const char *name;
    for (size_t i = 0; i < MEMBER_COUNT; i++)
    {
        value = json_object_get(properties, MEMBERS[i]);
        if (value == NULL || json_is_null(value) || !is_member(MEMBERS[i], waypoint))
            continue;
        bool link = strcmp(MEMBERS[i], "link") == 0;
        TEXT_APPEND(text, "<", MEMBERS[i], link ? " href=\"" : ">");
        append_value(text, value);
        TEXT_APPEND(text, link ? "\"/>" : "</", link ? "" : MEMBERS[i], link ? "" : ">");
    }
    const json_t *id = json_object_get(properties, "id") == NULL ? json_object_get(feature, "id") : NULL;
    size_t begin = text->size;
    text_append_string(text, "<extensions>");
    size_t empty = text->size;
    if (id != NULL)
        append_extension(text, "id", id);
    json_object_foreach(properties, name, value)
    {
        bool of_points = strcmp(name, "coordinateProperties") == 0 || strcmp(name, "coordTimes") == 0;
        if (!is_member(name, waypoint) && !json_is_null(value) && !of_points)
            append_extension(text, name, value);
    }
    if (text->size == empty)
        text->size = begin;
    else
        text_append_string(text, "</extensions>\n");
}

/// Append the start tag of a position of GeoJSON, and its altitude.
static void append_position(text_buffer *text, const char *name, const json_t *position, bool flat)
{
    const json_t *altitude = flat ? NULL : json_array_get(position, 2);
    TEXT_APPEND(text, "<", name);
    text_append_real(text, " lat=\"", json_number_value(json_array_get(position, 1)));
    text_append_real(text, "\" lon=\"", json_number_value(json_array_get(position, 0)));
    text_append_string(text, "\">");
    if (altitude == NULL)
        return;
    text_append_real(text, "<ele>", json_number_value(altitude));
    text_append_string(text, "</ele>");
}

/// The value of a point among those that a property has for a line of a feature; null for none.
static const json_t *value_of_point(const json_t *values, const json_t *positions, size_t line, size_t point)
{
    const json_t *of_line = json_is_array(json_array_get(values, 0)) ? json_array_get(values, line) : values;
    bool fits = json_array_size(of_line) == json_array_size(positions);
    const json_t *value = fits ? json_array_get(of_line, point) : NULL;
    return json_is_null(value) ? NULL : value;
}

/// Append the values that togeojson has for a point: its time, and others as extensions.
static void append_point_values(text_buffer *text, const json_t *feature, const json_t *positions, size_t line, size_t point)
{
    const json_t *properties = json_object_get(feature, "properties");
    json_t *all = json_object_get(properties, "coordinateProperties"), *values;
    const json_t *times = json_object_get(all, "times");
    const json_t *time =
        value_of_point(times != NULL ? times : json_object_get(properties, "coordTimes"), positions, line, point);
    const char *name;
    if (time != NULL)
    {
        text_append_string(text, "<time>");
        append_value(text, time);
        text_append_string(text, "</time>");
    }
    size_t begin = text->size;
    text_append_string(text, "<extensions>");
    size_t empty = text->size;
    json_object_foreach(all, name, values)
    {
        const json_t *value = values != times ? value_of_point(values, positions, line, point) : NULL;
        if (value != NULL)
            append_extension(text, name, value);
    }
    if (text->size == empty)
        text->size = begin;
    else
        text_append_string(text, "</extensions>");
}

static void append_segment(text_buffer *text, const json_t *feature, const json_t *positions, size_t line, bool flat)
{
    text_append_string(text, "<trkseg>\n");
    for (size_t i = 0; i < json_array_size(positions); i++)
    {
        append_position(text, "trkpt", json_array_get(positions, i), flat);
        append_point_values(text, feature, positions, line, i);
        text_append_string(text, "</trkpt>\n");
    }
    text_append_string(text, "</trkseg>\n");
}

static void append_waypoint(gpx_writer *writer, const json_t *feature, const json_t *position)
{
    if (json_array_size(position) == 0)
        return;
    append_position(&writer->text, "wpt", position, writer->flat);
    append_properties(&writer->text, feature, true);
    text_append_string(&writer->text, "</wpt>\n");
}

/// Append a geometry: points as waypoints, lines as a track.
static bat_status append_geometry(gpx_writer *writer, const json_t *feature, const json_t *geometry, size_t index)
{
    const json_t *parts = json_object_get(geometry, "coordinates"), *members = json_object_get(geometry, "geometries");
    geometry_kind kind = geojson_kind(geometry);
    bat_status status = BAT_OK;
    text_buffer *lines = &writer->lines;
    if (kind == GEOMETRY_POLYGON || kind == GEOMETRY_POLYGONS)
        return error_set(writer->error, BAT_UNSUPPORTED, index, 0,
                         "feature %zu: GPX holds lines and points, but no polygons", index);
    if (kind == GEOMETRY_POINT)
        append_waypoint(writer, feature, parts);
    for (size_t i = 0; kind == GEOMETRY_POINTS && i < json_array_size(parts); i++)
        append_waypoint(writer, feature, json_array_get(parts, i));
    if (kind == GEOMETRY_LINE || kind == GEOMETRY_LINES)
    {
        text_append_string(lines, "<trk>");
        append_properties(lines, feature, false);
        if (kind == GEOMETRY_LINE)
            append_segment(lines, feature, parts, 0, writer->flat);
        for (size_t i = 0; kind == GEOMETRY_LINES && i < json_array_size(parts); i++)
            append_segment(lines, feature, json_array_get(parts, i), i, writer->flat);
        text_append_string(lines, "</trk>\n");
    }
    for (size_t i = 0; i < json_array_size(members) && status == BAT_OK; i++)
        status = append_geometry(writer, feature, json_array_get(members, i), index);
    return status;
}

static bat_status take_feature(void *context, size_t index, const json_t *feature, bat_error *error BAT_UNUSED)
{
    gpx_writer *writer = context;
    const json_t *geometry = geojson_has_type(feature, "Feature") ? json_object_get(feature, "geometry") : feature;
    bat_status status = append_geometry(writer, feature, geometry, index);
    return status == BAT_OK ? flush(writer, false) : status;
}

/// Append the cells of a row of a table, but for the altitude: its time, and others as extensions.
static void append_cells(gpx_writer *writer, const bat_curve *curve, size_t index, size_t point, double place)
{
    const csv_columns *csv = writer->set->attributes->csv;
    text_buffer *text = &writer->text, *value = &writer->value, *open = &writer->open;
    size_t cell = 0;
    bool timed = false;
    open->size = 0;
    for (size_t i = 0; i < csv->count; i++)
    {
        csv_kind kind = csv->kinds != NULL ? (csv_kind)csv->kinds[i] : CSV_NUMBER;
        size_t number = csv->places != NULL ? csv->places[i] : i, of_cell = cell;
        cell += kind == CSV_NUMBER || kind == CSV_ID ? 0 : 1;
        value->size = 0;
        bool channel = kind == CSV_NUMBER || kind == CSV_CLOCK;
        if (channel && number >= 2 && number - 2 != csv->altitude)
            text_append_real(value, "", curve->channels[point * curve->channel_count + number - 2]);
        else if (!channel && kind != CSV_ID)
            cells_write(&csv->cells, kind, of_cell, index, place, value);
        text_append(value, "", 1);
        csv_field field = value->failed ? (csv_field){"", ""} : csv_text(value->data);
        if (field.begin == field.end)
            continue;
        bool time = kind == CSV_TIME && !timed;
        timed = timed || time;
        const char *name = time ? "time" : csv->names != NULL ? csv->names[i] : "";
        append_tag(time ? text : open, time ? "<" : "<ogr:", name);
        append_escaped(time ? text : open, field.begin, field.end);
        append_tag(time ? text : open, time ? "</" : "</ogr:", name);
    }
    if (open->size == 0)
        return;
    text_append_string(text, "<extensions>");
    text_append(text, open->data, open->size);
    text_append_string(text, "</extensions>");
}

/// Append a curve of a table as a track.
static bat_status append_table_curve(gpx_writer *writer, size_t index)
{
    const bat_curve *curve = &writer->set->curves[index];
    const csv_columns *csv = writer->set->attributes->csv;
    size_t dim = curve->space->point_dim;
    double *places = memory_array(curve->count, sizeof *places);
    bat_status status = places != NULL ? BAT_OK : error_memory(writer->error, curve->count * sizeof *places);
    if (places != NULL && csv->has_places)
        cells_places(&csv->cells, curve, index, places);
    text_append_string(&writer->text, "<trk><trkseg>\n");
    for (size_t i = 0; i < curve->count + curve->closed && status == BAT_OK; i++)
    {
        size_t point = i < curve->count ? i : 0;
        if (!append_point(writer, "trkpt", strlen("trkpt"), curve->points + point * dim))
            status =
                error_set(writer->error, BAT_INVALID_POINT, point, 0, "point %zu of curve %zu is not finite", point, index);
        text_append_string(&writer->text, "\">");
        if (csv->altitude < curve->channel_count)
        {
            text_append_real(&writer->text, "<ele>", curve->channels[point * curve->channel_count + csv->altitude]);
            text_append_string(&writer->text, "</ele>");
        }
        append_cells(writer, curve, index, point, csv->has_places ? places[point] : 0);
        text_append_string(&writer->text, "</trkpt>\n");
        status = status == BAT_OK ? flush(writer, false) : status;
    }
    text_append_string(&writer->text, "</trkseg></trk>\n");
    free(places);
    return status;
}

/// Write a new file.
static bat_status write_new(gpx_writer *writer)
{
    static const char begin[] = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"batten\" "
                                "xmlns=\"http://www.topografix.com/GPX/1/1\" xmlns:ogr=\"http://osgeo.org/gdal\">\n";
    const bat_curve_attributes *attributes = writer->set->attributes;
    bool table = attributes != NULL && !attributes_are_geojson(attributes) && attributes->csv != NULL && attributes->degrees;
    bat_status status = BAT_OK;
    text_append_string(&writer->text, begin);
    for (size_t i = 0; table && i < writer->set->count && status == BAT_OK; i++)
        status = append_table_curve(writer, i);
    if (!table)
        status = geojson_each(writer->set, NULL, writer->decimals, take_feature, writer, writer->error);
    if (writer->lines.failed)
        status = error_memory(writer->error, writer->lines.size);
    text_append(&writer->text, writer->lines.data, writer->lines.size);
    text_append_string(&writer->text, "</gpx>\n");
    return status;
}

bat_status gpx_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    const bat_curve_attributes *attributes = set->attributes;
    bool same = attributes != NULL && attributes->format == BAT_CURVE_FORMAT_GPX, globe = set->space->point_dim == 3;
    const char *crs = options->crs != NULL ? options->crs : attributes != NULL ? attributes->crs : NULL;
    bat_curve_set moved = {0};
    if (!same && (globe ? strcmp(set->space->name, "sphere") != 0 : crs == NULL || set->space->point_dim != 2))
        return ERROR_UNSUPPORTED(
            error, 0, "GPX holds longitude and latitude, but the curves lie in the space %s without a coordinate system",
            set->space->name);
    bool shifts = !same && crs != NULL && !(globe && crs_is_geographic(crs));
    bat_status status = shifts ? gis_transform(set, crs, GIS_WGS84, &moved, error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    gpx_writer writer = {
        .set = moved.curves != NULL ? &moved : set, .decimals = options->precision, .sink = sink, .error = error};
    const geojson_document *document = attributes_are_geojson(attributes) ? attributes->remainder.content : NULL;
    writer.flat = document != NULL && document->measures;
    const gpx_source *source = same && document != NULL ? document->gpx : NULL;
    status = source != NULL ? write_again(&writer, source) : write_new(&writer);
    if (status == BAT_OK)
        status = flush(&writer, true);
    text_free(&writer.text);
    text_free(&writer.open);
    text_free(&writer.value);
    text_free(&writer.lines);
    bat_curve_set_free(&moved);
    return status;
}
