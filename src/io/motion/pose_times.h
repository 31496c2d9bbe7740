#ifndef IO_MOTION_POSE_TIMES_H
#define IO_MOTION_POSE_TIMES_H

#include "io/common/iso_time.h"
#include "io/curve/csv_split.h"
#include "io/motion/pose_names.h"

/// @file
/// The times of poses: seconds, their decimal parts, seconds with nanoseconds, and ISO 8601.

enum
{
    POSE_TIME_SIZE = 64
};

/// What is known of the times of a text.
typedef struct pose_clock
{
    bool begun;
    int64_t origin;                ///< whole seconds that translated times lack; see exact_time_origin()
    char first[ISO_TIME_SIZE + 1]; ///< the first time, where times are those of ISO 8601; else empty
} pose_clock;

/// A whole number within int64_t.
bool pose_read_whole(csv_field cell, int64_t *value);
/// The text of a time in seconds since the clock's origin. Returns null, or an error text.
const char *pose_time_write(pose_clock *clock, csv_field cell, char separator, column_unit unit, char *out, size_t size);
/// The same of seconds and nanoseconds in two columns.
const char *pose_time_write_split(pose_clock *clock, csv_field seconds, csv_field nanoseconds, char *out, size_t size);
/// The unit of whole times that are too large for seconds since 1970.
column_unit pose_unit_by_size(csv_field cell);

#endif
