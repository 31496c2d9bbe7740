#pragma once

#include "batten/curve_file.h"
#include "io/common/block_writer.h"
#include "io/common/file_text.h"

#include <jansson.h>

/// @file
/// Readers and writers of curve formats. Options are complete and valid, and name the format. Sets have curves, and curves
/// have points.

/// Choose the format to write: that of the options, else of the path, else of the input; the last two may be null.
bat_status curve_format_choose(const char *path, const bat_curve_attributes *attributes,
                               const bat_curve_write_options *options, bat_curve_format *format, bat_error *error);

typedef bat_status curve_reader(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set,
                                bat_error *error);
typedef bat_status curve_writer(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink,
                                bat_error *error);

/// The reader reads TUM trajectories, too: "timestamp tx ty tz qx qy qz qw", in the space `rigid`.
curve_reader csv_read;
curve_writer csv_write;

/// The trajectory formats of the EuRoC and KITTI data sets and, to write, of TUM, in the space `rigid`.
curve_reader trajectory_read;
curve_writer trajectory_write;

curve_reader geojson_read;
/// Sequences of GeoJSON texts.
curve_reader geojson_sequence_read;
/// A collection or a sequence.
curve_writer geojson_write;
/// Receives feature number `index` as geojson_write() would write it, with measures as third or fourth numbers; for a file
/// that is a bare geometry, the geometry.
typedef bat_status geojson_taker(void *context, size_t index, const json_t *feature, bat_error *error);
/// Call `take` for one feature after the other, until it fails.
bat_status geojson_each(const bat_curve_set *set, const bat_curve_set *given, int precision, geojson_taker *take,
                        void *context, bat_error *error);

curve_reader gpx_read;
curve_writer gpx_write;

/// Well-known text (OGC 06-103r4, section 7), also with "SRID=4326;" before a geometry as PostGIS writes it.
curve_reader wkt_read;
curve_writer wkt_write;

/// Tables with a column of well-known text.
curve_reader wkt_table_read;
curve_writer wkt_table_write;
/// Whether a text is such a table.
bat_status wkt_is_table(const file_text *text, bool *is_table, bat_error *error);

curve_reader topojson_read;
curve_writer topojson_write;

curve_reader obj_read;
curve_writer obj_write;

// Texts of poses that other programs write: EuRoC and KITTI trajectories, TUM trajectories by their content, and tables
// with the names of columns that are in use. They are translated, line by line, to a TUM trajectory or to CSV with the
// names that the reader of CSV knows, so that lines keep their numbers.

/// Read a text of poses.
///
/// @param format BAT_CURVE_FORMAT_EUROC or _KITTI; _AUTO: by the content; _CSV: tables with names alone
/// @param taken  receives whether the text holds such poses; always true on failure. False leaves `set` untouched
/// @return BAT_OK; BAT_BAD_FILE with the line; BAT_INVALID_ARGUMENT; BAT_FILE_ACCESS of the times; BAT_NO_MEMORY
bat_status poses_read(const file_text *text, bat_curve_format format, const bat_curve_read_options *options,
                      bat_curve_set *set, bool *taken, bat_error *error);

/// Check the option `euler`; null passes. Returns null or an error text.
const char *poses_euler_fault(const char *euler);
