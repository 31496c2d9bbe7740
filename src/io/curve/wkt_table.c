#include "io/curve/wkt.h"

#include "io/curve/csv.h"

#include <inttypes.h>

/// @file
/// Tables with a column of well-known text or binary, as geographic information systems and databases write them. The other
/// columns are the properties of features. Fields in quotes may contain separators and line breaks.

typedef struct table_field
{
    const char *begin, *end; ///< within the quotes
    bool quoted;
} table_field;

/// A position in a table.
typedef struct table_scan
{
    const char *at, *end;
    char separator;
    table_field *fields; ///< of the last row
    size_t count, capacity;
    bool failed; ///< out of memory
} table_scan;

static table_scan table_start(const file_text *text)
{
    text_line line = text_line_start(text);
    char separator = ' ';
    while (separator == ' ' && text_line_next(text, &line) && line.begin == line.end)
        continue;
    if (line.number > 0)
        separator = csv_find_separator(&line);
    return (table_scan){.at = text->data, .end = text->data + text->size, .separator = separator == ' ' ? ',' : separator};
}

/// Advance behind a field.
static table_field next_field(table_scan *scan)
{
    while (scan->at < scan->end && *scan->at == ' ')
        scan->at++;
    table_field field = {.begin = scan->at, .quoted = scan->at < scan->end && *scan->at == '"'};
    if (field.quoted)
    {
        field.begin = ++scan->at;
        while (scan->at < scan->end && (*scan->at != '"' || (scan->at + 1 < scan->end && scan->at[1] == '"')))
            scan->at += *scan->at == '"' ? 2 : 1;
        field.end = scan->at;
    }
    while (!(scan->at == scan->end || *scan->at == '\n' || *scan->at == '\r') && *scan->at != scan->separator)
        scan->at++;
    if (field.quoted)
        return field;
    csv_field inner = csv_trimmed(field.begin, scan->at);
    return (table_field){inner.begin, inner.end, false};
}

/// Read the next row that is not blank; false at the end, or when out of memory.
static bool next_row(table_scan *scan)
{
    while (scan->at < scan->end && (*scan->at == '\n' || *scan->at == '\r'))
        scan->at++;
    scan->count = 0;
    if (scan->at == scan->end)
        return false;
    for (bool more = true; more;)
    {
        table_field field = next_field(scan);
        scan->failed = !ARRAY_ADD(scan->fields, scan->capacity, scan->count, field);
        if (scan->failed)
            return false;
        more = scan->at < scan->end && *scan->at == scan->separator;
        scan->at += more;
    }
    return true;
}

/// Find the column of geometries in the first rows; BAT_NO_INDEX for none.
static bat_status find_column(const file_text *text, size_t *column, bool *named, bat_error *error)
{
    static const int FIRST_ROWS = 50;
    table_scan scan = table_start(text);
    *column = BAT_NO_INDEX;
    *named = false;
    for (size_t row = 0; row < FIRST_ROWS && *column == BAT_NO_INDEX && next_row(&scan); row++)
    {
        *named = row > 0;
        for (size_t i = 0; i < scan.count && *column == BAT_NO_INDEX; i++)
            if (wkt_begins(scan.fields[i].begin, scan.fields[i].end) || wkb_begins(scan.fields[i].begin, scan.fields[i].end))
                *column = i;
    }
    bat_status status = scan.failed ? error_memory(error, scan.count * sizeof *scan.fields) : BAT_OK;
    free(scan.fields);
    return status;
}

bat_status wkt_is_table(const file_text *text, bool *is_table, bat_error *error)
{
    bool named;
    size_t column;
    bat_status status = find_column(text, &column, &named, error);
    *is_table = column != BAT_NO_INDEX;
    return status;
}

typedef struct table_reader
{
    table_scan scan;
    wkt_scanner wkt;
    text_buffer geojson;
    table_field *names; ///< null for a table without them
    char *column;       ///< the name of the column of geometries
    size_t count, place;
    unsigned char *numbers; ///< whether each column holds numbers
    const char *counted;
} table_reader;

/// Append the text of a field as a string of JSON.
static void append_string(text_buffer *text, const table_field *field)
{
    text_buffer plain = {0};
    for (const char *at = field->begin; at < field->end; at++)
    {
        text_append(&plain, at, 1);
        at += field->quoted && *at == '"' ? 1 : 0; // the second of two
    }
    json_text_string(text, plain.size > 0 ? plain.data : "", plain.size);
    text->failed = text->failed || plain.failed;
    text_free(&plain);
}

/// Whether a text is a number that comes back as the same text.
static bool is_number(const table_field *field)
{
    char again[NUMBER_TEXT_SIZE];
    int64_t whole;
    double value;
    const char *stop = again;
    size_t size = (size_t)(field->end - field->begin);
    if (csv_read_whole((csv_field){field->begin, field->end}, INT64_DIGITS, &whole))
        stop += snprintf(again, sizeof again, "%" PRId64, whole);
    else if (number_read(field->begin, field->end, &value) == NULL)
        stop = number_write(again, value);
    return size > 0 && !field->quoted && (size_t)(stop - again) == size && memcmp(again, field->begin, size) == 0;
}

/// Find the columns whose cells are numbers or empty.
static bat_status find_numbers(table_reader *reader, bool named)
{
    table_scan *scan = &reader->scan;
    const char *begin = scan->at;
    bat_status status = BAT_OK;
    for (size_t row = 0; status == BAT_OK && next_row(scan); row++)
    {
        if (row == 0)
        {
            reader->count = scan->count;
            status = array_make(&reader->numbers, scan->count, 1, reader->wkt.error);
            if (status == BAT_OK)
                memset(reader->numbers, 1, scan->count);
        }
        for (size_t i = 0; i < scan->count && i < reader->count && status == BAT_OK && !(row == 0 && named); i++)
            if (scan->fields[i].quoted || scan->fields[i].begin < scan->fields[i].end)
                reader->numbers[i] = reader->numbers[i] && is_number(&scan->fields[i]);
    }
    if (status == BAT_OK && scan->failed)
        status = error_memory(reader->wkt.error, scan->capacity * sizeof *scan->fields);
    scan->at = begin;
    return status;
}

static void append_value(text_buffer *text, const table_field *field, bool number)
{
    size_t size = (size_t)(field->end - field->begin);
    if (!field->quoted && size == 0)
        text_append_string(text, "null");
    else if (number)
        text_append(text, field->begin, size);
    else
        append_string(text, field);
}

/// Append the name of a column, or its number from 1.
static void append_name(const table_reader *reader, size_t column, text_buffer *text)
{
    char name[32];
    if (reader->names != NULL)
    {
        append_string(text, &reader->names[column]);
        return;
    }
    (void)snprintf(name, sizeof name, "\"column%zu\"", column + 1);
    text_append_string(text, name);
}

static bat_status read_row(table_reader *reader)
{
    text_buffer *geojson = &reader->geojson;
    const table_scan *scan = &reader->scan;
    const table_field *geometry = &scan->fields[reader->place];
    const char *separator = "";
    geojson_made_pad(scan->fields[0].begin, &reader->counted, geojson);
    text_append_string(geojson, "{\"type\":\"Feature\",\"properties\":{");
    for (size_t i = 0; i < scan->count; i++)
    {
        if (i == reader->place)
            continue;
        text_append_string(geojson, separator);
        append_name(reader, i, geojson);
        text_append_string(geojson, ":");
        append_value(geojson, &scan->fields[i], reader->numbers[i] != 0);
        separator = ",";
    }
    text_append_string(geojson, "},\"geometry\":");
    bat_status status = BAT_OK;
    reader->wkt.at = geometry->begin;
    reader->wkt.end = geometry->end;
    if (geometry->begin == geometry->end)
        text_append_string(geojson, "null");
    else
        status = wkb_begins(geometry->begin, geometry->end) ? wkb_scan_geometry(&reader->wkt, geojson)
                                                            : wkt_scan_geometry(&reader->wkt, geojson);
    if (status == BAT_OK && csv_trimmed(reader->wkt.at, reader->wkt.end).begin != reader->wkt.end)
        status = wkt_fault(&reader->wkt, "the geometry has ended here");
    text_append_string(geojson, "}");
    return status;
}

/// Keep the names of the first row. Two of one name are refused.
static bat_status take_names(table_reader *reader)
{
    const table_scan *scan = &reader->scan;
    const table_field *names = scan->fields;
    for (size_t i = 0; i < scan->count; i++)
        for (size_t k = 0; k < i; k++)
        {
            size_t size = (size_t)(names[i].end - names[i].begin);
            reader->wkt.at = names[i].begin;
            if (size == (size_t)(names[k].end - names[k].begin) && memcmp(names[i].begin, names[k].begin, size) == 0)
                return wkt_fault(&reader->wkt, "two columns have the name '%.*s'", (int)(size < 60 ? size : 60),
                                 names[i].begin);
        }
    if (array_make(&reader->names, scan->count, sizeof *names, reader->wkt.error) != BAT_OK)
        return BAT_NO_MEMORY;
    memcpy(reader->names, names, scan->count * sizeof *names);
    if (reader->place >= scan->count)
        return wkt_fault(&reader->wkt, "the first row has no name for the column of geometries");
    const table_field *name = &names[reader->place];
    reader->column = strndup(name->begin, (size_t)(name->end - name->begin));
    return reader->column != NULL ? BAT_OK : error_memory(reader->wkt.error, 1);
}

/// Check that a row has as many fields as the first, all of them text.
static bat_status check_row(table_reader *reader)
{
    const table_scan *scan = &reader->scan;
    reader->wkt.at = scan->fields[0].begin;
    if (scan->count != reader->count)
        return wkt_fault(&reader->wkt, "%zu columns where the first row has %zu", scan->count, reader->count);
    for (size_t i = 0; i < scan->count; i++)
    {
        const char *fault = csv_field_fault((csv_field){scan->fields[i].begin, scan->fields[i].end});
        if (fault != NULL)
            return wkt_fault(&reader->wkt, "field %zu %s", i + 1, fault);
    }
    return BAT_OK;
}

static bat_status read_rows(table_reader *reader, bool named)
{
    bat_status status = find_numbers(reader, named);
    text_append_string(&reader->geojson, GEOJSON_MADE_BEGIN);
    for (size_t row = 0; status == BAT_OK && next_row(&reader->scan); row++)
    {
        text_append_string(&reader->geojson, row > (named ? 1 : 0) ? "," : "");
        status = check_row(reader);
        if (status == BAT_OK)
            status = row == 0 && named ? take_names(reader) : read_row(reader);
    }
    return status == BAT_OK && reader->scan.failed ? error_memory(reader->wkt.error, reader->geojson.size) : status;
}

bat_status wkt_table_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_error unread;
    bool named = false;
    table_reader reader = {
        .scan = table_start(text), .wkt = wkt_scanner_start(text, error != NULL ? error : &unread), .counted = text->data};
    bat_status status = find_column(text, &reader.place, &named, error);
    if (status == BAT_OK && reader.place == BAT_NO_INDEX)
        status = ERROR_FILE(error, 0, "no column of the table has well-known text");
    if (status == BAT_OK)
        status = read_rows(&reader, named);
    if (status == BAT_OK)
        status =
            geojson_made_read(&reader.wkt.made, &reader.geojson, BAT_CURVE_FORMAT_WKT_CSV, options, set, reader.wkt.error);
    if (status == BAT_OK)
    {
        geojson_document *document = set->attributes->remainder.content;
        document->column = reader.column;
        document->column_place = reader.place;
        document->binary = reader.wkt.binary;
        reader.column = NULL;
    }
    free(reader.scan.fields);
    free(reader.names);
    free(reader.numbers);
    free(reader.column);
    text_free(&reader.geojson);
    return status;
}

// Writing.

typedef struct table_writer
{
    const geojson_document *document; ///< null for none
    json_t *names;                    ///< the properties of all features, and "id"
    size_t place;                     ///< of the geometry
    text_buffer text, srid;
    text_buffer geometry; ///< of the feature
    bool measures, binary;
    text_sink *sink;
} table_writer;

/// Append a text as a field, in quotes where it needs them.
static void append_text(text_buffer *text, const char *begin, size_t size)
{
    bool plain = size > 0 && begin[0] != ' ' && begin[size - 1] != ' ';
    for (size_t i = 0; i < size && plain; i++)
        plain = strchr(",;\t\r\n\"", begin[i]) == NULL;
    if (plain)
    {
        text_append(text, begin, size);
        return;
    }
    text_append_string(text, "\"");
    for (size_t i = 0; i < size; i++)
        text_append(text, begin[i] == '"' ? "\"\"" : begin + i, begin[i] == '"' ? 2 : 1);
    text_append_string(text, "\"");
}

static void append_json(text_buffer *text, const json_t *value)
{
    text_buffer tree = {0};
    if (value == NULL || json_is_null(value))
        return;
    if (json_is_string(value))
    {
        append_text(text, json_string_value(value), json_string_length(value));
        return;
    }
    json_text(&tree, value);
    if (json_is_number(value))
        text_append(text, tree.data, tree.size);
    else
        append_text(text, tree.data, tree.size);
    text->failed = text->failed || tree.failed;
    text_free(&tree);
}

static const char ID[] = "id";

/// Append the geometry as the next column where it stands there, or where no other column follows.
static void append_geometry(table_writer *writer, size_t *column, bool last)
{
    const text_buffer *wkt = &writer->geometry;
    if (*column != writer->place && !(last && *column < writer->place))
        return;
    text_append_string(&writer->text, (*column)++ > 0 ? "," : "");
    if (wkt->size > 0)
        append_text(&writer->text, wkt->data, wkt->size);
}

/// Write the row of a feature, or that of the names where it is null, with the text in `geometry`.
static bat_status write_row(table_writer *writer, const json_t *feature, bat_error *error)
{
    const char *name;
    json_t *unused;
    size_t column = 0;
    if (writer->text.failed || writer->geometry.failed)
        return error_memory(error, writer->geometry.size);
    writer->text.size = 0;
    json_object_foreach(writer->names, name, unused)
    {
        const json_t *value = json_object_get(json_object_get(feature, "properties"), name);
        append_geometry(writer, &column, false);
        text_append_string(&writer->text, column++ > 0 ? "," : "");
        if (feature == NULL)
            append_text(&writer->text, name, strlen(name));
        else
            append_json(&writer->text, value == NULL && strcmp(name, ID) == 0 ? json_object_get(feature, ID) : value);
    }
    append_geometry(writer, &column, true);
    text_append_string(&writer->text, "\n");
    return sink_write(writer->sink, &writer->text, error);
}

static bat_status take_feature(void *context, size_t index BAT_UNUSED, const json_t *feature, bat_error *error)
{
    table_writer *writer = context;
    const json_t *geometry = geojson_has_type(feature, "Feature") ? json_object_get(feature, "geometry") : feature;
    text_buffer *wkt = &writer->geometry;
    wkt->size = 0;
    if (!json_is_null(geometry) && writer->binary)
        wkb_append_geometry(geometry, writer->measures, writer->srid.size > 0 ? strchr(writer->srid.data, '=') + 1 : NULL,
                            wkt);
    else if (!json_is_null(geometry))
    {
        text_append(wkt, writer->srid.data, writer->srid.size);
        wkt_append_geometry(geometry, writer->measures, wkt);
    }
    return write_row(writer, feature, error);
}

bat_status wkt_table_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink,
                           bat_error *error)
{
    const bat_curve_attributes *attributes = set->attributes;
    const geojson_document *document = attributes_are_geojson(attributes) ? attributes->remainder.content : NULL;
    bool same = attributes != NULL && attributes->format == BAT_CURVE_FORMAT_WKT_CSV;
    const char *geometry = same ? document->column : "WKT";
    table_writer writer = {.document = document,
                           .names = geojson_property_kinds(document),
                           .place = same ? document->column_place : 0,
                           .measures = document != NULL && document->measures,
                           .binary = same && document->binary,
                           .sink = sink};
    bat_status status = writer.names != NULL ? BAT_OK : error_memory(error, sizeof *writer.names);
    wkt_append_srid(set, options, &writer.srid);
    text_append(&writer.srid, "", 1);
    writer.srid.size -= writer.srid.size > 0;
    text_append_string(&writer.geometry, geometry != NULL ? geometry : "");
    if (status == BAT_OK && geometry != NULL)
        status = write_row(&writer, NULL, error);
    if (status == BAT_OK)
        status = geojson_each(set, options->given, options->precision, take_feature, &writer, error);
    json_decref(writer.names);
    text_free(&writer.text);
    text_free(&writer.srid);
    text_free(&writer.geometry);
    return status;
}
