#ifndef IO_CURVE_GEOJSON_FEATURE_H
#define IO_CURVE_GEOJSON_FEATURE_H

#include "io/curve/curve_builder.h"
#include "io/curve/geojson_document.h"
#include "io/curve/geojson_lift.h"

/// Where a reader is in the file, for messages; BAT_NO_INDEX where it does not apply.
typedef struct geojson_place
{
    size_t feature, geometry, polygon, part, position;
    size_t line; ///< that the feature begins on; 0 when unknown
} geojson_place;

/// Reads features into curves and what is left of them. Threads have one each.
typedef struct geojson_reader
{
    int closed;   ///< as in bat_curve_read_options
    bool degrees; ///< positions are degrees, else plain coordinates
    curve_builder builder;
    geojson_document document;
    geojson_place place;
    bool rings;          ///< the parts of this geometry are rings, not lines
    size_t number_count; ///< in each position of this geometry; 0 before the first
    bool lifted;         ///< the coordinates of the text that was parsed last were lifted out of it
    geojson_lift lift;
    const char *text_end; ///< of that text
    bat_error *error;     ///< receives what went wrong; may be null
} geojson_reader;

/// A reader at the beginning of a file that is not a collection.
geojson_reader geojson_reader_start(const bat_space *space, const bat_curve_read_options *options, bat_error *error);

/// Parse JSON that begins on a line of the file, and lift the coordinates out of it, so that the text must stay until they
/// are read. Null after a failure, which the reader's error tells.
json_t *geojson_parse(geojson_reader *reader, const char *begin, const char *end, size_t first_line);

/// Read a feature, or a geometry that stands for one, from what geojson_parse() gave last. The reader's document takes the
/// tree, also on failure.
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status geojson_read_feature(geojson_reader *reader, json_t *tree, bool bare_geometry);

/// Whether an object is of a type.
bool geojson_has_type(const json_t *object, const char *type);

void geojson_reader_free(geojson_reader *reader);

#endif
