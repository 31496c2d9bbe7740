#ifndef IO_COMMON_ISO_TIME_H
#define IO_COMMON_ISO_TIME_H

#include "batten/base.h"

/// @file
/// Dates with times of day in the form of ISO 8601 (RFC 3339, section 5.6), and their text.

/// A time, and how it was written.
typedef struct iso_time
{
    int64_t nanoseconds; ///< since 1970-01-01T00:00:00Z; a time without an offset counts as UTC
    int decimals;        ///< of the seconds, 0 to 9
    bool has_seconds;
    char between;     ///< of date and time: 'T', 't' or a blank
    int zone_minutes; ///< east of UTC
    char zone[8];     ///< as written: "", "Z", "+02:00", …
} iso_time;

enum
{
    /// The most characters of a written time.
    ISO_TIME_SIZE = 48
};

/// Read YYYY-MM-DD, a T or a blank, hh:mm or hh:mm:ss with up to 9 decimals, and an optional Z, +hh:mm, +hhmm or +hh. The
/// years are 1678 to 2261. False for any other text, dates without times included.
bool iso_time_read(const char *begin, const char *end, iso_time *time);

/// Write a time in the form of another: the same offset and at least as many decimals. Times are rounded to microseconds, or
/// to the decimals of the form where these are more. Returns the end.
char *iso_time_write(char *out, const iso_time *form, int64_t nanoseconds);

#endif
