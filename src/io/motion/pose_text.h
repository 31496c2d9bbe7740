#ifndef IO_MOTION_POSE_TEXT_H
#define IO_MOTION_POSE_TEXT_H

#include "batten/curve_file.h"
#include "io/common/file_text.h"

/// @file
/// Texts of poses that other programs write: EuRoC and KITTI trajectories, TUM trajectories by their content, and tables
/// with the names of columns that are in use. They are translated, line by line, to a TUM trajectory or to CSV with the
/// names that the reader of CSV knows, so that lines keep their numbers.

/// Read a text of poses.
///
/// @param format BAT_CURVE_FORMAT_EUROC or _KITTI; _AUTO: by the content; _CSV: tables with names alone
/// @param taken  receives whether the text holds such poses; always true on failure. False leaves `set` untouched
/// @return BAT_OK; BAT_BAD_FILE with the line; BAT_INVALID_ARGUMENT; BAT_FILE_ACCESS of the times; BAT_NO_MEMORY
bat_status poses_read(const file_text *text, bat_curve_format format, const bat_curve_read_options *options,
                      bat_curve_set *set, bool *taken, bat_error *error);

/// Check the option `euler`; null passes. Returns null or an error text.
const char *poses_euler_fault(const char *euler);

#endif
