#include "io/curve/geojson.h"

#include "io/curve/formats.h"

#include <math.h>

/// @file
/// Reading of collections that other formats become.

const char GEOJSON_MADE_BEGIN[] = "{\"type\":\"FeatureCollection\",\"features\":[";

geojson_made geojson_made_start(void)
{
    return (geojson_made){.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
}

void geojson_made_pad(const char *at, const char **counted, text_buffer *geojson)
{
    for (; *counted < at; ++*counted)
        if (**counted == '\n')
            text_append_string(geojson, "\n");
}

static bool fits_degrees(const geojson_made *made)
{
    static const double HALF_TURN = 180, QUARTER_TURN = 90;
    return made->low[0] >= -HALF_TURN && made->high[0] <= HALF_TURN && made->low[1] >= -QUARTER_TURN &&
           made->high[1] <= QUARTER_TURN;
}

/// Tell what the file lets open. False when out of memory.
static bool note_space(const geojson_made *made, bool degrees, bat_curve_attributes *attributes)
{
    if (!degrees)
        return attributes_note(attributes, "the file names no coordinate system; its coordinates are those of a plane");
    return made->degrees ||
           attributes_note(attributes, "the file names no coordinate system; its coordinates are taken as degrees, because "
                                       "they could be (the plane takes them as they are)");
}

bat_status geojson_made_read(const geojson_made *made, text_buffer *geojson, bat_curve_format format,
                             const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_curve_read_options rest = *options;
    bool guessed = made->srid == 0 && options->space == NULL, degrees = fits_degrees(made);
    char end[96] = "]}";
    if (made->srid != 0)
        (void)snprintf(end, sizeof end, "],\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"EPSG:%d\"}}}", made->srid);
    text_append_string(geojson, end);
    if (geojson->failed)
        return error_memory(error, geojson->size);
    if (guessed)
        rest.space = degrees ? "sphere" : "plane";
    bat_curve_set read = {0};
    const file_text text = {.data = geojson->data, .size = geojson->size};
    bat_status status = geojson_read(&text, &rest, &read, error);
    if (status != BAT_OK && error != NULL && !made->lines)
        error->line = 0;
    if (status != BAT_OK)
        return status;
    geojson_document *document = read.attributes->remainder.content;
    read.attributes->format = format;
    document->measures = made->measures;
    (void)json_object_del(document->collection, "crs"); // the attributes have it
    for (size_t i = 0; !made->lines && i < document->feature_count; i++)
        document->features[i].line = 0;
    if (!guessed || note_space(made, degrees, read.attributes))
    {
        *set = read;
        return BAT_OK;
    }
    bat_curve_set_free(&read);
    return error_memory(error, geojson->size);
}
