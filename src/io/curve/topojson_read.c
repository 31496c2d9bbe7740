#include "base/array_grow.h"
#include "base/error.h"
#include "io/common/json.h"
#include "io/common/number_text.h"
#include "io/curve/formats.h"
#include "io/curve/geojson_made.h"

#include <math.h>
#include <stdio.h>

/// @file
/// Reader of TopoJSON (https://github.com/topojson/topojson-specification): its arcs become the coordinates of GeoJSON.

enum
{
    MAX_SRID = 999999,
    MAX_DEPTH = 32,     ///< of collections
    MAX_REPETITION = 64 ///< of the file's size: what arcs that are used again and again may become
};

typedef struct topology_reader
{
    const json_t *root, *arcs;
    double scale[2], translate[2];
    bool quantized;
    size_t limit; ///< of the text
    size_t feature;
    text_buffer geojson;
    geojson_made made;
    bat_error *error;
} topology_reader;

static bat_status fault(const topology_reader *reader, const char *what)
{
    return reader->feature == BAT_NO_INDEX
               ? error_set(reader->error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "%s", what)
               : error_set(reader->error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "geometry %zu: %s", reader->feature, what);
}

/// Append a position. `sum` is that of the quantized numbers before it in an arc; null for a position by itself.
static bat_status append_position(topology_reader *reader, const json_t *position, double sum[2], bool written)
{
    size_t count = json_array_size(position);
    char *out = text_reserve(&reader->geojson, (count + 1) * (NUMBER_TEXT_SIZE + 1) + 1);
    if (out == NULL || reader->geojson.size > reader->limit)
        return out == NULL ? error_memory(reader->error, reader->geojson.size)
                           : error_set(reader->error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the arcs are used too many times");
    if (count < 2)
        return fault(reader, "a position must be an array of 2 or more numbers");
    for (size_t i = 0; i < count; i++)
    {
        const json_t *number = json_array_get(position, i);
        double value = json_number_value(number);
        if (!json_is_number(number))
            return fault(reader, "a position must be an array of 2 or more numbers");
        if (i < 2 && reader->quantized)
        {
            value += sum != NULL ? sum[i] : 0;
            if (sum != NULL)
                sum[i] = value;
            value = value * reader->scale[i] + reader->translate[i];
        }
        if (!isfinite(value))
            return fault(reader, "a number is too large");
        if (i < 2)
            geojson_made_take(&reader->made, i, value);
        *out++ = i == 0 ? '[' : ',';
        out = number_write(out, value);
    }
    *out++ = ']';
    if (written)
        text_advance(&reader->geojson, out);
    return BAT_OK;
}

/// Append the positions of an arc, but for the first one when others stand before.
static bat_status append_arc(topology_reader *reader, const json_t *number, bool first)
{
    json_int_t index = json_integer_value(number);
    bool reverse = index < 0;
    const json_t *arc = json_is_integer(number) ? json_array_get(reader->arcs, (size_t)(reverse ? ~index : index)) : NULL;
    size_t count = json_array_size(arc), *starts = NULL, begin = reader->geojson.size;
    double sum[2] = {0, 0};
    if (count < 2)
        return fault(reader, "an arc that it names does not exist, or has fewer than 2 positions");
    if (reverse && (starts = memory_array(count + 1, sizeof *starts)) == NULL)
        return error_memory(reader->error, count * sizeof *starts);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        bool skipped = !first && !reverse && i == 0;
        if (starts != NULL)
            starts[i] = reader->geojson.size;
        else if (!skipped && (!first || i > 0))
            text_append_string(&reader->geojson, ",");
        status = append_position(reader, json_array_get(arc, i), sum, !skipped);
    }
    if (status == BAT_OK && starts != NULL)
    {
        // The same positions from the last to the first.
        text_buffer turned = {0};
        starts[count] = reader->geojson.size;
        for (size_t i = first ? count : count - 1; i > 0; i--)
        {
            text_append_string(&turned, first && i == count ? "" : ",");
            text_append(&turned, reader->geojson.data + starts[i - 1], starts[i] - starts[i - 1]);
        }
        reader->geojson.size = begin;
        text_append(&reader->geojson, turned.data, turned.size);
        status = turned.failed ? error_memory(reader->error, turned.size) : BAT_OK;
        text_free(&turned);
    }
    free(starts);
    return status;
}

/// Append the coordinates that arcs in `depth` arrays make.
static bat_status append_arcs(topology_reader *reader, const json_t *arcs, int depth)
{
    bat_status status = json_is_array(arcs) ? BAT_OK : fault(reader, "the arcs must be arrays of whole numbers");
    text_append_string(&reader->geojson, "[");
    for (size_t i = 0; i < json_array_size(arcs) && status == BAT_OK; i++)
    {
        if (depth > 0)
            text_append_string(&reader->geojson, i > 0 ? "," : "");
        status = depth > 0 ? append_arcs(reader, json_array_get(arcs, i), depth - 1)
                           : append_arc(reader, json_array_get(arcs, i), i == 0);
    }
    text_append_string(&reader->geojson, "]");
    return status;
}

static bat_status append_points(topology_reader *reader, const json_t *points)
{
    bat_status status = json_is_array(points) ? BAT_OK : fault(reader, "the geometry has no array of coordinates");
    text_append_string(&reader->geojson, "[");
    for (size_t i = 0; i < json_array_size(points) && status == BAT_OK; i++)
    {
        text_append_string(&reader->geojson, i > 0 ? "," : "");
        status = append_position(reader, json_array_get(points, i), NULL, true);
    }
    text_append_string(&reader->geojson, "]");
    return status;
}

static bat_status append_geometry(topology_reader *reader, const json_t *geometry, size_t depth)
{
    static const int depths[GEOMETRY_KINDS] = {[GEOMETRY_LINES] = 1, [GEOMETRY_POLYGON] = 1, [GEOMETRY_POLYGONS] = 2};
    geometry_kind kind = geojson_kind(geometry);
    const json_t *coordinates = json_object_get(geometry, "coordinates"), *members = json_object_get(geometry, "geometries");
    if (json_is_null(json_object_get(geometry, "type")))
    {
        text_append_string(&reader->geojson, "null");
        return BAT_OK;
    }
    if (kind == GEOMETRY_UNKNOWN)
        return fault(reader, "the geometry has an unknown type");
    if (depth == MAX_DEPTH)
        return fault(reader, "collections are nested too deep");
    text_append_string(&reader->geojson, "{\"type\":\"");
    text_append_string(&reader->geojson, GEOMETRY_NAMES[kind]);
    bool collection = kind == GEOMETRY_COLLECTION;
    text_append_string(&reader->geojson, collection ? "\",\"geometries\":[" : "\",\"coordinates\":");
    bat_status status = BAT_OK;
    if (kind == GEOMETRY_POINT)
        status = append_position(reader, coordinates, NULL, true);
    else if (kind == GEOMETRY_POINTS)
        status = append_points(reader, coordinates);
    else if (!collection)
        status = append_arcs(reader, json_object_get(geometry, "arcs"), depths[kind]);
    for (size_t i = 0; collection && i < json_array_size(members) && status == BAT_OK; i++)
    {
        text_append_string(&reader->geojson, i > 0 ? "," : "");
        status = append_geometry(reader, json_array_get(members, i), depth + 1);
    }
    text_append_string(&reader->geojson, collection ? "]}" : "}");
    return status;
}

static bat_status append_feature(topology_reader *reader, const json_t *geometry)
{
    const json_t *id = json_object_get(geometry, "id"), *properties = json_object_get(geometry, "properties");
    text_append_string(&reader->geojson, "\n{\"type\":\"Feature\"");
    if (id != NULL)
    {
        text_append_string(&reader->geojson, ",\"id\":");
        json_text(&reader->geojson, id);
    }
    text_append_string(&reader->geojson, ",\"properties\":");
    if (properties != NULL)
        json_text(&reader->geojson, properties);
    else
        text_append_string(&reader->geojson, "{}");
    text_append_string(&reader->geojson, ",\"geometry\":");
    bat_status status = append_geometry(reader, geometry, 0);
    text_append_string(&reader->geojson, "}");
    return status;
}

/// Choose the object of the options, or the only one.
static bat_status choose_object(const topology_reader *reader, const bat_curve_read_options *options, const char **name,
                                json_t **chosen)
{
    json_t *objects = json_object_get(reader->root, "objects"), *value;
    char names[BAT_ERROR_TEXT_SIZE / 2] = "";
    const char *key;
    json_object_foreach(objects, key, value)
    {
        size_t used = strlen(names);
        (void)snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "", key);
        *name = key;
        *chosen = value;
    }
    if (json_object_size(objects) == 0)
        return fault(reader, "the topology has no objects");
    if (options->layer != NULL)
    {
        *name = options->layer;
        *chosen = json_object_get(objects, options->layer);
        return *chosen != NULL ? BAT_OK
                               : error_set(reader->error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                                           "there is no object '%.40s'; there are %s", options->layer, names);
    }
    if (json_object_size(objects) == 1)
        return BAT_OK;
    (void)error_set(reader->error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there are %zu objects: %s",
                    json_object_size(objects), names);
    return error_remedy(reader->error, BAT_INVALID_ARGUMENT, "layer", "chooses one");
}

static bat_status read_transform(topology_reader *reader)
{
    const json_t *transform = json_object_get(reader->root, "transform");
    const json_t *scale = json_object_get(transform, "scale"), *translate = json_object_get(transform, "translate");
    reader->quantized = transform != NULL && !json_is_null(transform);
    for (size_t i = 0; i < 2 && reader->quantized; i++)
    {
        if (!json_is_number(json_array_get(scale, i)) || !json_is_number(json_array_get(translate, i)))
            return fault(reader, "the transform needs a scale and a translate of two numbers");
        reader->scale[i] = json_number_value(json_array_get(scale, i));
        reader->translate[i] = json_number_value(json_array_get(translate, i));
    }
    return BAT_OK;
}

/// The EPSG code in a member "crs", 0 for none.
static int srid_of(const json_t *root)
{
    const char *name =
        json_string_value(json_object_get(json_object_get(json_object_get(root, "crs"), "properties"), "name"));
    char *brief = name != NULL ? crs_short_name(name) : NULL;
    static const char prefix[] = "EPSG:";
    long code =
        brief != NULL && strncmp(brief, prefix, sizeof prefix - 1) == 0 ? strtol(brief + sizeof prefix - 1, NULL, 10) : 0;
    int srid = code > 0 && code <= MAX_SRID ? (int)code : 0;
    free(brief);
    return srid;
}

static bat_status read_topology(topology_reader *reader, const bat_curve_read_options *options, bat_curve_set *set)
{
    const char *name = "";
    json_t *object = NULL;
    if (!geojson_has_type(reader->root, "Topology"))
        return fault(reader, "the file is no TopoJSON: its type is not Topology");
    bat_status status = read_transform(reader);
    if (status == BAT_OK)
        status = choose_object(reader, options, &name, &object);
    if (status != BAT_OK)
        return status;
    text_append_string(&reader->geojson, "{\"type\":\"FeatureCollection\",\"name\":");
    json_text_string(&reader->geojson, name, strlen(name));
    text_append_string(&reader->geojson, ",\"features\":[");
    bool many = geojson_kind(object) == GEOMETRY_COLLECTION;
    const json_t *members = json_object_get(object, "geometries");
    for (size_t i = 0; status == BAT_OK && i < (many ? json_array_size(members) : 1); i++)
    {
        text_append_string(&reader->geojson, i > 0 ? "," : "");
        reader->feature = i;
        status = append_feature(reader, many ? json_array_get(members, i) : object);
    }
    reader->made.srid = srid_of(reader->root);
    return status == BAT_OK
               ? geojson_made_read(&reader->made, &reader->geojson, BAT_CURVE_FORMAT_TOPOJSON, options, set, reader->error)
               : status;
}

bat_status topojson_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    static const size_t LEAST = 1 << 20;
    bat_error unread;
    json_t *root = NULL;
    error = error != NULL ? error : &unread;
    bat_status status = json_parse(text->data, text->size, JSON_ALLOW_NUL, 1, &root, error);
    topology_reader reader = {.root = root,
                              .arcs = json_object_get(root, "arcs"),
                              .limit = LEAST + MAX_REPETITION * text->size,
                              .feature = BAT_NO_INDEX,
                              .made = geojson_made_start(),
                              .error = error};
    reader.made.degrees = true;
    if (status == BAT_OK)
        status = read_topology(&reader, options, set);
    text_free(&reader.geojson);
    json_decref(root);
    return status;
}
