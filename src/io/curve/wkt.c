#include "io/curve/wkt.h"

#include "io/curve/formats.h"

#include <math.h>
#include <stdarg.h>
#include <strings.h>

/// @file
/// Reader of well-known text.

enum
{
    MAX_DEPTH = 32,  ///< of collections
    MAX_NUMBERS = 4, ///< of a position
    MAX_SRID = 999999
};

/// A type of geometry: its name, its name in GeoJSON, and how deep its positions are in brackets.
static const struct wkt_type
{
    const char *name;
    geometry_kind kind;
    int depth;
} TYPES[] = {{"POINT", GEOMETRY_POINT, 0},
             {"LINESTRING", GEOMETRY_LINE, 1},
             {"LINEARRING", GEOMETRY_LINE, 1},
             {"POLYGON", GEOMETRY_POLYGON, 2},
             {"TRIANGLE", GEOMETRY_POLYGON, 2},
             {"MULTIPOINT", GEOMETRY_POINTS, 1},
             {"MULTILINESTRING", GEOMETRY_LINES, 2},
             {"MULTIPOLYGON", GEOMETRY_POLYGONS, 3},
             {"POLYHEDRALSURFACE", GEOMETRY_POLYGONS, 3},
             {"TIN", GEOMETRY_POLYGONS, 3},
             {"GEOMETRYCOLLECTION", GEOMETRY_COLLECTION, 0}};

/// The geometry that is read.
typedef struct wkt_form
{
    geometry_kind kind;
    bool z, m;      ///< as its name tells
    size_t numbers; ///< of its positions; 0 before the first
} wkt_form;

wkt_scanner wkt_scanner_start(const file_text *text, bat_error *error)
{
    wkt_scanner scan = {
        .at = text->data, .end = text->data + text->size, .text = text, .made = geojson_made_start(), .error = error};
    scan.made.lines = true;
    return scan;
}

bat_status wkt_fault(const wkt_scanner *scan, const char *format, ...)
{
    char what[160];
    size_t line = 1, column = 1;
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    const char *place = scan->place != NULL ? scan->place : scan->at;
    for (const char *at = scan->text->data; at < place; at++, column++)
        if (*at == '\n')
        {
            line++;
            column = 0;
        }
    return ERROR_FILE(scan->error, line, "column %zu: %s", column, what);
}

static void skip_blanks(wkt_scanner *scan)
{
    while (scan->at < scan->end && strchr(" \t\r\n", *scan->at) != NULL && *scan->at != '\0')
        scan->at++;
}

static bool take(wkt_scanner *scan, char byte)
{
    skip_blanks(scan);
    bool taken = scan->at < scan->end && *scan->at == byte;
    scan->at += taken;
    return taken;
}

static size_t word_size(const char *at, const char *end)
{
    size_t size = 0;
    while (at + size < end && ((at[size] >= 'a' && at[size] <= 'z') || (at[size] >= 'A' && at[size] <= 'Z')))
        size++;
    return size;
}

static bool take_word(wkt_scanner *scan, const char *word)
{
    skip_blanks(scan);
    size_t size = word_size(scan->at, scan->end);
    bool taken = size == strlen(word) && strncasecmp(scan->at, word, size) == 0;
    scan->at += taken ? size : 0;
    return taken;
}

/// The type that a word names, perhaps with Z, M or ZM at its end; null for none.
static const struct wkt_type *type_of(const char *word, size_t size, wkt_form *form)
{
    static const char *const dimensions[] = {"", "Z", "M", "ZM"};
    for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++)
        for (size_t k = 0; k < sizeof dimensions / sizeof *dimensions; k++)
        {
            size_t length = strlen(TYPES[i].name), rest = strlen(dimensions[k]);
            if (size != length + rest || strncasecmp(word, TYPES[i].name, length) != 0 ||
                strncasecmp(word + length, dimensions[k], rest) != 0)
                continue;
            *form = (wkt_form){.kind = TYPES[i].kind, .z = (k & 1) != 0, .m = (k & 2) != 0};
            return &TYPES[i];
        }
    return NULL;
}

bool wkt_begins(const char *begin, const char *end)
{
    static const char srid[] = "SRID=";
    wkt_form form;
    wkt_scanner scan = {.at = begin, .end = end};
    skip_blanks(&scan);
    if ((size_t)(end - scan.at) > sizeof srid && strncasecmp(scan.at, srid, sizeof srid - 1) == 0)
    {
        const char *semicolon = memchr(scan.at, ';', (size_t)(end - scan.at));
        scan.at = semicolon != NULL ? semicolon + 1 : scan.at;
        skip_blanks(&scan);
    }
    size_t size = word_size(scan.at, end);
    if (type_of(scan.at, size, &form) == NULL)
        return false;
    scan.at += size;
    (void)(take_word(&scan, "Z") || take_word(&scan, "M") || take_word(&scan, "ZM"));
    return take(&scan, '(') || take_word(&scan, "EMPTY");
}

/// Read a position of two to four numbers, without brackets.
static bat_status read_position(wkt_scanner *scan, wkt_form *form, text_buffer *geojson)
{
    size_t count = 0;
    const char *begin = scan->at;
    text_append_string(geojson, "[");
    for (;; count++)
    {
        double value;
        skip_blanks(scan);
        if (scan->at == scan->end || strchr(",)", *scan->at) != NULL)
            break;
        const char *end = number_scan(scan->at, scan->end, &value);
        if (end == NULL || !isfinite(value))
            return wkt_fault(scan, "a number is expected");
        if (count == MAX_NUMBERS)
            return wkt_fault(scan, "a position has at most 4 numbers");
        text_append_real(geojson, count > 0 ? "," : "", value);
        if (count < 2)
            geojson_made_take(&scan->made, count, value);
        scan->at = end;
    }
    text_append_string(geojson, "]");
    size_t wanted = form->numbers > 0 ? form->numbers : form->z || form->m ? 2 + (size_t)form->z + (size_t)form->m : count;
    scan->at = count == wanted && count >= 2 ? scan->at : begin;
    if (count < 2)
        return wkt_fault(scan, "a position needs 2 to 4 numbers");
    if (count != wanted)
        return wkt_fault(scan, "the position has %zu numbers where %zu are expected", count, wanted);
    form->numbers = count;
    return BAT_OK;
}

/// Read positions in `depth` brackets. A point is in brackets of its own, one of several points may be.
static bat_status read_coordinates(wkt_scanner *scan, wkt_form *form, int depth, text_buffer *geojson)
{
    bool points = form->kind == GEOMETRY_POINTS,
         bracket = (depth > 0 || points || form->kind == GEOMETRY_POINT) && take(scan, '(');
    if (!bracket && (depth > 0 || form->kind == GEOMETRY_POINT))
        return wkt_fault(scan, "'(' is expected");
    if (depth == 0)
    {
        bat_status status = read_position(scan, form, geojson);
        return status == BAT_OK && bracket && !take(scan, ')') ? wkt_fault(scan, "')' is expected") : status;
    }
    const char *separator = "[";
    bat_status status = BAT_OK;
    do
    {
        if (take_word(scan, "EMPTY"))
            continue;
        text_append_string(geojson, separator);
        status = read_coordinates(scan, form, depth - 1, geojson);
        separator = ",";
    } while (status == BAT_OK && take(scan, ','));
    text_append_string(geojson, *separator == '[' ? "[]" : "]");
    return status == BAT_OK && !take(scan, ')') ? wkt_fault(scan, "',' or ')' is expected") : status;
}

static bat_status read_geometry(wkt_scanner *scan, size_t depth, text_buffer *geojson);

static bat_status read_members(wkt_scanner *scan, size_t depth, text_buffer *geojson)
{
    bat_status status = BAT_OK;
    if (!take(scan, '('))
        return wkt_fault(scan, "'(' is expected");
    if (depth == MAX_DEPTH)
        return wkt_fault(scan, "collections are nested more than %d deep", MAX_DEPTH);
    text_append_string(geojson, "[");
    for (size_t i = 0; status == BAT_OK && (i == 0 || take(scan, ',')); i++)
    {
        text_append_string(geojson, i > 0 ? "," : "");
        status = read_geometry(scan, depth + 1, geojson);
    }
    text_append_string(geojson, "]");
    return status == BAT_OK && !take(scan, ')') ? wkt_fault(scan, "',' or ')' is expected") : status;
}

static bat_status read_geometry(wkt_scanner *scan, size_t depth, text_buffer *geojson)
{
    wkt_form form;
    char excerpt[EXCERPT_SIZE];
    skip_blanks(scan);
    size_t size = word_size(scan->at, scan->end);
    const struct wkt_type *type = type_of(scan->at, size, &form);
    if (type == NULL)
        return size == 0 ? wkt_fault(scan, "a geometry is expected")
                         : wkt_fault(scan, "'%s' is no type of geometry that is known here",
                                     text_excerpt(excerpt, scan->at, scan->at + size));
    scan->at += size;
    bool both = take_word(scan, "ZM");
    form.z = both || take_word(scan, "Z") || form.z;
    form.m = both || take_word(scan, "M") || form.m;
    bool collection = form.kind == GEOMETRY_COLLECTION;
    TEXT_APPEND(geojson, "{\"type\":\"", GEOMETRY_NAMES[form.kind],
                collection ? "\",\"geometries\":" : "\",\"coordinates\":");
    bat_status status = BAT_OK;
    if (take_word(scan, "EMPTY"))
        text_append_string(geojson, "[]");
    else if (collection)
        status = read_members(scan, depth, geojson);
    else
        status = read_coordinates(scan, &form, type->depth, geojson);
    text_append_string(geojson, "}");
    bool measures = form.m && !form.z && !collection && form.numbers > 0;
    scan->made.measures = scan->made.measures || measures;
    scan->altitudes = scan->altitudes || (form.numbers > 2 && !measures);
    if (status == BAT_OK && scan->made.measures && scan->altitudes)
        status = wkt_fault(scan, "a geometry with M alone cannot stand beside one with Z");
    return status;
}

bat_status wkt_scan_geometry(wkt_scanner *scan, text_buffer *geojson)
{
    int srid = 0; // of "SRID=4326;" before the geometry
    bool named = take_word(scan, "SRID");
    if (named && !take(scan, '='))
        return wkt_fault(scan, "'=' is expected");
    for (; named && scan->at < scan->end && *scan->at >= '0' && *scan->at <= '9' && srid <= MAX_SRID; scan->at++)
        srid = 10 * srid + (*scan->at - '0');
    if (named && (srid > MAX_SRID || !take(scan, ';')))
        return wkt_fault(scan, "an SRID is a whole number up to %d, and ';' follows", MAX_SRID);
    if (scan->begun && scan->made.srid != srid)
        return wkt_fault(scan, "the geometry has the SRID %d (0: none), those before it %d", srid, scan->made.srid);
    scan->begun = true;
    scan->made.srid = srid;
    return read_geometry(scan, 0, geojson);
}

bat_status wkt_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_error unread;
    text_buffer geojson = {0};
    wkt_scanner scan = wkt_scanner_start(text, error != NULL ? error : &unread);
    const char *counted = text->data, *separator = "";
    bat_status status = BAT_OK;
    text_append_string(&geojson, GEOJSON_MADE_BEGIN);
    for (;; separator = ",")
    {
        skip_blanks(&scan);
        if (scan.at == scan.end)
            break;
        text_append_string(&geojson, separator);
        geojson_made_pad(scan.at, &counted, &geojson);
        text_append_string(&geojson, "{\"type\":\"Feature\",\"properties\":{},\"geometry\":");
        status = wkt_scan_geometry(&scan, &geojson);
        text_append_string(&geojson, "}");
        if (status != BAT_OK)
            break;
        (void)take(&scan, ';');
    }
    if (status == BAT_OK)
        status = geojson_made_read(&scan.made, &geojson, BAT_CURVE_FORMAT_WKT, options, set, scan.error);
    text_free(&geojson);
    return status;
}

// Writer of well-known text.

const char *const WKT_NAMES[GEOMETRY_KINDS] = {[GEOMETRY_POINT] = "POINT",
                                               [GEOMETRY_LINE] = "LINESTRING",
                                               [GEOMETRY_POLYGON] = "POLYGON",
                                               [GEOMETRY_POINTS] = "MULTIPOINT",
                                               [GEOMETRY_LINES] = "MULTILINESTRING",
                                               [GEOMETRY_POLYGONS] = "MULTIPOLYGON",
                                               [GEOMETRY_COLLECTION] = "GEOMETRYCOLLECTION"};

size_t wkt_count_numbers(const json_t *coordinates)
{
    size_t count = 0;
    if (json_is_number(json_array_get(coordinates, 0)))
        return json_array_size(coordinates);
    for (size_t i = 0; i < json_array_size(coordinates) && count == 0; i++)
        count = wkt_count_numbers(json_array_get(coordinates, i));
    return count;
}

static void append_coordinates(const json_t *value, text_buffer *text)
{
    bool position = json_is_number(json_array_get(value, 0));
    text_append_string(text, position ? "" : "(");
    for (size_t i = 0; i < json_array_size(value); i++)
    {
        const json_t *part = json_array_get(value, i);
        text_append_string(text, i == 0 ? "" : position ? " " : ",");
        if (position)
            text_append_real(text, "", json_number_value(part));
        else
            append_coordinates(part, text);
    }
    text_append_string(text, position ? "" : ")");
}

void wkt_append_geometry(const json_t *geometry, bool measures, text_buffer *text)
{
    geometry_kind kind = geojson_kind(geometry);
    const json_t *coordinates = json_object_get(geometry, "coordinates"), *members = json_object_get(geometry, "geometries");
    size_t numbers = wkt_count_numbers(coordinates);
    if (kind == GEOMETRY_UNKNOWN)
        kind = GEOMETRY_COLLECTION; // for null
    TEXT_APPEND(text, WKT_NAMES[kind], numbers > 3 ? " ZM" : numbers == 3 && measures ? " M" : numbers == 3 ? " Z" : "");
    if (numbers == 0 && json_array_size(members) == 0)
    {
        text_append_string(text, " EMPTY");
        return;
    }
    text_append_string(text, " ");
    if (kind == GEOMETRY_POINT || kind == GEOMETRY_COLLECTION)
        text_append_string(text, "(");
    if (kind != GEOMETRY_COLLECTION)
        append_coordinates(coordinates, text);
    for (size_t i = 0; i < json_array_size(members); i++)
    {
        text_append_string(text, i > 0 ? "," : "");
        wkt_append_geometry(json_array_get(members, i), measures, text);
    }
    if (kind == GEOMETRY_POINT || kind == GEOMETRY_COLLECTION)
        text_append_string(text, ")");
}

void wkt_append_srid(const bat_curve_set *set, const bat_curve_write_options *options, text_buffer *text)
{
    static const char prefix[] = "EPSG:";
    const bat_curve_attributes *attributes = set->attributes;
    const char *crs = options->crs != NULL ? options->crs : attributes != NULL ? attributes->crs : NULL;
    if (crs == NULL || strncmp(crs, prefix, sizeof prefix - 1) != 0)
        return;
    TEXT_APPEND(text, "SRID=", crs + sizeof prefix - 1, ";");
}

typedef struct wkt_writer
{
    text_buffer text, srid;
    bool measures;
    text_sink *sink;
} wkt_writer;

static bat_status take_feature(void *context, size_t index BAT_UNUSED, const json_t *feature, bat_error *error)
{
    wkt_writer *writer = context;
    writer->text.size = 0;
    text_append(&writer->text, writer->srid.data, writer->srid.size);
    wkt_append_geometry(geojson_has_type(feature, "Feature") ? json_object_get(feature, "geometry") : feature,
                        writer->measures, &writer->text);
    text_append_string(&writer->text, "\n");
    return sink_write(writer->sink, &writer->text, error);
}

bat_status wkt_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    const bat_curve_attributes *attributes = set->attributes;
    const geojson_document *document = attributes_are_geojson(attributes) ? attributes->remainder.content : NULL;
    wkt_writer writer = {.measures = document != NULL && document->measures, .sink = sink};
    wkt_append_srid(set, options, &writer.srid);
    bat_status status = geojson_each(set, options->given, options->precision, take_feature, &writer, error);
    text_free(&writer.text);
    text_free(&writer.srid);
    return status;
}
