#pragma once

#include "io/common/file_text.h"
#include "io/curve/geojson.h"

/// @file
/// Well-known text and binary of geometries, to and from GeoJSON, whose reader and writer do the rest.

/// A position in a text of geometries, and what those before it have in common.
typedef struct wkt_scanner
{
    const char *at, *end;
    const char *place;     ///< of the geometry in the file, where `at` is in another text; null else
    const file_text *text; ///< of the file, for messages
    bool binary;           ///< a geometry was well-known binary
    bool begun;            ///< there are geometries
    bool altitudes;        ///< a geometry has altitudes
    geojson_made made;     ///< with measures where a geometry has some and no altitudes
    bat_error *error;
} wkt_scanner;

wkt_scanner wkt_scanner_start(const file_text *text, bat_error *error);

/// Whether a text begins like a geometry.
bool wkt_begins(const char *begin, const char *end);

/// Read a geometry and append it as GeoJSON.
/// @return BAT_OK, BAT_BAD_FILE or BAT_UNSUPPORTED
bat_status wkt_scan_geometry(wkt_scanner *scan, text_buffer *geojson);

/// Fail at the scanner's position.
bat_status wkt_fault(const wkt_scanner *scan, const char *format, ...) __attribute__((format(printf, 2, 3)));

/// Append "SRID=25833;" for the system of a set, where it has such a number and its file had one.
void wkt_append_srid(const bat_curve_set *set, const bat_curve_write_options *options, text_buffer *text);

/// Append a geometry of GeoJSON.
void wkt_append_geometry(const json_t *geometry, bool measures, text_buffer *text);

/// The names of geometries.
extern const char *const WKT_NAMES[GEOMETRY_KINDS];

/// The numbers of the first position in an array of coordinates; 0 for none.
size_t wkt_count_numbers(const json_t *coordinates);

// Well-known binary in hexadecimal digits.

/// Whether a text has hexadecimal digits alone and begins like a geometry.
bool wkb_begins(const char *begin, const char *end);

/// Read the geometry that the scanner's text is.
bat_status wkb_scan_geometry(wkt_scanner *scan, text_buffer *geojson);

/// Append a geometry of GeoJSON. `srid` is a number in digits, or null for none.
void wkb_append_geometry(const json_t *geometry, bool measures, const char *srid, text_buffer *text);
