#ifndef IO_CURVE_GEOJSON_SEQUENCE_H
#define IO_CURVE_GEOJSON_SEQUENCE_H

#include "io/common/block_writer.h"
#include "io/curve/geojson_feature.h"

/// @file
/// Sequences of GeoJSON texts: RFC 8142, where a record separator begins each record, and a record a line.

/// The record separator of RFC 8142.
#define RECORD_SEPARATOR '\x1e'

/// A position in a sequence. Blank lines and empty records are skipped.
typedef struct record_scan
{
    const char *at, *end; ///< the byte at `end` is readable
    size_t line;          ///< the line of `at`, counted from 1
    bool separated;       ///< by record separators, else by line breaks
} record_scan;

/// The start of a sequence, or of its next part: `separated` where the first byte that is not blank is a separator.
record_scan record_scan_start(const char *text, size_t size, size_t line);

/// Advance behind the next record. `whole`: the text does not go on after its end, where the last record needs no line break
/// or separator. False, without moving, when there is no complete record.
bool record_scan_next(record_scan *scan, bool whole, feature_text *record);

/// Write the features of a set as a part of a collection or of a sequence. In a collection a comma stands before each
/// feature but the first one of the part with `first`.
bat_status geojson_part_write(const bat_curve_set *set, bat_curve_format format, bool first,
                              const bat_curve_write_options *options, text_sink *sink, bat_error *error);

/// What stands before and after the features of a collection.
extern const char GEOJSON_COLLECTION_BEGIN[], GEOJSON_COLLECTION_END[];

/// Whether a text that begins with a separator or a brace is a sequence of several records.
bool geojson_is_sequence(const char *text, size_t size);

#endif
