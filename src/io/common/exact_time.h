#ifndef IO_COMMON_EXACT_TIME_H
#define IO_COMMON_EXACT_TIME_H

#include "batten/base.h"

/// @file
/// Times since 1970 with all of their digits: a double has room for nanoseconds of some months alone, so whole seconds are
/// kept apart, as an origin.

enum
{
    EXACT_TIME_DECIMALS = 9,
    EXACT_TIME_SIZE = 32
};

/// Read seconds with at most nine decimals and no exponent as whole nanoseconds. False for other texts, and outside of the
/// range of int64_t.
bool exact_time_read(const char *begin, const char *end, int64_t *nanoseconds);

/// The whole seconds that are kept apart for a first time: 0 for times that a double holds to the nanosecond.
int64_t exact_time_origin(int64_t nanoseconds);

/// The seconds since an origin.
double exact_time_since(int64_t nanoseconds, int64_t origin);

/// The nanoseconds of seconds since an origin. False outside of the range of int64_t.
bool exact_time_nanoseconds(int64_t origin, double seconds, int64_t *nanoseconds);

/// Write the sum of an origin and seconds, with the digits of the double where the origin is 0, else with nine decimals.
/// Takes at most EXACT_TIME_SIZE bytes. Returns the end.
char *exact_time_write(char *out, int64_t origin, double seconds);

#endif
