#ifndef IO_CURVE_GEOJSON_FEATURE_H
#define IO_CURVE_GEOJSON_FEATURE_H

#include "io/common/json.h"
#include "base/text_buffer.h"
#include "curve/curve_attributes.h"
#include "io/curve/geojson_document.h"
#include "io/curve/builder.h"

/// Where a reader is in the file, for messages; BAT_NO_INDEX where it does not apply.
typedef struct geojson_place
{
    size_t feature, geometry, polygon, part, position;
    size_t line; ///< that the feature begins on; 0 when unknown
} geojson_place;

/// The text of a feature, or of a geometry alone, from which the coordinates of lines and polygons are lifted out: each
/// array of them is replaced by its number, [0], [1], … and its line breaks. So the parser makes no tree of them, which
/// would take many times the memory of the text. All zero: empty. It can be used again for the next text.
typedef struct geojson_extraction
{
    text_buffer text;
    const char **arrays; ///< where each array begins in the original text; they are right JSON and hold only numbers
    size_t count, capacity;
} geojson_extraction;

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
    bool extracted;      ///< the coordinates of the text that was parsed last were lifted out of it
    geojson_extraction extraction;
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

void geojson_extraction_free(geojson_extraction *extraction);

/// The geometries whose coordinates are curves.
typedef enum curve_kind
{
    CURVE_LINE,
    CURVE_LINES,
    CURVE_POLYGON,
    CURVE_POLYGONS
} curve_kind;

/// Read coordinates, which begin where the scanner is and are right JSON, into curves.
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status geojson_read_coordinates(geojson_reader *reader, curve_kind kind, json_scanner *scan);

/// BAT_BAD_FILE, with a message that begins with the reader's place.
bat_status geojson_fault(geojson_reader *reader, const char *format, ...) __attribute__((format(printf, 2, 3)));

bat_status geojson_no_memory(geojson_reader *reader);

#endif
