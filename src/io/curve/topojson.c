#include "io/curve/formats.h"
#include "io/curve/geojson.h"

#include <inttypes.h>
#include <math.h>

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
    return reader->feature == BAT_NO_INDEX ? ERROR_FILE(reader->error, 0, "%s", what)
                                           : ERROR_FILE(reader->error, 0, "geometry %zu: %s", reader->feature, what);
}

/// Append a position. `sum` is that of the quantized numbers before it in an arc; null for a position by itself.
static bat_status append_position(topology_reader *reader, const json_t *position, double sum[2], bool written)
{
    size_t count = json_array_size(position);
    char *out = text_reserve(&reader->geojson, (count + 1) * (NUMBER_TEXT_SIZE + 1) + 1);
    if (out == NULL || reader->geojson.size > reader->limit)
        return out == NULL ? error_memory(reader->error, reader->geojson.size)
                           : ERROR_TOO_LARGE(reader->error, "the arcs are used too many times");
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

/// Append an array of positions, or the coordinates that arcs in `depth` arrays make.
static bat_status append_parts(topology_reader *reader, const json_t *parts, bool points, int depth)
{
    bat_status status = json_is_array(parts) ? BAT_OK
                                             : fault(reader, points ? "the geometry has no array of coordinates"
                                                                    : "the arcs must be arrays of whole numbers");
    text_append_string(&reader->geojson, "[");
    for (size_t i = 0; i < json_array_size(parts) && status == BAT_OK; i++)
    {
        const json_t *part = json_array_get(parts, i);
        text_append_string(&reader->geojson, (points || depth > 0) && i > 0 ? "," : "");
        status = points      ? append_position(reader, part, NULL, true)
                 : depth > 0 ? append_parts(reader, part, false, depth - 1)
                             : append_arc(reader, part, i == 0);
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
    bool collection = kind == GEOMETRY_COLLECTION;
    TEXT_APPEND(&reader->geojson, "{\"type\":\"", GEOMETRY_NAMES[kind],
                collection ? "\",\"geometries\":[" : "\",\"coordinates\":");
    bat_status status = BAT_OK;
    if (kind == GEOMETRY_POINT)
        status = append_position(reader, coordinates, NULL, true);
    else if (kind == GEOMETRY_POINTS)
        status = append_parts(reader, coordinates, true, 0);
    else if (!collection)
        status = append_parts(reader, json_object_get(geometry, "arcs"), false, depths[kind]);
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
        return *chosen != NULL
                   ? BAT_OK
                   : ERROR_ARGUMENT(reader->error, "there is no object '%.40s'; there are %s", options->layer, names);
    }
    if (json_object_size(objects) == 1)
        return BAT_OK;
    (void)ERROR_ARGUMENT(reader->error, "there are %zu objects: %s", json_object_size(objects), names);
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

// Writer of TopoJSON. Lines and rings are cut where they part, and equal pieces are one arc. Rings keep their first points.

#define MAX_NUMBERS 4 ///< of a position

/// A position as a point of a space: those with the same numbers are one vertex.
typedef struct topology_point
{
    double numbers[MAX_NUMBERS];
    double count; ///< of its numbers
} topology_point;

/// A line or ring, whose arcs are written at a place of the text of the objects.
typedef struct topology_line
{
    size_t begin, count; ///< its points
    bool ring;           ///< the last point joins the first
    size_t text;
} topology_line;

typedef struct topology_writer
{
    topology_point *points;
    size_t point_count, point_capacity;
    topology_line *lines;
    size_t line_count, line_capacity;
    arc_graph graph; ///< of the lines
    size_t numbers;  ///< the most of a position: without measures
    text_buffer objects, text;
    bat_error *error;
} topology_writer;

static bool add_line(topology_writer *writer, const json_t *positions, bool ring)
{
    size_t count = json_array_size(positions);
    topology_line line = {writer->point_count, count, ring && count > 1, writer->objects.size};
    line.count -= line.ring; // its last position repeats the first
    bool done = true;
    for (size_t i = 0; i < line.count && done; i++)
    {
        const json_t *position = json_array_get(positions, i);
        size_t size = json_array_size(position), numbers = size < writer->numbers ? size : writer->numbers;
        topology_point point = {.count = (double)numbers};
        for (size_t k = 0; k < numbers; k++)
            point.numbers[k] = json_number_value(json_array_get(position, k)) + 0.0; // no -0
        done = ARRAY_ADD(writer->points, writer->point_capacity, writer->point_count, point);
    }
    return done && ARRAY_ADD(writer->lines, writer->line_capacity, writer->line_count, line);
}

/// Append arrays of lines in `depth` arrays, without their arcs. An array without positions stays empty.
static bool append_lines(topology_writer *writer, const json_t *coordinates, int depth, bool ring)
{
    bool done = true;
    if (depth == 0 && json_array_size(coordinates) > 0)
        return add_line(writer, coordinates, ring);
    text_append_string(&writer->objects, "[");
    for (size_t i = 0; i < json_array_size(coordinates) && done; i++)
    {
        text_append_string(&writer->objects, i > 0 ? "," : "");
        done = append_lines(writer, json_array_get(coordinates, i), depth - 1, ring);
    }
    text_append_string(&writer->objects, "]");
    return done;
}

/// Append the members of a geometry, without the brace at its end.
static bool append_written(topology_writer *writer, const json_t *geometry)
{
    geometry_kind kind = geojson_kind(geometry);
    const json_t *coordinates = json_object_get(geometry, "coordinates"), *members = json_object_get(geometry, "geometries");
    text_buffer *text = &writer->objects;
    bool ring = kind == GEOMETRY_POLYGON || kind == GEOMETRY_POLYGONS, done = true;
    int depth = kind == GEOMETRY_LINE ? 0 : kind == GEOMETRY_POLYGONS ? 2 : 1;
    text_append_string(text, "{\"type\":");
    if (kind == GEOMETRY_UNKNOWN)
    {
        text_append_string(text, "null");
        return true;
    }
    json_text_string(text, GEOMETRY_NAMES[kind], strlen(GEOMETRY_NAMES[kind]));
    bool points = kind == GEOMETRY_POINT || kind == GEOMETRY_POINTS;
    text_append_string(text, points                        ? ",\"coordinates\":"
                             : kind == GEOMETRY_COLLECTION ? ",\"geometries\":["
                                                           : ",\"arcs\":");
    if (points)
        json_text(text, coordinates);
    else if (kind != GEOMETRY_COLLECTION)
        done = append_lines(writer, coordinates, depth, ring);
    for (size_t i = 0; kind == GEOMETRY_COLLECTION && i < json_array_size(members) && done; i++)
    {
        text_append_string(text, i > 0 ? "," : "");
        done = append_written(writer, json_array_get(members, i));
        text_append_string(text, "}");
    }
    text_append_string(text, kind == GEOMETRY_COLLECTION ? "]" : "");
    return done;
}

static bat_status take_feature(void *context, size_t index, const json_t *feature, bat_error *error)
{
    topology_writer *writer = context;
    bool bare = !geojson_has_type(feature, "Feature");
    static const char *const kept[] = {"id", "properties"};
    text_append_string(&writer->objects, index > 0 ? ",\n" : "\n");
    bool done = append_written(writer, bare ? feature : json_object_get(feature, "geometry"));
    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++)
    {
        const json_t *value = bare ? NULL : json_object_get(feature, kept[i]);
        if (value == NULL || json_is_null(value))
            continue;
        text_append_string(&writer->objects, ",");
        json_text_string(&writer->objects, kept[i], strlen(kept[i]));
        text_append_string(&writer->objects, ":");
        json_text(&writer->objects, value);
    }
    text_append_string(&writer->objects, "}");
    return done && !writer->objects.failed ? BAT_OK : error_memory(error, writer->point_capacity * sizeof *writer->points);
}

/// Cut the lines into arcs. The first point of a ring ends its arcs, like a corner.
static bat_status cut_lines(topology_writer *writer)
{
    const bat_space space = {.point_dim = sizeof(topology_point) / sizeof(double)};
    size_t count = writer->line_count;
    memory_pool pool = {0};
    bat_curve *curves = memory_pool_array(&pool, count, sizeof *curves);
    unsigned char **corners = memory_pool_array(&pool, count, sizeof *corners);
    unsigned char *first = memory_pool_zeros(&pool, writer->point_count + 1, 1);
    bat_status status = memory_pool_check(&pool, writer->error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        const topology_line *line = &writer->lines[i];
        double *points = writer->points[line->begin].numbers;
        curves[i] = (bat_curve){.space = &space, .points = points, .count = line->count, .closed = line->ring};
        corners[i] = line->ring ? first : NULL;
        first[0] = 1;
    }
    if (status == BAT_OK)
        status = arc_graph_make(curves, count, corners, false, &writer->graph, writer->error);
    memory_pool_free(&pool);
    return status;
}

/// Append the arcs of a line.
static void append_cut(topology_writer *writer, size_t line)
{
    const arc_graph *graph = &writer->graph;
    text_append_string(&writer->text, "[");
    for (size_t k = graph->first_use[line]; k < graph->first_use[line + 1]; k++)
    {
        int64_t arc = (int64_t)graph->uses[k].arc;
        text_append_string(&writer->text, k > graph->first_use[line] ? "," : "");
        text_append_format(&writer->text, "%" PRId64, graph->uses[k].reversed ? -arc - 1 : arc);
    }
    text_append_string(&writer->text, "]");
}

/// Write the objects with their arcs, and the arcs.
static bat_status write_topology(topology_writer *writer, text_sink *sink)
{
    size_t at = 0;
    bat_status status = cut_lines(writer);
    for (size_t i = 0; i < writer->line_count && status == BAT_OK; i++)
    {
        text_append(&writer->text, writer->objects.data + at, writer->lines[i].text - at);
        at = writer->lines[i].text;
        append_cut(writer, i);
    }
    text_append(&writer->text, writer->objects.data + at, writer->objects.size - at);
    text_append_string(&writer->text, "\n]}},\"arcs\":[");
    for (size_t i = 0; i < writer->graph.arc_count && status == BAT_OK; i++)
    {
        text_append_string(&writer->text, i > 0 ? ",\n" : "\n");
        const topology_point *points = (const topology_point *)writer->graph.arcs[i].points;
        for (size_t k = 0; k < writer->graph.arcs[i].count; k++)
        {
            for (size_t n = 0; n < (size_t)points[k].count; n++)
                text_append_real(&writer->text, n > 0 ? "," : k > 0 ? ",[" : "[[", points[k].numbers[n]);
            text_append_string(&writer->text, "]");
        }
        text_append_string(&writer->text, "]");
    }
    text_append_string(&writer->text, "\n]}\n");
    return status == BAT_OK ? sink_write(sink, &writer->text, writer->error) : status;
}

static void append_begin(topology_writer *writer, const bat_curve_set *set, const bat_curve_write_options *options)
{
    const bat_curve_attributes *attributes = set->attributes;
    const geojson_document *document = attributes_are_geojson(attributes) ? attributes->remainder.content : NULL;
    const char *name = document != NULL ? json_string_value(json_object_get(document->collection, "name")) : NULL;
    const char *crs = options->crs != NULL ? options->crs : attributes != NULL ? attributes->crs : NULL;
    static const size_t LONGEST = 80;
    name = name != NULL ? name : "curves";
    text_append_string(&writer->objects, "{\"type\":\"Topology\",");
    if (crs != NULL && !crs_is_default(crs) && strlen(crs) < LONGEST)
    {
        crs_append(crs, &writer->objects);
        text_append_string(&writer->objects, ",");
    }
    text_append_string(&writer->objects, "\"objects\":{");
    json_text_string(&writer->objects, name, strlen(name));
    text_append_string(&writer->objects, ":{\"type\":\"GeometryCollection\",\"geometries\":[");
}

bat_status topojson_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink,
                          bat_error *error)
{
    const geojson_document *document = attributes_are_geojson(set->attributes) ? set->attributes->remainder.content : NULL;
    topology_writer writer = {.numbers = document != NULL && document->measures ? 2 : MAX_NUMBERS, .error = error};
    append_begin(&writer, set, options);
    bat_status status = geojson_each(set, options->given, options->precision, take_feature, &writer, error);
    if (status == BAT_OK)
        status = write_topology(&writer, sink);
    free(writer.points);
    free(writer.lines);
    arc_graph_free(&writer.graph);
    text_free(&writer.objects);
    text_free(&writer.text);
    return status;
}
