#include "io/geojson_feature.h"

#include "base/error.h"
#include "io/array_grow.h"
#include "io/degrees.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const size_t NOWHERE = BAT_NO_INDEX;

static void describe(char *text, size_t size, const char *what, size_t index)
{
    size_t used = strlen(text);
    if (index != NOWHERE)
        (void)snprintf(text + used, size - used, "%s%s %zu", used > 0 ? ", " : "", what, index);
}

__attribute__((format(printf, 2, 3))) static bat_status bad(geojson_reader *reader, const char *format, ...)
{
    char where[120] = "", what[160];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    describe(where, sizeof where, "feature", reader->place.feature);
    describe(where, sizeof where, "geometry", reader->place.geometry);
    describe(where, sizeof where, "polygon", reader->place.polygon);
    describe(where, sizeof where, reader->rings ? "ring" : "line", reader->place.part);
    describe(where, sizeof where, "position", reader->place.position);
    return error_set(reader->error, BAT_BAD_FILE, reader->place.position, reader->place.line, "%s%s%s", where,
                     where[0] != '\0' ? ": " : "", what);
}

static bat_status no_memory(geojson_reader *reader)
{
    return error_memory(reader->error, reader->builder.point_capacity * sizeof(double));
}

static bat_status read_position(geojson_reader *reader, const json_t *position)
{
    curve_builder *builder = &reader->builder;
    size_t count = json_array_size(position);
    if (count != 2 && count != 3)
        return bad(reader, "a position must be an array of 2 or 3 numbers");
    if (reader->number_count == 0)
        reader->number_count = count;
    if (count != reader->number_count)
        return bad(reader, "some positions of the geometry have an altitude and others not");
    double numbers[3];
    for (size_t i = 0; i < count; i++)
    {
        const json_t *number = json_array_get(position, i);
        if (!json_is_number(number))
            return bad(reader, "a position must be an array of 2 or 3 numbers");
        numbers[i] = json_number_value(number);
    }
    double *altitude;
    double *point = builder_next(builder, count - 2, &altitude);
    if (point == NULL)
        return no_memory(reader);
    const char *fault = reader->degrees ? degrees_fault(numbers[0], numbers[1]) : NULL;
    if (fault != NULL)
        return bad(reader, "%s", fault);
    if (reader->degrees)
        degrees_to_point(numbers[0], numbers[1], point);
    else
        memcpy(point, numbers, 2 * sizeof *point);
    if (count == 3)
        *altitude = numbers[2];
    fault = builder_admit(builder);
    return fault == NULL ? BAT_OK : bad(reader, "the point is %s", fault);
}

/// Read an array of positions as one curve.
static bat_status read_part(geojson_reader *reader, const json_t *positions)
{
    enum
    {
        LINE_POSITIONS = 2,
        RING_POSITIONS = 4 ///< also the fewest of a line that is a closed curve
    };
    size_t count = json_array_size(positions);
    if (!json_is_array(positions))
        return bad(reader, "the positions must be an array");
    if (count < (reader->rings ? RING_POSITIONS : LINE_POSITIONS))
        return bad(reader, "a %s needs at least %d positions", reader->rings ? "ring" : "line",
                   reader->rings ? RING_POSITIONS : LINE_POSITIONS);
    for (size_t i = 0; i < count; i++)
    {
        reader->place.position = i;
        bat_status status = read_position(reader, json_array_get(positions, i));
        if (status != BAT_OK)
            return status;
    }
    reader->place.position = NOWHERE;
    bool returns = builder_returns(&reader->builder);
    if (reader->rings && !returns)
        return bad(reader, "the last position of a ring must repeat the first");
    bool closed = reader->rings || (reader->closed < 0 ? returns && count >= RING_POSITIONS : reader->closed > 0);
    if (closed && returns)
        builder_drop_last(&reader->builder);
    return builder_end_curve(&reader->builder, closed) ? BAT_OK : no_memory(reader);
}

static bat_status read_parts(geojson_reader *reader, const json_t *parts)
{
    if (!json_is_array(parts) || json_array_size(parts) == 0)
        return bad(reader, "the coordinates must be an array of arrays of positions");
    bat_status status = BAT_OK;
    for (size_t i = 0; i < json_array_size(parts) && status == BAT_OK; i++)
    {
        reader->place.part = i;
        status = read_part(reader, json_array_get(parts, i));
    }
    if (status == BAT_OK)
        reader->place.part = NOWHERE;
    return status;
}

static bat_status read_polygon(geojson_reader *reader, const json_t *rings)
{
    geojson_document *document = &reader->document;
    void *counts = document->ring_counts;
    bool grown =
        array_grow(&counts, &document->polygon_capacity, document->polygon_count + 1, sizeof *document->ring_counts);
    document->ring_counts = counts;
    if (!grown)
        return no_memory(reader);
    document->ring_counts[document->polygon_count++] = json_array_size(rings);
    return read_parts(reader, rings);
}

static bat_status read_polygons(geojson_reader *reader, const json_t *polygons)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < json_array_size(polygons) && status == BAT_OK; i++)
    {
        reader->place.polygon = i;
        status = read_polygon(reader, json_array_get(polygons, i));
    }
    if (status == BAT_OK)
        reader->place.polygon = NOWHERE;
    return status;
}

typedef enum geometry_kind
{
    KIND_LINE,
    KIND_LINES,
    KIND_POLYGON,
    KIND_POLYGONS,
    KIND_COLLECTION,
    KIND_OTHER, ///< points, which stay as they are
    KIND_UNKNOWN
} geometry_kind;

static geometry_kind kind_of(const json_t *geometry)
{
    static const struct
    {
        const char *name;
        geometry_kind kind;
    } kinds[] = {{"LineString", KIND_LINE},       {"MultiLineString", KIND_LINES},         {"Polygon", KIND_POLYGON},
                 {"MultiPolygon", KIND_POLYGONS}, {"GeometryCollection", KIND_COLLECTION}, {"Point", KIND_OTHER},
                 {"MultiPoint", KIND_OTHER}};
    const char *type = json_string_value(json_object_get(geometry, "type"));
    for (size_t i = 0; type != NULL && i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(type, kinds[i].name) == 0)
            return kinds[i].kind;
    return KIND_UNKNOWN;
}

static bat_status read_coordinates(geojson_reader *reader, geometry_kind kind, const json_t *coordinates)
{
    reader->rings = kind == KIND_POLYGON || kind == KIND_POLYGONS;
    reader->number_count = 0;
    switch (kind)
    {
    case KIND_LINE:
        return read_part(reader, coordinates);
    case KIND_LINES:
        return read_parts(reader, coordinates);
    case KIND_POLYGON:
        return read_polygon(reader, coordinates);
    default:
        return read_polygons(reader, coordinates);
    }
}

/// Turn the coordinates of a geometry into curves, and put the geometry's index in their place.
static bat_status take_geometry(geojson_reader *reader, geometry_kind kind, json_t *geometry)
{
    geojson_document *document = &reader->document;
    geojson_feature *feature = &document->features[document->feature_count - 1];
    const json_t *coordinates = json_object_get(geometry, "coordinates");
    if (!json_is_array(coordinates))
        return bad(reader, "the geometry has no array of coordinates");
    if (json_array_size(coordinates) == 0)
        return BAT_OK;
    geojson_geometry taken = {.curve = reader->builder.curve_count - feature->curve,
                              .polygon = document->polygon_count - feature->polygon};
    bat_status status = read_coordinates(reader, kind, coordinates);
    if (status != BAT_OK)
        return status;
    taken.curve_count = reader->builder.curve_count - feature->curve - taken.curve;
    taken.polygon_count = document->polygon_count - feature->polygon - taken.polygon;
    void *geometries = document->geometries;
    bool grown = array_grow(&geometries, &document->geometry_capacity, document->geometry_count + 1, sizeof taken);
    document->geometries = geometries;
    json_int_t index = (json_int_t)(document->geometry_count - feature->geometry);
    if (!grown || json_object_set_new(geometry, "coordinates", json_integer(index)) != 0)
        return no_memory(reader);
    document->geometries[document->geometry_count++] = taken;
    return BAT_OK;
}

static bat_status read_geometry(geojson_reader *reader, json_t *geometry)
{
    geometry_kind kind = kind_of(geometry);
    if (kind == KIND_UNKNOWN)
        return bad(reader, json_is_object(geometry) ? "the geometry has no type that GeoJSON knows"
                                                    : "the geometry must be an object");
    if (kind == KIND_OTHER)
        return BAT_OK;
    if (kind != KIND_COLLECTION)
        return take_geometry(reader, kind, geometry);
    const json_t *members = json_object_get(geometry, "geometries");
    if (!json_is_array(members))
        return bad(reader, "a GeometryCollection needs an array of geometries");
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
    void *features = document->features;
    bool grown = array_grow(&features, &document->feature_capacity, document->feature_count + 1, sizeof(geojson_feature));
    document->features = features;
    if (!grown)
    {
        json_decref(tree);
        return no_memory(reader);
    }
    geojson_feature *feature = &document->features[document->feature_count++];
    *feature = (geojson_feature){.tree = tree,
                                 .line = reader->place.line,
                                 .curve = reader->builder.curve_count,
                                 .geometry = document->geometry_count,
                                 .polygon = document->polygon_count};
    if (!bare_geometry && !geojson_has_type(tree, "Feature"))
        return bad(reader, "it must be an object of the type Feature");
    json_t *geometry = bare_geometry ? tree : json_object_get(tree, "geometry");
    if (geometry == NULL)
        return bad(reader, "the feature has no geometry");
    bat_status status = json_is_null(geometry) ? BAT_OK : read_geometry(reader, geometry);
    feature->curve_count = reader->builder.curve_count - feature->curve;
    feature->geometry_count = document->geometry_count - feature->geometry;
    feature->polygon_count = document->polygon_count - feature->polygon;
    return status;
}

json_t *geojson_parse(geojson_reader *reader, const char *text, size_t size, size_t first_line)
{
    json_error_t fault;
    json_t *tree = json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_ALLOW_NUL, &fault);
    if (tree == NULL && json_error_code(&fault) == json_error_out_of_memory)
        (void)error_memory(reader->error, size);
    else if (tree == NULL)
    {
        for (char *c = fault.text; *c != '\0'; c++)
            *c = *c >= ' ' && *c <= '~' ? *c : '?';
        size_t line = fault.line > 0 ? first_line + (size_t)fault.line - 1 : first_line;
        (void)error_set(reader->error, BAT_BAD_FILE, BAT_NO_INDEX, line, "%s", fault.text);
    }
    return tree;
}

geojson_reader geojson_reader_start(const bat_space *space, const bat_read_options *options, bat_error *error)
{
    bool sphere = strcmp(space->name, "sphere") == 0;
    return (geojson_reader){.closed = options->closed,
                            .degrees = sphere,
                            .builder = {.space = *space, .project = options->project, .check = !sphere},
                            .place = {NOWHERE, NOWHERE, NOWHERE, NOWHERE, NOWHERE, 0},
                            .error = error};
}

void geojson_reader_free(geojson_reader *reader)
{
    builder_free(&reader->builder);
    geojson_document_free(&reader->document);
}
