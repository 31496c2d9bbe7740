#include "base/error.h"
#include "curve/curve_attributes.h"
#include "io/common/json.h"
#include "io/curve/formats.h"
#include "io/curve/geojson_document.h"
#include "io/curve/geojson_shape.h"

#include <string.h>

/// @file
/// Writer of GeoJSON. A set that was read from GeoJSON keeps its features and their members; "bbox" is dropped.

/// The data that all threads share.
typedef struct geojson_writer
{
    const bat_curve_set *set;
    const geojson_document *document; ///< null for a set from another format
    geojson_style style;
    block_cut blocks; ///< of features or, without a document, of curves
} geojson_writer;

/// The state of one thread.
typedef struct geojson_output
{
    const geojson_writer *writer;
    const geojson_feature *feature;
    geojson_shape shape;
    text_buffer *text;
    bat_error *error;
} geojson_output;

static void write_key(geojson_output *out, const char *separator, const char *key)
{
    text_append_string(out->text, separator);
    json_text_string(out->text, key, strlen(key));
    text_append_string(out->text, ":");
}

/// Write the members of an object in their order, except for "bbox", which changes with the curves. `write_member` writes
/// the values that it handles and returns true for them.
typedef bool member_writer(geojson_output *out, const char *key, json_t *value, bat_status *status);

static bat_status write_members(geojson_output *out, json_t *object, member_writer *write_member)
{
    bat_status status = BAT_OK;
    const char *separator = "{";
    for (void *at = json_object_iter(object); at != NULL && status == BAT_OK; at = json_object_iter_next(object, at))
    {
        const char *key = json_object_iter_key(at);
        json_t *value = json_object_iter_value(at);
        if (strcmp(key, "bbox") == 0)
            continue;
        write_key(out, separator, key);
        if (!write_member(out, key, value, &status))
            json_text(out->text, value);
        separator = ",";
    }
    text_append_string(out->text, "}");
    return status;
}

static bat_status make_shape(geojson_output *out, const char *type, const geojson_geometry *geometry)
{
    const geojson_writer *writer = out->writer;
    size_t first = out->feature->curve + geometry->curve;
    const bat_curve *curves = writer->set->curves + first;
    if (geometry->polygon_count == 0)
        return geojson_shape_lines(&out->shape, &writer->style, type, curves, geometry->curve_count, first, out->error);
    const size_t *ring_counts = writer->document->ring_counts + out->feature->polygon + geometry->polygon;
    return geojson_shape_polygons(&out->shape, &writer->style, type, curves, ring_counts, geometry->polygon_count, first,
                                  out->error);
}

static bool write_shape_member(geojson_output *out, const char *key, json_t *value, bat_status *status)
{
    (void)value;
    (void)status;
    if (strcmp(key, "type") == 0)
        json_text_string(out->text, out->shape.type, strlen(out->shape.type));
    else if (strcmp(key, "coordinates") == 0)
        geojson_shape_write(&out->shape, &out->writer->style, out->text);
    else
        return false;
    return true;
}

static bat_status write_geometry(geojson_output *out, json_t *geometry);

static bool write_collection_member(geojson_output *out, const char *key, json_t *value, bat_status *status)
{
    if (strcmp(key, "geometries") != 0)
        return false;
    text_append_string(out->text, "[");
    for (size_t i = 0; i < json_array_size(value) && *status == BAT_OK; i++)
    {
        if (i > 0)
            text_append_string(out->text, ",");
        *status = write_geometry(out, json_array_get(value, i));
    }
    text_append_string(out->text, "]");
    return true;
}

static bat_status write_geometry(geojson_output *out, json_t *geometry)
{
    const char *type = json_string_value(json_object_get(geometry, "type"));
    const json_t *coordinates = json_object_get(geometry, "coordinates");
    if (type != NULL && strcmp(type, "GeometryCollection") == 0)
        return write_members(out, geometry, write_collection_member);
    bool points = type != NULL && (strcmp(type, "Point") == 0 || strcmp(type, "MultiPoint") == 0);
    if (type == NULL || points || !json_is_integer(coordinates))
    {
        json_text(out->text, geometry);
        return BAT_OK;
    }
    size_t index = out->feature->geometry + (size_t)json_integer_value(coordinates);
    bat_status status = make_shape(out, type, &out->writer->document->geometries[index]);
    return status == BAT_OK ? write_members(out, geometry, write_shape_member) : status;
}

static bool write_feature_member(geojson_output *out, const char *key, json_t *value, bat_status *status)
{
    if (strcmp(key, "geometry") != 0)
        return false;
    *status = write_geometry(out, value);
    return true;
}

static bat_status write_feature(geojson_output *out, const geojson_feature *feature)
{
    out->feature = feature;
    if (feature->curve_count == 0)
    {
        json_text(out->text, feature->tree);
        return BAT_OK;
    }
    const char *type = json_string_value(json_object_get(feature->tree, "type"));
    if (type != NULL && strcmp(type, "Feature") == 0)
        return write_members(out, feature->tree, write_feature_member);
    return write_geometry(out, feature->tree);
}

/// Write a feature for a curve that did not come from GeoJSON.
static bat_status write_new_feature(geojson_output *out, size_t curve)
{
    bat_status status = geojson_shape_lines(&out->shape, &out->writer->style, "LineString", &out->writer->set->curves[curve],
                                            1, curve, out->error);
    if (status != BAT_OK)
        return status;
    text_append_string(out->text, "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"");
    text_append_string(out->text, out->shape.type);
    text_append_string(out->text, "\",\"coordinates\":");
    geojson_shape_write(&out->shape, &out->writer->style, out->text);
    text_append_string(out->text, "}}");
    return BAT_OK;
}

static bat_status format_block(const void *context, size_t block, text_buffer *text, bat_error *error)
{
    const geojson_writer *writer = context;
    geojson_output out = {.writer = writer, .text = text, .error = error};
    bat_status status = BAT_OK;
    for (size_t i = writer->blocks.starts[block]; i < writer->blocks.starts[block + 1] && status == BAT_OK; i++)
    {
        if (i > 0)
            text_append_string(text, ",\n");
        status = writer->document != NULL ? write_feature(&out, &writer->document->features[i]) : write_new_feature(&out, i);
    }
    geojson_shape_free(&out.shape);
    return status;
}

/// The number of points of a job, plus a constant for its feature.
static size_t job_weight(const void *context, size_t job)
{
    enum
    {
        FEATURE_WEIGHT = 8
    };
    const geojson_writer *writer = context;
    size_t first = job, count = 1, weight = FEATURE_WEIGHT;
    if (writer->document != NULL)
    {
        first = writer->document->features[job].curve;
        count = writer->document->features[job].curve_count;
    }
    for (size_t i = 0; i < count; i++)
        weight += writer->set->curves[first + i].count;
    return weight;
}

/// Write the members of a collection before and after the content of "features".
static void write_frame(json_t *collection, text_buffer *before, text_buffer *after)
{
    text_buffer *text = before;
    const char *separator = "{";
    for (void *at = json_object_iter(collection); at != NULL; at = json_object_iter_next(collection, at))
    {
        const char *key = json_object_iter_key(at);
        if (strcmp(key, "bbox") == 0)
            continue;
        text_append_string(text, separator);
        separator = ",";
        json_text_string(text, key, strlen(key));
        text_append_string(text, ":");
        if (strcmp(key, "features") != 0)
        {
            json_text(text, json_object_iter_value(at));
            continue;
        }
        text_append_string(text, "[\n");
        text = after;
        text_append_string(text, "\n]");
    }
    text_append_string(text, "}\n");
}

static bat_status write_blocks(geojson_writer *writer, size_t job_count, const bat_curve_write_options *options,
                               text_sink *sink, bat_error *error)
{
    enum
    {
        BLOCK_WEIGHT = 1 << 14
    };
    bat_status status = blocks_cut(job_count, job_weight, writer, BLOCK_WEIGHT, &writer->blocks, error);
    if (status != BAT_OK)
        return status;
    status = blocks_write(sink, writer->blocks.count, options->threads, format_block, writer, error);
    free(writer->blocks.starts);
    return status;
}

static bat_status write_set(geojson_writer *writer, const bat_curve_write_options *options, text_sink *sink,
                            bat_error *error)
{
    const geojson_document *document = writer->document;
    text_buffer before = {0}, after = {0};
    if (document == NULL)
    {
        text_append_string(&before, "{\"type\":\"FeatureCollection\",\"features\":[\n");
        text_append_string(&after, "\n]}\n");
    }
    else if (document->collection != NULL)
        write_frame(document->collection, &before, &after);
    else
        text_append_string(&after, "\n");
    bat_status status = sink_write(sink, &before, error);
    if (status == BAT_OK)
        status = write_blocks(writer, document != NULL ? document->feature_count : writer->set->count, options, sink, error);
    if (status == BAT_OK)
        status = sink_write(sink, &after, error);
    text_free(&before);
    text_free(&after);
    return status;
}

/// The channel of the altitude, or BAT_NO_INDEX.
static size_t altitude_channel(const bat_curve_set *set)
{
    const bat_curve_attributes *attributes = set->attributes;
    if (attributes != NULL && attributes->format == BAT_CURVE_FORMAT_CSV)
        return attributes->csv.altitude;
    return set->curves[0].channel_count <= 1 ? 0 : BAT_NO_INDEX;
}

bat_status geojson_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    bool globe = strcmp(set->space->name, "sphere") == 0 && set->space->point_dim == 3;
    if (!globe && set->space->point_dim != 2)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "GeoJSON cannot hold points of the space %s with %zu numbers", set->space->name,
                         set->space->point_dim);
    const bat_curve_attributes *attributes = set->attributes;
    bool same = attributes != NULL && attributes->format == BAT_CURVE_FORMAT_GEOJSON;
    geojson_writer writer = {
        .set = set,
        .document = same ? attributes->remainder.content : NULL,
        .style = {globe, options->precision, degree_grid_of(options->precision), altitude_channel(set)}};
    return write_set(&writer, options, sink, error);
}
