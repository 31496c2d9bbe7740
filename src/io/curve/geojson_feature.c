#include "io/curve/geojson_feature.h"

#include "base/array_grow.h"
#include "base/json_parse.h"
#include "io/common/json_text.h"
#include "io/curve/geojson_coordinates.h"

#include <string.h>

typedef enum geometry_kind
{
    KIND_LINE = CURVE_LINE,
    KIND_LINES = CURVE_LINES,
    KIND_POLYGON = CURVE_POLYGON,
    KIND_POLYGONS = CURVE_POLYGONS,
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

/// Read coordinates from where they were lifted from or, where they are in the tree, from text that is made of them.
static bat_status read_coordinates(geojson_reader *reader, curve_kind kind, const json_t *coordinates)
{
    const json_t *number = json_array_get(coordinates, 0);
    if (reader->lifted && json_array_size(coordinates) == 1 && json_is_integer(number))
    {
        json_scanner scan = {reader->lift.arrays[json_integer_value(number)], reader->text_end};
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

/// Turn the coordinates of a geometry into curves, and put the geometry's index in their place.
static bat_status take_geometry(geojson_reader *reader, geometry_kind kind, json_t *geometry)
{
    geojson_document *document = &reader->document;
    geojson_feature *feature = &document->features[document->feature_count - 1];
    const json_t *coordinates = json_object_get(geometry, "coordinates");
    if (!json_is_array(coordinates))
        return geojson_bad(reader, "the geometry has no array of coordinates");
    if (json_array_size(coordinates) == 0)
        return BAT_OK;
    geojson_geometry taken = {.curve = reader->builder.curve_count - feature->curve,
                              .polygon = document->polygon_count - feature->polygon};
    bat_status status = read_coordinates(reader, (curve_kind)kind, coordinates);
    if (status != BAT_OK)
        return status;
    taken.curve_count = reader->builder.curve_count - feature->curve - taken.curve;
    taken.polygon_count = document->polygon_count - feature->polygon - taken.polygon;
    void *geometries = document->geometries;
    bool grown = array_grow(&geometries, &document->geometry_capacity, document->geometry_count + 1, sizeof taken);
    document->geometries = geometries;
    json_int_t index = (json_int_t)(document->geometry_count - feature->geometry);
    if (!grown || json_object_set_new(geometry, "coordinates", json_integer(index)) != 0)
        return geojson_no_memory(reader);
    document->geometries[document->geometry_count++] = taken;
    return BAT_OK;
}

static bat_status read_geometry(geojson_reader *reader, json_t *geometry)
{
    geometry_kind kind = kind_of(geometry);
    if (kind == KIND_UNKNOWN)
        return geojson_bad(reader, json_is_object(geometry) ? "the geometry has no type that GeoJSON knows"
                                                            : "the geometry must be an object");
    if (kind == KIND_OTHER)
        return BAT_OK;
    if (kind != KIND_COLLECTION)
        return take_geometry(reader, kind, geometry);
    const json_t *members = json_object_get(geometry, "geometries");
    if (!json_is_array(members))
        return geojson_bad(reader, "a GeometryCollection needs an array of geometries");
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
        return geojson_no_memory(reader);
    }
    geojson_feature *feature = &document->features[document->feature_count++];
    *feature = (geojson_feature){.tree = tree,
                                 .line = reader->place.line,
                                 .curve = reader->builder.curve_count,
                                 .geometry = document->geometry_count,
                                 .polygon = document->polygon_count};
    if (!bare_geometry && !geojson_has_type(tree, "Feature"))
        return geojson_bad(reader, "it must be an object of the type Feature");
    json_t *geometry = bare_geometry ? tree : json_object_get(tree, "geometry");
    if (geometry == NULL)
        return geojson_bad(reader, "the feature has no geometry");
    bat_status status = json_is_null(geometry) ? BAT_OK : read_geometry(reader, geometry);
    feature->curve_count = reader->builder.curve_count - feature->curve;
    feature->geometry_count = document->geometry_count - feature->geometry;
    feature->polygon_count = document->polygon_count - feature->polygon;
    return status;
}

json_t *geojson_parse(geojson_reader *reader, const char *begin, const char *end, size_t first_line)
{
    json_t *tree = NULL;
    reader->lifted = geojson_lift_text(&reader->lift, begin, end);
    reader->text_end = end;
    const char *text = reader->lifted ? reader->lift.text.data : begin;
    size_t size = reader->lifted ? reader->lift.text.size : (size_t)(end - begin);
    (void)json_parse(text, size, JSON_ALLOW_NUL, first_line, &tree, reader->error);
    return tree;
}

geojson_reader geojson_reader_start(const bat_space *space, const bat_curve_read_options *options, bat_error *error)
{
    bool sphere = strcmp(space->name, "sphere") == 0;
    return (geojson_reader){.closed = options->closed,
                            .degrees = sphere,
                            .builder = {.space = *space, .project = options->project, .check = !sphere},
                            .place = {BAT_NO_INDEX, BAT_NO_INDEX, BAT_NO_INDEX, BAT_NO_INDEX, BAT_NO_INDEX, 0},
                            .error = error};
}

void geojson_reader_free(geojson_reader *reader)
{
    builder_free(&reader->builder);
    geojson_document_free(&reader->document);
    geojson_lift_free(&reader->lift);
}
