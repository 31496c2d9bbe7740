#ifndef BATTEN_MOTION_FILE_H
#define BATTEN_MOTION_FILE_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Files of motions beyond those of curves: times to sample at.

/// Read increasing times: a number a line. Blank lines, lines that begin with # and a first line of "time" are skipped.
///
/// @param path  "-" is standard input
/// @param times receives `count` numbers, at least one; release them with free()
/// @param error its `line` is that of the failure
/// @return BAT_OK, BAT_BAD_FILE (no number, more than one in a line, a time that does not come after the one before),
///         BAT_FILE_ACCESS or BAT_NO_MEMORY; `times` is untouched on failure
BAT_API bat_status bat_motion_times_read(const char *path, double **times, size_t *count, bat_error *error);

BAT_C_END

#endif
