#ifndef IO_CURVE_GEOJSON_COORDINATES_H
#define IO_CURVE_GEOJSON_COORDINATES_H

#include "io/common/json_scan.h"
#include "io/curve/geojson_feature.h"

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
bat_status geojson_bad(geojson_reader *reader, const char *format, ...) __attribute__((format(printf, 2, 3)));

bat_status geojson_no_memory(geojson_reader *reader);

#endif
