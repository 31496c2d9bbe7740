#include "io/curve/wkt.h"

#include "base/error.h"
#include "io/common/number_text.h"
#include "io/curve/formats.h"

/// @file
/// Writer of well-known text.

static const char *const NAMES[GEOMETRY_KINDS] = {[GEOMETRY_POINT] = "POINT",
                                                  [GEOMETRY_LINE] = "LINESTRING",
                                                  [GEOMETRY_POLYGON] = "POLYGON",
                                                  [GEOMETRY_POINTS] = "MULTIPOINT",
                                                  [GEOMETRY_LINES] = "MULTILINESTRING",
                                                  [GEOMETRY_POLYGONS] = "MULTIPOLYGON",
                                                  [GEOMETRY_COLLECTION] = "GEOMETRYCOLLECTION"};

/// The numbers of the first position in an array; 0 for none.
static size_t count_numbers(const json_t *coordinates)
{
    size_t count = 0;
    if (json_is_number(json_array_get(coordinates, 0)))
        return json_array_size(coordinates);
    for (size_t i = 0; i < json_array_size(coordinates) && count == 0; i++)
        count = count_numbers(json_array_get(coordinates, i));
    return count;
}

static void append_coordinates(const json_t *value, text_buffer *text)
{
    bool position = json_is_number(json_array_get(value, 0));
    text_append_string(text, position ? "" : "(");
    for (size_t i = 0; i < json_array_size(value); i++)
    {
        const json_t *part = json_array_get(value, i);
        text_append_string(text, i == 0 ? "" : position ? " " : ",");
        if (position)
            text_append_real(text, "", json_number_value(part));
        else
            append_coordinates(part, text);
    }
    text_append_string(text, position ? "" : ")");
}

void wkt_append_geometry(const json_t *geometry, bool measures, text_buffer *text)
{
    geometry_kind kind = geojson_kind(geometry);
    const json_t *coordinates = json_object_get(geometry, "coordinates"), *members = json_object_get(geometry, "geometries");
    size_t numbers = count_numbers(coordinates);
    if (kind == GEOMETRY_UNKNOWN)
        kind = GEOMETRY_COLLECTION; // for null
    text_append_string(text, NAMES[kind]);
    text_append_string(text, numbers > 3 ? " ZM" : numbers == 3 && measures ? " M" : numbers == 3 ? " Z" : "");
    if (numbers == 0 && json_array_size(members) == 0)
    {
        text_append_string(text, " EMPTY");
        return;
    }
    text_append_string(text, " ");
    if (kind == GEOMETRY_POINT || kind == GEOMETRY_COLLECTION)
        text_append_string(text, "(");
    if (kind != GEOMETRY_COLLECTION)
        append_coordinates(coordinates, text);
    for (size_t i = 0; i < json_array_size(members); i++)
    {
        text_append_string(text, i > 0 ? "," : "");
        wkt_append_geometry(json_array_get(members, i), measures, text);
    }
    if (kind == GEOMETRY_POINT || kind == GEOMETRY_COLLECTION)
        text_append_string(text, ")");
}

void wkt_append_srid(const bat_curve_set *set, const bat_curve_write_options *options, text_buffer *text)
{
    static const char prefix[] = "EPSG:";
    const bat_curve_attributes *attributes = set->attributes;
    const char *crs = options->crs != NULL ? options->crs : attributes != NULL ? attributes->crs : NULL;
    if (crs == NULL || strncmp(crs, prefix, sizeof prefix - 1) != 0)
        return;
    text_append_string(text, "SRID=");
    text_append_string(text, crs + sizeof prefix - 1);
    text_append_string(text, ";");
}

typedef struct wkt_writer
{
    text_buffer text, srid;
    bool measures;
    text_sink *sink;
} wkt_writer;

static bat_status take_feature(void *context, size_t index, const json_t *feature, bat_error *error)
{
    wkt_writer *writer = context;
    (void)index;
    writer->text.size = 0;
    text_append(&writer->text, writer->srid.data, writer->srid.size);
    wkt_append_geometry(geojson_has_type(feature, "Feature") ? json_object_get(feature, "geometry") : feature,
                        writer->measures, &writer->text);
    text_append_string(&writer->text, "\n");
    return sink_write(writer->sink, &writer->text, error);
}

bat_status wkt_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    const bat_curve_attributes *attributes = set->attributes;
    const geojson_document *document = attributes_are_geojson(attributes) ? attributes->remainder.content : NULL;
    wkt_writer writer = {.measures = document != NULL && document->measures, .sink = sink};
    wkt_append_srid(set, options, &writer.srid);
    bat_status status = geojson_each(set, options->given, options->precision, take_feature, &writer, error);
    text_free(&writer.text);
    text_free(&writer.srid);
    return status;
}
