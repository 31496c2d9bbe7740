#include "io/curve/geojson.h"

#include "io/common/number_text.h"

/// @file
/// Features of GeoJSON. Coordinates are cut out of the text before it is parsed, because a parse tree of them would take
/// many times the memory.

enum
{
    DEEPEST_ARRAY = 4,   ///< of a MultiPolygon: polygons, rings, positions, numbers
    DEEPEST_GEOMETRY = 8 ///< deeper collections are left to the parser
};

typedef struct extractor
{
    json_scanner scan;
    const char *copied; ///< the end of the text that is copied already
    geojson_extraction *extraction;
} extractor;

/// The type of the object at the position, without its quotes; empty when there is none.
static json_scanner find_type(json_scanner scan)
{
    json_scanner key, type = {scan.at, scan.at};
    (void)json_scan_take(&scan, '{');
    do
    {
        if (!json_scan_key(&scan, &key))
            break;
        if (!json_scan_is(&key, "type") || !json_scan_at(&scan, '"'))
            continue;
        type.at = scan.at + 1;
        type.end = json_scan_string(&scan) ? scan.at - 1 : type.at;
        break;
    } while (json_scan_value(&scan) && json_scan_take(&scan, ','));
    return type;
}

bool geojson_text_has_type(const char *begin, const char *end, const char *type)
{
    const json_scanner found = find_type((json_scanner){begin, end});
    return json_scan_is(&found, type);
}

static bool is_curves(const json_scanner *type)
{
    return json_scan_is(type, GEOMETRY_NAMES[GEOMETRY_LINE]) || json_scan_is(type, GEOMETRY_NAMES[GEOMETRY_LINES]) ||
           json_scan_is(type, GEOMETRY_NAMES[GEOMETRY_POLYGON]) || json_scan_is(type, GEOMETRY_NAMES[GEOMETRY_POLYGONS]);
}

static bool has_escape(const json_scanner *string)
{
    return memchr(string->at, '\\', (size_t)(string->end - string->at)) != NULL;
}

/// Replace an array of numbers by its index, and skip it. Other arrays remain.
static bool extract_array(extractor *job)
{
    geojson_extraction *extraction = job->extraction;
    const char *begin = job->scan.at;
    json_scanner ahead = {begin + 1, job->scan.end};
    if (json_scan_at(&ahead, ']'))
        return json_scan_value(&job->scan);
    ahead.at = begin;
    if (!json_scan_numbers(&ahead, DEEPEST_ARRAY))
        return json_scan_value(&job->scan);
    if (!ARRAY_GROW(extraction->arrays, extraction->capacity, extraction->count + 1))
        return false;
    text_append(&extraction->text, job->copied, (size_t)(begin - job->copied));
    size_t newlines = json_scan_newlines(begin, ahead.at);
    char *out = text_reserve(&extraction->text, NUMBER_TEXT_SIZE + newlines);
    if (out == NULL)
        return false;
    *out++ = '[';
    out = number_write_fixed(out, (int64_t)extraction->count, 0);
    memset(out, '\n', newlines);
    out[newlines] = ']';
    text_advance(&extraction->text, out + newlines + 1);
    extraction->arrays[extraction->count++] = begin;
    job->copied = job->scan.at = ahead.at;
    return true;
}

static bool extract_object(extractor *job, size_t depth);

static bool extract_objects(extractor *job, size_t depth)
{
    (void)json_scan_take(&job->scan, '[');
    for (size_t i = 0; json_scan_element(&job->scan, i); i++)
        if (!(json_scan_at(&job->scan, '{') ? extract_object(job, depth) : json_scan_value(&job->scan)))
            return false;
    return true;
}

/// Extract coordinates from the members of an object of this type. False when only the parser can decide.
static bool extract_object(extractor *job, size_t depth)
{
    json_scanner *scan = &job->scan, key;
    const json_scanner type = find_type(*scan);
    if (depth > DEEPEST_GEOMETRY || has_escape(&type))
        return false;
    (void)json_scan_take(scan, '{');
    do
    {
        if (!json_scan_key(scan, &key) || has_escape(&key))
            return false;
        bool extracted;
        if (json_scan_is(&key, "geometry") && json_scan_is(&type, "Feature") && json_scan_at(scan, '{'))
            extracted = extract_object(job, depth + 1);
        else if (json_scan_is(&key, "geometries") && json_scan_is(&type, "GeometryCollection") && json_scan_at(scan, '['))
            extracted = extract_objects(job, depth + 1);
        else if (json_scan_is(&key, "coordinates") && is_curves(&type) && json_scan_at(scan, '['))
            extracted = extract_array(job);
        else
            extracted = json_scan_value(scan);
        if (!extracted)
            return false;
    } while (json_scan_take(scan, ','));
    return json_scan_take(scan, '}');
}

/// Extract the coordinates. Afterwards an array of one integer in place of the coordinates of lines or polygons is such an
/// index. False when nothing was extracted, because of unusual spelling, a syntax error, a lack of memory, or a text without
/// lines; parse the original text then.
static bool extract_text(geojson_extraction *extraction, const char *begin, const char *end)
{
    extractor job = {{begin, end}, begin, extraction};
    extraction->text.size = 0;
    extraction->count = 0;
    if (!json_scan_at(&job.scan, '{') || !extract_object(&job, 0) || extraction->count == 0)
        return false;
    text_append(&extraction->text, job.copied, (size_t)(end - job.copied));
    return !extraction->text.failed;
}

void geojson_extraction_free(geojson_extraction *extraction)
{
    text_free(&extraction->text);
    free(extraction->arrays);
    *extraction = (geojson_extraction){0};
}

/// The text that coordinates were extracted from; null when they are in the tree.
static const char *extracted_text(const geojson_reader *reader, const json_t *coordinates)
{
    const json_t *number = json_array_get(coordinates, 0);
    bool extracted = reader->extracted && json_array_size(coordinates) == 1 && json_is_integer(number);
    return extracted ? reader->extraction.arrays[json_integer_value(number)] : NULL;
}

/// Put extracted coordinates back into the tree.
static bat_status restore_coordinates(geojson_reader *reader, json_t *geometry)
{
    const char *begin = extracted_text(reader, json_object_get(geometry, "coordinates"));
    if (begin == NULL)
        return BAT_OK;
    json_scanner scan = {begin, reader->text_end};
    json_t *tree = NULL;
    if (!json_scan_value(&scan))
        return geojson_no_memory(reader);
    bat_status status = json_parse(begin, (size_t)(scan.at - begin), JSON_ALLOW_NUL, 1, &tree, reader->error);
    return status == BAT_OK && json_object_set_new(geometry, "coordinates", tree) != 0 ? geojson_no_memory(reader) : status;
}

/// Read coordinates from the text they were extracted from, or from text that is made of the tree.
static bat_status read_coordinates(geojson_reader *reader, geometry_kind kind, const json_t *coordinates)
{
    const char *begin = extracted_text(reader, coordinates);
    if (begin != NULL)
    {
        json_scanner scan = {begin, reader->text_end};
        return geojson_read_coordinates(reader, kind, &scan);
    }
    text_buffer text = {0};
    json_text(&text, coordinates);
    text_append(&text, "", 1);
    json_scanner scan = {text.data, text.data + text.size};
    bat_status status = text.failed ? geojson_no_memory(reader) : geojson_read_coordinates(reader, kind, &scan);
    text_free(&text);
    return status;
}

/// Convert the coordinates of a geometry to curves, and replace them by the geometry's index.
static bat_status take_geometry(geojson_reader *reader, geometry_kind kind, json_t *geometry)
{
    geojson_document *document = &reader->document;
    geojson_feature *feature = &document->features[document->feature_count - 1];
    const json_t *coordinates = json_object_get(geometry, "coordinates");
    if (!json_is_array(coordinates))
        return geojson_fault(reader, "the geometry has no array of coordinates");
    if (json_array_size(coordinates) == 0)
        return BAT_OK;
    geojson_geometry taken = {.curve = reader->builder.curve_count - feature->curve,
                              .polygon = document->polygon_count - feature->polygon};
    bat_status status = read_coordinates(reader, kind, coordinates);
    if (status != BAT_OK)
        return status;
    taken.curve_count = reader->builder.curve_count - feature->curve - taken.curve;
    if (taken.curve_count == 0)
        return restore_coordinates(reader, geometry);
    taken.polygon_count = document->polygon_count - feature->polygon - taken.polygon;
    json_int_t index = (json_int_t)(document->geometry_count - feature->geometry);
    bool replaced = json_object_set_new(geometry, "coordinates", json_integer(index)) == 0 &&
                    ARRAY_ADD(document->geometries, document->geometry_capacity, document->geometry_count, taken);
    return replaced ? BAT_OK : geojson_no_memory(reader);
}

static bat_status read_geometry(geojson_reader *reader, json_t *geometry)
{
    geometry_kind kind = geojson_kind(geometry);
    if (geojson_has_type(geometry, "FeatureCollection"))
        return geojson_fault(reader, "a record of a sequence must be a Feature or a geometry, not a FeatureCollection");
    if (kind == GEOMETRY_UNKNOWN)
        return geojson_fault(reader, json_is_object(geometry) ? "the geometry has an unknown type"
                                                              : "the geometry must be an object");
    if (kind == GEOMETRY_POINT || kind == GEOMETRY_POINTS) // they remain unchanged
        return BAT_OK;
    if (kind != GEOMETRY_COLLECTION)
        return take_geometry(reader, kind, geometry);
    const json_t *members = json_object_get(geometry, "geometries");
    if (!json_is_array(members))
        return geojson_fault(reader, "a GeometryCollection needs an array of geometries");
    bat_status status = BAT_OK;
    size_t outer = reader->place.geometry;
    for (size_t i = 0; i < json_array_size(members) && status == BAT_OK; i++)
    {
        reader->place.geometry = i;
        status = read_geometry(reader, json_array_get(members, i));
    }
    if (status == BAT_OK)
        reader->place.geometry = outer;
    return status;
}

bool geojson_has_type(const json_t *object, const char *type)
{
    const char *found = json_string_value(json_object_get(object, "type"));
    return found != NULL && strcmp(found, type) == 0;
}

bat_status geojson_read_feature(geojson_reader *reader, json_t *tree, bool bare_geometry)
{
    geojson_document *document = &reader->document;
    if (!ARRAY_GROW(document->features, document->feature_capacity, document->feature_count + 1))
    {
        json_decref(tree);
        return geojson_no_memory(reader);
    }
    geojson_feature *feature = &document->features[document->feature_count++];
    *feature = (geojson_feature){.tree = tree,
                                 .line = reader->place.line,
                                 .curve = reader->builder.curve_count,
                                 .geometry = document->geometry_count,
                                 .polygon = document->polygon_count};
    if (!bare_geometry && !geojson_has_type(tree, "Feature"))
        return geojson_fault(reader, "the feature must be an object of the type Feature");
    json_t *geometry = bare_geometry ? tree : json_object_get(tree, "geometry");
    if (geometry == NULL)
        return geojson_fault(reader, "the feature has no geometry");
    bat_status status = json_is_null(geometry) ? BAT_OK : read_geometry(reader, geometry);
    feature->curve_count = reader->builder.curve_count - feature->curve;
    feature->geometry_count = document->geometry_count - feature->geometry;
    feature->polygon_count = document->polygon_count - feature->polygon;
    return status;
}

json_t *geojson_parse(geojson_reader *reader, const char *begin, const char *end, size_t first_line)
{
    json_t *tree = NULL;
    reader->extracted = extract_text(&reader->extraction, begin, end);
    reader->text_end = end;
    const char *text = reader->extracted ? reader->extraction.text.data : begin;
    size_t size = reader->extracted ? reader->extraction.text.size : (size_t)(end - begin);
    (void)json_parse(text, size, JSON_ALLOW_NUL, first_line, &tree, reader->error);
    return tree;
}

geojson_reader geojson_reader_start(const bat_space *space, const bat_curve_read_options *options, bat_error *error)
{
    bool sphere = strcmp(space->name, "sphere") == 0 && space->point_dim == 3;
    return (geojson_reader){.closed = options->closed,
                            .strict = options->strict,
                            .degrees = sphere,
                            .builder = {.space = *space, .project = options->project, .check = !sphere},
                            .place = {BAT_NO_INDEX, BAT_NO_INDEX, BAT_NO_INDEX, BAT_NO_INDEX, BAT_NO_INDEX, 0},
                            .error = error};
}

void geojson_reader_free(geojson_reader *reader)
{
    builder_free(&reader->builder);
    geojson_document_free(&reader->document);
    geojson_extraction_free(&reader->extraction);
    free(reader->positions);
    free(reader->crs);
    reader->crs = NULL;
    reader->positions = NULL;
}
