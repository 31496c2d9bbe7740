#include "base/array_grow.h"
#include "base/error.h"
#include "base/hash.h"
#include "io/common/json.h"
#include "io/common/number_text.h"
#include "io/curve/formats.h"
#include "io/curve/geojson.h"

/// @file
/// Writer of TopoJSON. Lines and rings are cut where they part (M. Bostock, topojson-server), and equal pieces are one arc:
/// a point is a node when its neighbours differ between the lines through it. Rings keep their first points.

enum
{
    MAX_NUMBERS = 4 ///< of a position
};

/// A point of the file. Positions with the same numbers are one point.
typedef struct topology_point
{
    double numbers[MAX_NUMBERS];
    size_t count;            ///< of its numbers
    size_t neighbours[2];    ///< in the first line through it
    bool visited, met, node; ///< `met`: by a second line, or twice by one
} topology_point;

/// A line or ring, whose arcs are written at a place of the text of the objects.
typedef struct topology_line
{
    size_t begin, end; ///< in `places`
    bool ring;         ///< the last point is the first
    size_t text;
} topology_line;

/// Points begin … end - 1 of `places`.
typedef struct topology_arc
{
    size_t begin, end;
} topology_arc;

/// A table of indices by hashes; 0 for none.
typedef struct index_table
{
    size_t *slots; ///< index + 1
    size_t count, size;
} index_table;

typedef struct topology_writer
{
    topology_point *points;
    size_t point_count, point_capacity;
    size_t *places; ///< the points of all lines
    size_t place_count, place_capacity;
    topology_line *lines;
    size_t line_count, line_capacity;
    topology_arc *arcs;
    size_t arc_count, arc_capacity;
    index_table known_points, known_arcs;
    size_t numbers; ///< the most of a position: without measures
    text_buffer objects, text;
    bat_error *error;
} topology_writer;

/// Whether an entry of a table is the one that is sought.
typedef bool entry_test(const topology_writer *writer, size_t entry, const void *sought);
typedef uint64_t entry_hash(const topology_writer *writer, size_t entry);

/// The slot of an entry, or the free one for it.
static size_t find_slot(const topology_writer *writer, const index_table *table, uint64_t hash, entry_test *test,
                        const void *sought)
{
    size_t slot = (size_t)(hash ^ hash >> 32) & (table->size - 1);
    while (table->slots[slot] != 0 && !(test != NULL && test(writer, table->slots[slot] - 1, sought)))
        slot = (slot + 1) & (table->size - 1);
    return slot;
}

/// Make room for another entry. False when out of memory.
static bool grow_table(const topology_writer *writer, index_table *table, entry_hash *hash)
{
    enum
    {
        FIRST_SIZE = 1 << 10
    };
    if (2 * (table->count + 1) <= table->size)
        return true;
    index_table grown = {.count = table->count, .size = table->size > 0 ? 2 * table->size : FIRST_SIZE};
    grown.slots = calloc(grown.size, sizeof *grown.slots);
    if (grown.slots == NULL)
        return false;
    for (size_t i = 0; i < table->size; i++)
        if (table->slots[i] != 0)
            grown.slots[find_slot(writer, &grown, hash(writer, table->slots[i] - 1), NULL, NULL)] = table->slots[i];
    free(table->slots);
    *table = grown;
    return true;
}

static uint64_t hash_of_numbers(const topology_point *point)
{
    return hash_bytes(HASH_BEGIN, point->numbers, point->count * sizeof *point->numbers);
}

static uint64_t hash_of_point(const topology_writer *writer, size_t point)
{
    return hash_of_numbers(&writer->points[point]);
}

static bool is_point(const topology_writer *writer, size_t point, const void *sought)
{
    const topology_point *a = &writer->points[point], *b = sought;
    return a->count == b->count && memcmp(a->numbers, b->numbers, a->count * sizeof *a->numbers) == 0;
}

/// Append a position to the current line. False when out of memory.
static bool add_position(topology_writer *writer, const json_t *position)
{
    size_t count = json_array_size(position);
    topology_point point = {.count = count < writer->numbers ? count : writer->numbers};
    for (size_t i = 0; i < point.count; i++)
        point.numbers[i] = json_number_value(json_array_get(position, i)) + 0.0; // no -0
    if (!grow_table(writer, &writer->known_points, hash_of_point))
        return false;
    index_table *known = &writer->known_points;
    size_t slot = find_slot(writer, known, hash_of_numbers(&point), is_point, &point);
    if (known->slots[slot] == 0)
    {
        if (!ARRAY_ADD(writer->points, writer->point_capacity, writer->point_count, point))
            return false;
        known->slots[slot] = writer->point_count;
        known->count++;
    }
    return ARRAY_ADD(writer->places, writer->place_capacity, writer->place_count, known->slots[slot] - 1);
}

static bool add_line(topology_writer *writer, const json_t *positions, bool ring)
{
    size_t begin = writer->place_count;
    bool done = true;
    for (size_t i = 0; i < json_array_size(positions) && done; i++)
        done = add_position(writer, json_array_get(positions, i));
    const topology_line line = {begin, writer->place_count, ring, writer->objects.size};
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

/// Visit a point between two others.
static void visit(topology_point *point, size_t before, size_t after)
{
    const size_t *known = point->neighbours;
    bool same = (known[0] == before && known[1] == after) || (known[0] == after && known[1] == before);
    point->node = point->node || (point->visited && !same);
    point->met = point->met || point->visited;
    if (!point->visited)
    {
        point->neighbours[0] = before;
        point->neighbours[1] = after;
    }
    point->visited = true;
}

/// Find the nodes: ends of lines, points where lines part, and the first points of rings that have others.
static void find_nodes(topology_writer *writer)
{
    topology_point *points = writer->points;
    for (size_t i = 0; i < writer->line_count; i++)
    {
        const topology_line *line = &writer->lines[i];
        const size_t *places = writer->places;
        size_t last = line->end - 1;
        for (size_t k = line->begin + 1; k < last; k++)
            visit(&points[places[k]], places[k - 1], places[k + 1]);
        if (line->ring && last > line->begin)
            visit(&points[places[line->begin]], places[last - 1], places[line->begin + 1]);
        else
            points[places[line->begin]].node = points[places[last]].node = true;
    }
    for (size_t i = 0; i < writer->line_count; i++)
    {
        const topology_line *line = &writer->lines[i];
        bool shared = false;
        for (size_t k = line->begin; k < line->end; k++)
            shared = shared || points[writer->places[k]].met || points[writer->places[k]].node;
        points[writer->places[line->begin]].node = points[writer->places[line->begin]].node || shared;
    }
}

/// Whether an arc is stored in the reverse of its canonical direction.
static bool is_reversed(const topology_writer *writer, const topology_arc *arc)
{
    size_t low = arc->begin, high = arc->end - 1;
    while (low < high && writer->places[low] == writer->places[high])
    {
        low++;
        high--;
    }
    return writer->places[low] > writer->places[high];
}

/// Point k of an arc in its canonical direction.
static size_t point_of_arc(const topology_writer *writer, const topology_arc *arc, bool reversed, size_t k)
{
    return writer->places[reversed ? arc->end - 1 - k : arc->begin + k];
}

static uint64_t hash_of_points(const topology_writer *writer, const topology_arc *arc)
{
    uint64_t hash = HASH_BEGIN;
    bool reversed = is_reversed(writer, arc);
    for (size_t k = 0; k < arc->end - arc->begin; k++)
    {
        size_t point = point_of_arc(writer, arc, reversed, k);
        hash = hash_bytes(hash, &point, sizeof point);
    }
    return hash;
}

static uint64_t hash_of_arc(const topology_writer *writer, size_t arc)
{
    return hash_of_points(writer, &writer->arcs[arc]);
}

static bool is_arc(const topology_writer *writer, size_t entry, const void *sought)
{
    const topology_arc *a = &writer->arcs[entry], *b = sought;
    bool a_reversed = is_reversed(writer, a), b_reversed = is_reversed(writer, b);
    bool same = a->end - a->begin == b->end - b->begin;
    for (size_t k = 0; same && k < a->end - a->begin; k++)
        same = point_of_arc(writer, a, a_reversed, k) == point_of_arc(writer, b, b_reversed, k);
    return same;
}

/// Append the number of an arc, which may be known already, perhaps in the other direction.
static bool append_arc(topology_writer *writer, const topology_arc *arc)
{
    if (!grow_table(writer, &writer->known_arcs, hash_of_arc))
        return false;
    index_table *known = &writer->known_arcs;
    size_t slot = find_slot(writer, known, hash_of_points(writer, arc), is_arc, arc);
    if (known->slots[slot] == 0)
    {
        if (!ARRAY_ADD(writer->arcs, writer->arc_capacity, writer->arc_count, *arc))
            return false;
        known->slots[slot] = writer->arc_count;
        known->count++;
    }
    size_t index = known->slots[slot] - 1;
    bool turned = is_reversed(writer, &writer->arcs[index]) != is_reversed(writer, arc);
    char *out = text_reserve(&writer->text, NUMBER_TEXT_SIZE);
    if (out != NULL)
        text_advance(&writer->text, number_write_fixed(out, turned ? -(int64_t)index - 1 : (int64_t)index, 0));
    return true;
}

/// Append the arcs of a line.
static bool append_cut(topology_writer *writer, const topology_line *line)
{
    topology_arc arc = {line->begin, line->begin};
    bool done = true;
    text_append_string(&writer->text, "[");
    for (size_t k = line->begin + 1; k < line->end && done; k++)
    {
        if (k + 1 < line->end && !writer->points[writer->places[k]].node)
            continue;
        arc.end = k + 1;
        text_append_string(&writer->text, arc.begin > line->begin ? "," : "");
        done = append_arc(writer, &arc);
        arc.begin = k;
    }
    text_append_string(&writer->text, "]");
    return done;
}

static void append_positions(topology_writer *writer, const topology_arc *arc)
{
    for (size_t k = arc->begin; k < arc->end; k++)
    {
        const topology_point *point = &writer->points[writer->places[k]];
        char *out = text_reserve(&writer->text, (MAX_NUMBERS + 1) * (NUMBER_TEXT_SIZE + 1));
        if (out == NULL)
            return;
        for (size_t i = 0; i < point->count; i++)
        {
            *out++ = i > 0 ? ',' : k > arc->begin ? ',' : '[';
            if (i == 0)
                *out++ = '[';
            out = number_write(out, point->numbers[i]);
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
    bool done = true;
    find_nodes(writer);
    for (size_t i = 0; i < writer->line_count && done; i++)
    {
        text_append(&writer->text, writer->objects.data + at, writer->lines[i].text - at);
        at = writer->lines[i].text;
        done = append_cut(writer, &writer->lines[i]);
    }
    text_append(&writer->text, writer->objects.data + at, writer->objects.size - at);
    text_append_string(&writer->text, "\n]}},\"arcs\":[");
    for (size_t i = 0; i < writer->arc_count && done; i++)
    {
        text_append_string(&writer->text, i > 0 ? ",\n" : "\n");
        append_positions(writer, &writer->arcs[i]);
    }
    text_append_string(&writer->text, "\n]}\n");
    return done ? sink_write(sink, &writer->text, writer->error)
                : error_memory(writer->error, writer->arc_capacity * sizeof *writer->arcs);
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
    free(writer.places);
    free(writer.lines);
    free(writer.arcs);
    free(writer.known_points.slots);
    free(writer.known_arcs.slots);
    text_free(&writer.objects);
    text_free(&writer.text);
    return status;
}
