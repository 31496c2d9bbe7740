#ifndef IO_CURVE_FORMATS_H
#define IO_CURVE_FORMATS_H

#include "batten/curve_file.h"
#include "io/common/block_writer.h"
#include "io/common/file_text.h"

#include <jansson.h>

/// @file
/// Readers and writers of curve formats. Options are complete and valid. Sets have curves, and curves have points.

/// Choose the format to write: that of the options, else that of the path, which may be null, else that of the input, whose
/// attributes may be null.
bat_status curve_format_choose(const char *path, const bat_curve_attributes *attributes,
                               const bat_curve_write_options *options, bat_curve_format *format, bat_error *error);

bat_status csv_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error);
bat_status csv_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error);

/// The trajectory format of the TUM RGB-D benchmark: "timestamp tx ty tz qx qy qz qw", in the space `rigid`.
bat_status tum_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error);
bat_status tum_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error);

/// The trajectory formats of the EuRoC and KITTI data sets, in the space `rigid`.
bat_status euroc_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error);
bat_status euroc_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error);
bat_status kitti_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error);
bat_status kitti_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error);

bat_status geojson_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error);
bat_status geojson_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink,
                         bat_error *error);

/// Sequences of GeoJSON texts.
bat_status geojson_sequence_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set,
                                 bat_error *error);
bat_status geojson_lines_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink,
                               bat_error *error);
bat_status geojson_sequence_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink,
                                  bat_error *error);
/// Receives feature number `index` as geojson_write() would write it, with measures as third or fourth numbers; for a file
/// that is a bare geometry, the geometry.
typedef bat_status geojson_taker(void *context, size_t index, const json_t *feature, bat_error *error);
/// Call `take` for one feature after the other, until it fails.
bat_status geojson_each(const bat_curve_set *set, int precision, geojson_taker *take, void *context, bat_error *error);

bat_status obj_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error);
bat_status obj_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error);

#endif
