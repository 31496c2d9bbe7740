#include "base/array_grow.h"
#include "base/error.h"
#include "curve/map/arc_refine.h"
#include "io/common/json.h"
#include "io/common/number_text.h"
#include "io/curve/formats.h"
#include "io/curve/geojson.h"

#include <inttypes.h>

/// @file
/// Writer of TopoJSON. Lines and rings are cut where they part, and equal pieces are one arc. Rings keep their first points.

enum
{
    MAX_NUMBERS = 4 ///< of a position
};

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

/// Append a position to the current line. False when out of memory.
static bool add_position(topology_writer *writer, const json_t *position)
{
    size_t size = json_array_size(position), count = size < writer->numbers ? size : writer->numbers;
    topology_point point = {.count = (double)count};
    for (size_t i = 0; i < count; i++)
        point.numbers[i] = json_number_value(json_array_get(position, i)) + 0.0; // no -0
    return ARRAY_ADD(writer->points, writer->point_capacity, writer->point_count, point);
}

static bool add_line(topology_writer *writer, const json_t *positions, bool ring)
{
    size_t count = json_array_size(positions);
    topology_line line = {writer->point_count, count, ring && count > 1, writer->objects.size};
    line.count -= line.ring; // its last position repeats the first
    bool done = true;
    for (size_t i = 0; i < line.count && done; i++)
        done = add_position(writer, json_array_get(positions, i));
    return done && ARRAY_ADD(writer->lines, writer->line_capacity, writer->line_count, line);
}

/// Append arrays of lines in `depth` arrays, without their arcs.
static bool append_lines(topology_writer *writer, const json_t *coordinates, int depth, bool ring)
{
    bool done = true;
    if (depth == 0)
        return json_array_size(coordinates) > 0 ? add_line(writer, coordinates, ring) : true;
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
static bool append_geometry(topology_writer *writer, const json_t *geometry)
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
    else if (kind != GEOMETRY_COLLECTION && json_array_size(coordinates) == 0)
        text_append_string(text, "[]");
    else if (kind != GEOMETRY_COLLECTION)
        done = append_lines(writer, coordinates, depth, ring);
    for (size_t i = 0; kind == GEOMETRY_COLLECTION && i < json_array_size(members) && done; i++)
    {
        text_append_string(text, i > 0 ? "," : "");
        done = append_geometry(writer, json_array_get(members, i));
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
    bool done = append_geometry(writer, bare ? feature : json_object_get(feature, "geometry"));
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
    bat_curve *curves = memory_array(count, sizeof *curves);
    unsigned char **corners = memory_array(count, sizeof *corners);
    unsigned char *first = calloc(writer->point_count + 1, 1);
    bat_status status = BAT_OK;
    if (curves == NULL || corners == NULL || first == NULL)
        status = error_memory(writer->error, writer->point_count + count * sizeof *curves);
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
    free(curves);
    free(corners);
    free(first);
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

static void append_positions(topology_writer *writer, const bat_curve *arc)
{
    const topology_point *points = (const topology_point *)arc->points;
    for (size_t k = 0; k < arc->count; k++)
    {
        char *out = text_reserve(&writer->text, (MAX_NUMBERS + 1) * (NUMBER_TEXT_SIZE + 1));
        if (out == NULL)
            return;
        for (size_t i = 0; i < (size_t)points[k].count; i++)
        {
            *out++ = i > 0 ? ',' : k > 0 ? ',' : '[';
            if (i == 0)
                *out++ = '[';
            out = number_write(out, points[k].numbers[i]);
        }
        *out++ = ']';
        text_advance(&writer->text, out);
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
        append_positions(writer, &writer->graph.arcs[i]);
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
    char urn[160];
    name = name != NULL ? name : "curves";
    text_append_string(&writer->objects, "{\"type\":\"Topology\",");
    if (crs != NULL && !crs_is_default(crs) && strlen(crs) < sizeof urn / 2)
    {
        crs_urn(crs, urn, sizeof urn);
        text_append_string(&writer->objects, "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":");
        json_text_string(&writer->objects, urn, strlen(urn));
        text_append_string(&writer->objects, "}},");
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
