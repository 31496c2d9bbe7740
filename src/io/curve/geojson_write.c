#include "io/curve/gpx.h"

#include <assert.h>

/// @file
/// Writer of GeoJSON. A set that was read from GeoJSON keeps its features and their members; "bbox" is dropped.

/// The data that all threads share.
typedef struct geojson_writer
{
    const bat_curve_set *set;
    const bat_curve_set *given;       ///< see bat_curve_write_options
    const geojson_document *document; ///< null for a set from another format
    geojson_style style;
    text_buffer crs; ///< the member "crs" to write in place of the document's, `"crs":{...}`; empty for none
    bat_curve_format format;
    bool values;                    ///< features have the values of the points of GPX
    bool continued;                 ///< features of the collection stand before these
    bool wraps;                     ///< the features are in a collection: geometries in place of features become features
    block_cut blocks;               ///< of features or, without a document, of curves
    bat_curve_write_report *report; ///< null, or the sum over all threads
} geojson_writer;

typedef struct geojson_output
{
    const geojson_writer *writer;
    const geojson_feature *feature;
    const json_t *top;          ///< the object whose opening brace and member "crs" are written already
    geojson_shape shape, given; ///< `given`: of the given curves, to judge the other
    text_buffer *text;
    text_buffer *after; ///< of a collection: the text that follows its features
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
    bool begun = out->top == object, replaces_crs = begun && out->writer->crs.size > 0;
    const char *separator = begun ? "," : "{";
    for (void *at = json_object_iter(object); at != NULL && status == BAT_OK; at = json_object_iter_next(object, at))
    {
        const char *key = json_object_iter_key(at);
        json_t *value = json_object_iter_value(at);
        if (strcmp(key, "bbox") == 0 || (replaces_crs && strcmp(key, "crs") == 0))
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
    const stitch_polygon *polygons = writer->document->polygons + out->feature->polygon + geometry->polygon;
    bat_status status = geojson_shape_polygons(&out->shape, &writer->style, type, curves, polygons, geometry->polygon_count,
                                               first, out->error);
    if (status != BAT_OK || writer->given == NULL)
        return status;
    bool held = geojson_shape_polygons(&out->given, &writer->style, type, writer->given->curves + first, polygons,
                                       geometry->polygon_count, first, NULL) == BAT_OK;
    out->given.left_out = 0;
    return held ? judge_polygons(&out->given, &out->shape, &writer->style, first, out->error) : BAT_OK;
}

static bool write_shape_member(geojson_output *out, const char *key, json_t *value BAT_UNUSED, bat_status *status BAT_UNUSED)
{
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
        text_append_string(out->text, i > 0 ? "," : "");
        *status = write_geometry(out, json_array_get(value, i));
    }
    text_append_string(out->text, "]");
    return true;
}

static bat_status write_geometry(geojson_output *out, json_t *geometry)
{
    geometry_kind kind = geojson_kind(geometry);
    const json_t *coordinates = json_object_get(geometry, "coordinates");
    if (kind == GEOMETRY_COLLECTION)
        return write_members(out, geometry, write_collection_member);
    if (kind == GEOMETRY_UNKNOWN || !json_is_integer(coordinates))
    {
        json_text(out->text, geometry);
        return BAT_OK;
    }
    size_t index = out->feature->geometry + (size_t)json_integer_value(coordinates);
    bat_status status = make_shape(out, GEOMETRY_NAMES[kind], &out->writer->document->geometries[index]);
    return status == BAT_OK ? write_members(out, geometry, write_shape_member) : status;
}

/// Write the properties of a feature from GPX, whose geometry is the last shape, with the values of its points.
static void write_properties(geojson_output *out, json_t *properties, bat_status *status)
{
    text_buffer *text = out->text;
    json_text(text, properties);
    if (text->failed)
        return;
    text->size--; // the brace
    TEXT_APPEND(text, json_object_size(properties) > 0 ? "," : "", "\"coordinateProperties\":");
    if (!gpx_properties_write(out->writer->set, &out->shape, out->feature->curve, text))
        *status = error_memory(out->error, text->size);
    text_append_string(text, "}");
}

/// The number of values in nested arrays, or in the first of an object.
static size_t count_values(json_t *value)
{
    size_t count = 0;
    if (json_is_object(value))
        return count_values(json_object_iter_value(json_object_iter(value)));
    for (size_t i = 0; i < json_array_size(value); i++)
    {
        json_t *part = json_array_get(value, i);
        count += json_is_array(part) ? count_values(part) : 1;
    }
    return count;
}

/// Whether a property has values of points that the feature no longer has, as togeojson writes them.
static bool is_outdated(const geojson_writer *writer, const geojson_feature *feature, const char *name, json_t *value)
{
    size_t points = 0;
    if (strcmp(name, "coordinateProperties") != 0 && strcmp(name, "coordTimes") != 0)
        return false;
    for (size_t i = 0; i < feature->curve_count; i++)
        points += writer->set->curves[feature->curve + i].count + writer->set->curves[feature->curve + i].closed;
    return count_values(value) != points;
}

/// Write properties without those that are outdated.
static void write_current_properties(geojson_output *out, json_t *properties)
{
    const char *separator = "{";
    for (void *at = json_object_iter(properties); at != NULL; at = json_object_iter_next(properties, at))
    {
        const char *name = json_object_iter_key(at);
        json_t *value = json_object_iter_value(at);
        if (is_outdated(out->writer, out->feature, name, value))
            continue;
        write_key(out, separator, name);
        json_text(out->text, value);
        separator = ",";
    }
    text_append_string(out->text, *separator == '{' ? "{}" : "}");
}

static bool write_feature_member(geojson_output *out, const char *key, json_t *value, bat_status *status)
{
    if (out->writer->values && strcmp(key, "properties") == 0)
        write_properties(out, value, status);
    else if (json_is_object(value) && strcmp(key, "properties") == 0)
        write_current_properties(out, value);
    else if (strcmp(key, "geometry") == 0)
        *status = write_geometry(out, value);
    else
        return false;
    return true;
}

/// Begin the tree of a whole file, with a member "crs" first.
static void begin_top(geojson_output *out, json_t *tree)
{
    const geojson_writer *writer = out->writer;
    if (writer->crs.size == 0)
        return;
    text_append(out->text, "{", 1);
    text_append(out->text, writer->crs.data, writer->crs.size);
    out->top = tree;
}

static bat_status write_feature(geojson_output *out, const geojson_feature *feature)
{
    if (out->writer->document->collection == NULL)
        begin_top(out, feature->tree);
    if (feature->curve_count == 0)
    {
        json_text(out->text, feature->tree);
        return BAT_OK;
    }
    if (geojson_has_type(feature->tree, "Feature"))
        return write_members(out, feature->tree, write_feature_member);
    return write_geometry(out, feature->tree);
}

/// Write a feature or, where the features are in a collection, a geometry as one.
static bat_status write_wrapped(geojson_output *out, const geojson_feature *feature)
{
    bool wrap = out->writer->wraps && !geojson_has_type(feature->tree, "Feature");
    out->feature = feature;
    text_append_string(out->text, wrap ? "{\"type\":\"Feature\",\"properties\":null,\"geometry\":" : "");
    bat_status status = write_feature(out, feature);
    text_append_string(out->text, wrap ? "}" : "");
    return status;
}

static bat_status write_new_feature(geojson_output *out, size_t curve)
{
    bat_status status = geojson_shape_lines(&out->shape, &out->writer->style, "LineString", &out->writer->set->curves[curve],
                                            1, curve, out->error);
    if (status != BAT_OK)
        return status;
    TEXT_APPEND(out->text, "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"", out->shape.type,
                "\",\"coordinates\":");
    geojson_shape_write(&out->shape, &out->writer->style, out->text);
    text_append_string(out->text, "}}");
    return BAT_OK;
}

/// Add the rings that a block left out to the report. The result does not depend on the order.
static void add_left_out(const geojson_writer *writer, const geojson_shape *shape)
{
    bat_curve_write_report *report = writer->report;
    if (report == NULL || shape->left_out == 0)
        return;
#pragma omp critical(geojson_left_out)
    {
        if (report->left_out == 0 || shape->first_left_out < report->first_left_out)
            report->first_left_out = shape->first_left_out;
        report->left_out += shape->left_out;
    }
}

static bat_status format_block(const void *context, size_t block, text_buffer *text, bat_error *error)
{
    const geojson_writer *writer = context;
    geojson_output out = {.writer = writer, .text = text, .error = error};
    bat_status status = BAT_OK;
    for (size_t i = writer->blocks.starts[block]; i < writer->blocks.starts[block + 1] && status == BAT_OK; i++)
    {
        bool collection = writer->format == BAT_CURVE_FORMAT_GEOJSON;
        if (collection && (i > 0 || writer->continued))
            text_append_string(text, ",\n");
        if (writer->format == BAT_CURVE_FORMAT_GEOJSON_SEQUENCE)
            text_append(text, &(const char){RECORD_SEPARATOR}, 1);
        status = writer->document != NULL ? write_wrapped(&out, &writer->document->features[i]) : write_new_feature(&out, i);
        if (!collection)
            text_append_string(text, "\n");
    }
    add_left_out(writer, &out.shape);
    geojson_shape_free(&out.shape);
    geojson_shape_free(&out.given);
    return status;
}

/// The number of points of a job, plus a constant for its feature.
static size_t job_weight(const void *context, size_t job)
{
    static const int FEATURE_WEIGHT = 8;
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

/// The content of "features" stands between the two texts.
static bool write_features_member(geojson_output *out, const char *key, json_t *value BAT_UNUSED,
                                  bat_status *status BAT_UNUSED)
{
    if (strcmp(key, "features") != 0)
        return false;
    text_append_string(out->text, "[\n");
    out->text = out->after;
    text_append_string(out->text, "\n]");
    return true;
}

static bat_status write_blocks(geojson_writer *writer, size_t job_count, const bat_curve_write_options *options,
                               text_sink *sink, bat_error *error)
{
    static const int BLOCK_WEIGHT = 1 << 14;
    bat_status status = blocks_cut(job_count, job_weight, writer, BLOCK_WEIGHT, &writer->blocks, error);
    if (status != BAT_OK)
        return status;
    status = blocks_write(sink, writer->blocks.count, options->threads, format_block, writer, error);
    free(writer->blocks.starts);
    return status;
}

const char GEOJSON_COLLECTION_BEGIN[] = "{\"type\":\"FeatureCollection\",\"features\":[\n";
const char GEOJSON_COLLECTION_END[] = "\n]}\n";

static bat_status write_set(geojson_writer *writer, const bat_curve_write_options *options, text_sink *sink,
                            bat_error *error)
{
    const geojson_document *document = writer->document;
    text_buffer before = {0}, after = {0};
    if (writer->format != BAT_CURVE_FORMAT_GEOJSON)
        return write_blocks(writer, document != NULL ? document->feature_count : writer->set->count, options, sink, error);
    if (document == NULL || writer->wraps)
    {
        text_append_string(&before, "{\"type\":\"FeatureCollection\",");
        if (writer->crs.size > 0)
        {
            text_append(&before, writer->crs.data, writer->crs.size);
            text_append_string(&before, ",");
        }
        text_append_string(&before, "\"features\":[\n");
        text_append_string(&after, "\n]}\n");
    }
    else if (document->collection != NULL)
    {
        geojson_output out = {.writer = writer, .text = &before, .after = &after};
        begin_top(&out, document->collection);
        (void)write_members(&out, document->collection, write_features_member);
        text_append_string(out.text, "\n");
    }
    else
        text_append_string(&after, "\n");
    bat_status status = sink_take(sink, &before, BAT_OK, error);
    if (status == BAT_OK)
        status = write_blocks(writer, document != NULL ? document->feature_count : writer->set->count, options, sink, error);
    return sink_take(sink, &after, status, error);
}

/// The channel of the altitude, or BAT_NO_INDEX.
static size_t altitude_channel(const bat_curve_set *set)
{
    const bat_curve_attributes *attributes = set->attributes;
    if (attributes != NULL && attributes->format == BAT_CURVE_FORMAT_CSV)
        return attributes->csv != NULL ? attributes->csv->altitude : BAT_NO_INDEX;
    return set->count == 0 || attributes_are_geojson(attributes) || set->curves[0].channel_count <= 1 ? 0 : BAT_NO_INDEX;
}

/// Find the member "crs" to write: that of the options; for a set that is not from GeoJSON also that of its file.
/// Coordinates of the plane need one, as GeoJSON without it is longitude and latitude. A set from GeoJSON may go back as it
/// came.
static bat_status choose_crs(geojson_writer *writer, const bat_curve_write_options *options, bat_error *error)
{
    const bat_curve_attributes *attributes = writer->set->attributes;
    bool globe = writer->style.globe;
    bool geojson = attributes_are_geojson(attributes) && attributes->format <= BAT_CURVE_FORMAT_GEOJSON_SEQUENCE &&
                   writer->document->layer == NULL;
    if (options->crs == NULL && !geojson && attributes != NULL && attributes->crs != NULL &&
        strlen(attributes->crs) < CRS_NAME_SIZE && !(globe && crs_is_default(attributes->crs)))
        crs_append(attributes->crs, &writer->crs);
    if (options->crs != NULL)
    {
        char *name = crs_short_name(options->crs);
        if (name == NULL)
            return error_memory(error, strlen(options->crs));
        bool fits = !globe || crs_is_geographic(name);
        if (fits && !(globe && crs_is_default(name)))
            crs_append(name, &writer->crs);
        free(name);
        if (!fits)
            return ERROR_ARGUMENT(error, "the curves have longitudes and latitudes, which are no coordinates in %.80s",
                                  options->crs);
    }
    if (writer->crs.failed)
        return error_memory(error, writer->crs.size);
    bool named = options->crs != NULL || (attributes != NULL && attributes->crs != NULL);
    if (writer->format != BAT_CURVE_FORMAT_GEOJSON && !globe && (named || !geojson))
        return ERROR_UNSUPPORTED(error, 0,
                                 "a sequence of GeoJSON cannot name the system of plane coordinates; a .geojson file can");
    if (globe || geojson || writer->crs.size > 0)
        return BAT_OK;
    (void)ERROR_UNSUPPORTED(error, 0, "GeoJSON holds plane coordinates only with the name of their system");
    return error_remedy(error, BAT_UNSUPPORTED, "crs", "names their system, as in EPSG:25833");
}

/// Make a writer without a member "crs".
static bat_status start_writer(bat_curve_format format, const bat_curve_set *set, const bat_curve_set *given, int precision,
                               geojson_writer *writer, bat_error *error)
{
    bool globe = strcmp(set->space->name, "sphere") == 0 && set->space->point_dim == 3;
    if (!globe && set->space->point_dim != 2)
        return ERROR_UNSUPPORTED(error, 0, "GeoJSON cannot hold points of the space %s with %zu numbers", set->space->name,
                                 set->space->point_dim);
    const bat_curve_attributes *attributes = set->attributes;
    bool same = attributes_are_geojson(attributes);
    *writer = (geojson_writer){.set = set,
                               .given = given != NULL && given->count == set->count ? given : NULL,
                               .document = same ? attributes->remainder.content : NULL,
                               .format = format,
                               .wraps = format == BAT_CURVE_FORMAT_GEOJSON && same &&
                                        (attributes->format == BAT_CURVE_FORMAT_GEOJSON_LINES ||
                                         attributes->format == BAT_CURVE_FORMAT_GEOJSON_SEQUENCE),
                               .style = {.globe = globe,
                                         .decimals = precision,
                                         .grid = degree_grid_of(precision),
                                         .altitude = altitude_channel(set),
                                         .further = same && attributes->csv == NULL,
                                         .located = attributes != NULL && attributes->format == BAT_CURVE_FORMAT_GPX}};
    return writer->given != NULL ? judge_borders(given, set, error) : BAT_OK;
}

bat_status geojson_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    geojson_writer writer;
    bat_status status = start_writer(options->format, set, options->given, options->precision, &writer, error);
    if (status != BAT_OK)
        return status;
    writer.report = options->report;
    writer.values = writer.style.located;
    for (size_t i = 0; writer.document != NULL && options->report != NULL && i < writer.document->feature_count; i++)
    {
        json_t *properties = json_object_get(writer.document->features[i].tree, "properties"), *value;
        const char *name;
        json_object_foreach(properties, name, value)
        {
            if (is_outdated(&writer, &writer.document->features[i], name, value))
                options->report->lost = "properties with a value for each given point";
        }
    }
    if (writer.document != NULL && writer.document->measures)
        writer.style.altitude = BAT_NO_INDEX;
    status = choose_crs(&writer, options, error);
    if (status == BAT_OK)
        status = write_set(&writer, options, sink, error);
    text_free(&writer.crs);
    return status;
}

bat_status geojson_part_write(const bat_curve_set *set, bat_curve_format format, bool first,
                              const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    geojson_writer writer;
    bat_status status = start_writer(format, set, options->given, options->precision, &writer, error);
    if (status != BAT_OK)
        return status;
    assert(writer.document != NULL); // parts come from a file of GeoJSON
    bat_curve_write_report report = {0};
    writer.continued = !first;
    writer.report = &report;
    status = choose_crs(&writer, options, error);
    if (status == BAT_OK)
        status = write_blocks(&writer, writer.document->feature_count, options, sink, error);
    if (options->report != NULL)
        options->report->left_out += report.left_out;
    text_free(&writer.crs);
    return status;
}

bat_status geojson_each(const bat_curve_set *set, const bat_curve_set *given, int precision, geojson_taker *take,
                        void *context, bat_error *error)
{
    geojson_writer writer;
    text_buffer text = {0};
    // As records, so that a bare geometry remains one.
    bat_status status = start_writer(BAT_CURVE_FORMAT_GEOJSON_LINES, set, given, precision, &writer, error);
    if (status != BAT_OK)
        return status;
    geojson_output out = {.writer = &writer, .text = &text, .error = error};
    const geojson_document *document = writer.document;
    size_t count = document != NULL ? document->feature_count : set->count;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        json_t *tree = NULL;
        text.size = 0;
        status = document != NULL ? write_wrapped(&out, &document->features[i]) : write_new_feature(&out, i);
        if (status == BAT_OK && text.failed)
            status = error_memory(error, text.size);
        if (status == BAT_OK)
            status = json_parse(text.data, text.size, JSON_ALLOW_NUL, 1, &tree, error);
        if (status == BAT_OK)
            status = take(context, i, tree, error);
        json_decref(tree);
    }
    geojson_shape_free(&out.shape);
    geojson_shape_free(&out.given);
    text_free(&text);
    return status;
}
