#pragma once

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

/// The most characters of a written time.
#define ISO_TIME_SIZE 48

/// Read YYYY-MM-DD, a T or a blank, hh:mm or hh:mm:ss with up to 9 decimals, and an optional Z, +hh:mm, +hhmm or +hh. The
/// years are 1678 to 2261. False for any other text, dates without times included.
bool iso_time_read(const char *begin, const char *end, iso_time *time);

/// Write a time in the form of another: the same offset and at least as many decimals. Times are rounded to microseconds, or
/// to the decimals of the form where these are more. Returns the end.
char *iso_time_write(char *out, const iso_time *form, int64_t nanoseconds);

// Times since 1970 with all digits: a double has nanoseconds of some months, so whole seconds are kept as an origin.

enum
{
    EXACT_TIME_DECIMALS = 9,
    EXACT_TIME_SIZE = 32
};

/// Read a time without exponent as whole nanoseconds; further decimals must be zeros. False for others, and beyond int64_t.
/// @param decimals those of seconds that the unit has: 0 for seconds, 3, 6 or 9 for milliseconds to nanoseconds
bool exact_time_read(const char *begin, const char *end, int decimals, int64_t *nanoseconds);

/// The decimals of seconds that a time's unit has by its size: times since 1970 are seconds below 1e11, milliseconds below
/// 1e14, microseconds below 1e17, else nanoseconds.
int exact_time_decimals(const char *begin, const char *end);

/// A unit's name in words, and what the name of a column gets for it: "", "_ms", "_us" or "_ns".
const char *exact_time_unit(int decimals);
const char *exact_time_suffix(int decimals);

/// The whole seconds that are kept apart for a first time: 0 for times that a double holds to the nanosecond.
int64_t exact_time_origin(int64_t nanoseconds);

/// The seconds since an origin.
double exact_time_since(int64_t nanoseconds, int64_t origin);

/// The nanoseconds of seconds since an origin. False outside of the range of int64_t.
bool exact_time_nanoseconds(int64_t origin, double seconds, int64_t *nanoseconds);

/// Write nanoseconds as seconds with nine decimals, in at most EXACT_TIME_SIZE bytes. Returns the end.
char *nanoseconds_write(char *out, int64_t nanoseconds);

/// Write the sum of an origin and seconds in a unit as of exact_time_read(). Seconds have the digits of the double where the
/// origin is 0, else nine decimals. Takes at most EXACT_TIME_SIZE bytes. Returns the end.
char *exact_time_write(char *out, int64_t origin, int decimals, double seconds);
