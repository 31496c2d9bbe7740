#include "io/curve/geojson.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "io/curve/formats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool geojson_document_reserve(geojson_document *document, size_t polygons, size_t curves)
{
    return ARRAY_GROW(document->polygons, document->polygon_capacity, polygons) &&
           ARRAY_GROW(document->origins, document->curve_capacity, curves);
}

const char *const GEOMETRY_NAMES[GEOMETRY_KINDS] = {[GEOMETRY_POINT] = "Point",
                                                    [GEOMETRY_LINE] = "LineString",
                                                    [GEOMETRY_POLYGON] = "Polygon",
                                                    [GEOMETRY_POINTS] = "MultiPoint",
                                                    [GEOMETRY_LINES] = "MultiLineString",
                                                    [GEOMETRY_POLYGONS] = "MultiPolygon",
                                                    [GEOMETRY_COLLECTION] = "GeometryCollection"};

geometry_kind geojson_kind(const json_t *geometry)
{
    const char *type = json_string_value(json_object_get(geometry, "type"));
    int kind = GEOMETRY_POINT;
    while (type != NULL && kind < GEOMETRY_KINDS && strcmp(type, GEOMETRY_NAMES[kind]) != 0)
        kind++;
    return type != NULL && kind < GEOMETRY_KINDS ? (geometry_kind)kind : GEOMETRY_UNKNOWN;
}

void geojson_document_free(geojson_document *document)
{
    for (size_t i = 0; i < document->feature_count; i++)
        json_decref(document->features[i].tree);
    json_decref(document->collection);
    free(document->features);
    free(document->geometries);
    free(document->polygons);
    free(document->origins);
    if (document->layer != NULL)
        document->layer_free(document->layer);
    free(document->column);
    if (document->gpx != NULL)
        document->gpx_free(document->gpx);
    *document = (geojson_document){0};
}

static void free_content(void *content)
{
    geojson_document_free(content);
    free(content);
}

void geojson_append_place(char *text, size_t size, const char *what, size_t index)
{
    size_t used = strlen(text);
    if (index != BAT_NO_INDEX)
        (void)snprintf(text + used, size - used, "%s%s %zu", used > 0 ? ", " : "", what, index);
}

void geojson_append_id(char *text, size_t size, const json_t *feature)
{
    const json_t *id = json_object_get(feature, "id");
    size_t used = strlen(text);
    if (json_is_string(id))
        (void)snprintf(text + used, size - used, " (id '%.60s')", json_string_value(id));
    else if (json_is_integer(id))
        (void)snprintf(text + used, size - used, " (id %lld)", (long long)json_integer_value(id));
    else if (json_is_real(id))
        (void)snprintf(text + used, size - used, " (id %.15g)", json_real_value(id));
}

/// The feature that a curve belongs to. Features are in the order of their curves.
static const geojson_feature *feature_of(const geojson_document *document, size_t curve)
{
    size_t low = 0, high = document->feature_count;
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        if (document->features[middle].curve <= curve)
            low = middle;
        else
            high = middle;
    }
    // Of features with the same first curve, all but the last have no curves.
    return low < document->feature_count ? &document->features[low] : NULL;
}

static size_t line_of_feature(const void *content, size_t curve)
{
    const geojson_feature *feature = feature_of(content, curve);
    return feature != NULL ? feature->line : 0;
}

/// The geometry of a feature that a curve belongs to, as an index.
static size_t geometry_of(const geojson_document *document, const geojson_feature *feature, size_t curve)
{
    size_t index = 0;
    while (index + 1 < feature->geometry_count &&
           document->geometries[feature->geometry + index + 1].curve <= curve - feature->curve)
        index++;
    return index;
}

/// Write "feature 6 (id 'ATA'), polygon 7, ring 0".
static void place_of_curve(const void *content, size_t curve, char *text, size_t size)
{
    const geojson_document *document = content;
    const geojson_feature *feature = feature_of(document, curve);
    text[0] = '\0';
    if (feature == NULL || feature->geometry_count == 0 || curve >= document->curve_count)
        return;
    size_t index = geometry_of(document, feature, curve);
    const geojson_geometry *geometry = &document->geometries[feature->geometry + index];
    const stitch_origin *origin = &document->origins[curve];
    if (document->collection != NULL)
    {
        geojson_append_place(text, size, "feature", (size_t)(feature - document->features));
        geojson_append_id(text, size, feature->tree);
    }
    bool polygons = geometry->polygon_count > 0;
    geojson_append_place(text, size, "geometry", feature->geometry_count > 1 ? index : BAT_NO_INDEX);
    geojson_append_place(text, size, polygons ? "polygon" : "line", origin->part);
    geojson_append_place(text, size, "ring", polygons ? origin->ring : BAT_NO_INDEX);
}

/// The polygon and the feature of each curve, for bat_curve_set_polygon(). False when out of memory.
static bool keep_rings(const geojson_document *document, bat_curve_attributes *attributes)
{
    size_t count = 0;
    for (size_t i = 0; i < document->feature_count; i++)
        count += document->features[i].curve_count;
    curve_ring *rings = malloc((count + 1) * sizeof *rings);
    if (rings == NULL)
        return false;
    for (size_t i = 0; i < count; i++)
        rings[i] = (curve_ring){BAT_NO_INDEX, BAT_NO_INDEX};
    for (size_t i = 0; i < document->feature_count; i++)
    {
        const geojson_feature *feature = &document->features[i];
        for (size_t g = 0; g < feature->geometry_count; g++)
        {
            const geojson_geometry *geometry = &document->geometries[feature->geometry + g];
            size_t curve = feature->curve + geometry->curve;
            for (size_t p = 0; p < geometry->polygon_count; p++)
            {
                size_t polygon = feature->polygon + geometry->polygon + p;
                for (size_t r = 0; r < document->polygons[polygon].rings; r++)
                    rings[curve++] = (curve_ring){polygon, i};
            }
        }
    }
    attributes->rings = rings;
    attributes->ring_count = count;
    return true;
}

bool geojson_document_keep(geojson_document *document, bat_curve_attributes *attributes)
{
    geojson_document *kept = malloc(sizeof *kept);
    if (kept == NULL || !keep_rings(document, attributes))
    {
        free(kept);
        return false;
    }
    *kept = *document;
    *document = (geojson_document){0};
    attributes->remainder = (file_remainder){kept, free_content, line_of_feature, place_of_curve};
    return true;
}

/// What follows `prefix` in either case; null when the text begins differently.
static const char *after(const char *text, const char *prefix)
{
    size_t length = strlen(prefix);
    return strncasecmp(text, prefix, length) == 0 ? text + length : NULL;
}

/// What follows the last separator of a name after a prefix: the code, after a version.
static const char *code_of(const char *name)
{
    static const struct
    {
        const char *prefix;
        char separator;
    } forms[] = {{"urn:ogc:def:crs:EPSG:", ':'},
                 {"urn:x-ogc:def:crs:EPSG:", ':'},
                 {"EPSG:", ':'},
                 {"http://www.opengis.net/def/crs/EPSG/", '/'},
                 {"https://www.opengis.net/def/crs/EPSG/", '/'},
                 {"http://www.opengis.net/gml/srs/epsg.xml#", '#'}};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
    {
        if (after(name, forms[i].prefix) == NULL)
            continue;
        const char *code = strrchr(name, forms[i].separator) + 1;
        size_t digits = strspn(code, "0123456789");
        return digits > 0 && code[digits] == '\0' ? code : NULL;
    }
    return NULL;
}

char *crs_short_name(const char *name)
{
    static const char *const global[] = {"urn:ogc:def:crs:OGC:1.3:CRS84",
                                         "urn:ogc:def:crs:OGC::CRS84",
                                         "urn:ogc:def:crs:OGC:2:84",
                                         "http://www.opengis.net/def/crs/OGC/1.3/CRS84",
                                         "https://www.opengis.net/def/crs/OGC/1.3/CRS84",
                                         "OGC:CRS84",
                                         "CRS:84",
                                         "CRS84"};
    for (size_t i = 0; i < sizeof global / sizeof *global; i++)
        if (strcasecmp(name, global[i]) == 0)
            return strdup("OGC:CRS84");
    const char *code = code_of(name);
    if (code == NULL)
        return strdup(name);
    size_t size = strlen(code) + sizeof "EPSG:";
    char *text = malloc(size);
    if (text != NULL)
        (void)snprintf(text, size, "EPSG:%s", code);
    return text;
}

bool crs_is_default(const char *short_name)
{
    return strcmp(short_name, "OGC:CRS84") == 0 || strcmp(short_name, "EPSG:4326") == 0 ||
           strcmp(short_name, "EPSG:4979") == 0;
}

bool crs_is_geographic(const char *short_name)
{
    static const char *const others[] = {"EPSG:4258", "EPSG:4269", "EPSG:4283", "EPSG:7844",
                                         "EPSG:6668", "EPSG:4490", "EPSG:4167"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(short_name, others[i]) == 0)
            return true;
    return crs_is_default(short_name);
}

void crs_urn(const char *short_name, char *text, unsigned long size)
{
    const char *code = after(short_name, "EPSG:");
    (void)snprintf(text, size, "%s%s", code != NULL ? "urn:ogc:def:crs:EPSG::" : "", code != NULL ? code : short_name);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

static const char *skip_blanks(const char *at, const char *end)
{
    while (at < end && is_blank(*at))
        at++;
    return at;
}

record_scan record_scan_start(const char *text, size_t size, size_t line)
{
    const char *first = skip_blanks(text, text + size);
    return (record_scan){text, text + size, line, first < text + size && *first == RECORD_SEPARATOR};
}

bool record_scan_next(record_scan *scan, bool whole, feature_text *record)
{
    record_scan ahead = *scan;
    while (ahead.at < ahead.end)
    {
        // What stands between two separators, or before a line break.
        const char *begin = skip_blanks(ahead.at, ahead.end);
        begin += ahead.separated && begin < ahead.end && *begin == RECORD_SEPARATOR;
        begin = skip_blanks(begin, ahead.end);
        const char *end = memchr(begin, ahead.separated ? RECORD_SEPARATOR : '\n', (size_t)(ahead.end - begin));
        if (end == NULL && !whole)
            return false;
        const char *stop = end != NULL ? end : ahead.end;
        size_t line = ahead.line + json_scan_newlines(ahead.at, begin);
        ahead.line = line + json_scan_newlines(begin, stop);
        ahead.at = stop;
        *record = (feature_text){begin, stop, line};
        while (record->end > record->begin && is_blank(record->end[-1]))
            record->end--;
        if (record->end == record->begin)
            continue;
        *scan = ahead;
        return true;
    }
    if (whole)
        *scan = ahead;
    return false;
}

bool geojson_is_sequence(const char *text, size_t size)
{
    const char *end = text + size, *begin = skip_blanks(text, end);
    if (begin < end && *begin == RECORD_SEPARATOR)
        return true;
    const char *newline = begin < end && *begin == '{' ? memchr(begin, '\n', (size_t)(end - begin)) : NULL;
    if (newline == NULL)
        return false;
    const char *next = skip_blanks(newline, end), *last = newline;
    while (last > begin && is_blank(last[-1]))
        last--;
    // The first line is one object, and another one follows.
    json_scanner scan = {begin, end};
    return next < end && *next == '{' && last[-1] == '}' && json_scan_value(&scan) && scan.at == last;
}

bat_status geojson_sequence_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set,
                                 bat_error *error)
{
    bat_error unread;
    error = error != NULL ? error : &unread;
    geojson_reader reader;
    bat_status status = geojson_records_begin(options, &reader, error);
    if (status != BAT_OK)
        return status;
    feature_text *records = NULL, record;
    size_t count = 0, capacity = 0;
    record_scan scan = record_scan_start(text->data, text->size, 1);
    bool separated = scan.separated;
    while (status == BAT_OK && record_scan_next(&scan, true, &record))
        if (!ARRAY_ADD(records, capacity, count, record))
            status = error_memory(error, capacity * sizeof record);
    if (status == BAT_OK)
        status = geojson_records_read(&reader, records, count, 0, options);
    if (status == BAT_OK && reader.builder.curve_count == 0)
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "there are no lines or polygons");
    if (status == BAT_OK)
        status = geojson_records_end(&reader, separated ? BAT_CURVE_FORMAT_GEOJSON_SEQUENCE : BAT_CURVE_FORMAT_GEOJSON_LINES,
                                     set);
    geojson_reader_free(&reader);
    free(records);
    return status;
}

// Reading of collections that other formats become.

const char GEOJSON_MADE_BEGIN[] = "{\"type\":\"FeatureCollection\",\"features\":[";

geojson_made geojson_made_start(void)
{
    return (geojson_made){.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
}

void geojson_made_pad(const char *at, const char **counted, text_buffer *geojson)
{
    for (; *counted < at; ++*counted)
        if (**counted == '\n')
            text_append_string(geojson, "\n");
}

static bool fits_degrees(const geojson_made *made)
{
    static const double HALF_TURN = 180, QUARTER_TURN = 90;
    return made->low[0] >= -HALF_TURN && made->high[0] <= HALF_TURN && made->low[1] >= -QUARTER_TURN &&
           made->high[1] <= QUARTER_TURN;
}

/// Tell what the file lets open. False when out of memory.
static bool note_space(const geojson_made *made, bool degrees, bat_curve_attributes *attributes)
{
    if (!degrees)
        return attributes_note(attributes, "the file names no coordinate system; its coordinates are those of a plane");
    return made->degrees ||
           attributes_note(attributes, "the file names no coordinate system; its coordinates are taken as degrees, because "
                                       "they could be (the plane takes them as they are)");
}

bat_status geojson_made_read(const geojson_made *made, text_buffer *geojson, bat_curve_format format,
                             const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_curve_read_options rest = *options;
    bool guessed = made->srid == 0 && options->space == NULL, degrees = fits_degrees(made);
    char end[96] = "]}";
    if (made->srid != 0)
        (void)snprintf(end, sizeof end, "],\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"EPSG:%d\"}}}", made->srid);
    text_append_string(geojson, end);
    if (geojson->failed)
        return error_memory(error, geojson->size);
    if (guessed)
        rest.space = degrees ? "sphere" : "plane";
    bat_curve_set read = {0};
    const file_text text = {.data = geojson->data, .size = geojson->size};
    bat_status status = geojson_read(&text, &rest, &read, error);
    if (status != BAT_OK && error != NULL && !made->lines)
        error->line = 0;
    if (status != BAT_OK)
        return status;
    geojson_document *document = read.attributes->remainder.content;
    read.attributes->format = format;
    document->measures = made->measures;
    (void)json_object_del(document->collection, "crs"); // the attributes have it
    for (size_t i = 0; !made->lines && i < document->feature_count; i++)
        document->features[i].line = 0;
    if (!guessed || note_space(made, degrees, read.attributes))
    {
        *set = read;
        return BAT_OK;
    }
    bat_curve_set_free(&read);
    return error_memory(error, geojson->size);
}
