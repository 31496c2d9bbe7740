#include "io/common/exact_time.h"

#include "io/common/number_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static const int64_t BILLION = 1000000000;
/// Nanoseconds that doubles of seconds hold exactly, and the largest seconds of a double beside an origin.
static const int64_t EXACT = 1000000000000000;
static const double LONGEST = 9e9;

bool exact_time_read(const char *begin, const char *end, int64_t *nanoseconds)
{
    bool negative = begin < end && *begin == '-', point = false;
    uint64_t made = 0;
    int decimals = 0, digits = 0;
    for (const char *at = begin + negative; at < end; at++)
    {
        if (*at == '.' && !point)
        {
            point = true;
            continue;
        }
        if (*at < '0' || *at > '9' || (point && decimals == EXACT_TIME_DECIMALS))
            return false;
        if (__builtin_mul_overflow(made, (uint64_t)10, &made) || __builtin_add_overflow(made, (uint64_t)(*at - '0'), &made))
            return false;
        decimals += point ? 1 : 0;
        digits++;
    }
    for (; decimals < EXACT_TIME_DECIMALS; decimals++)
        if (__builtin_mul_overflow(made, (uint64_t)10, &made))
            return false;
    if (digits == 0 || made > INT64_MAX)
        return false;
    *nanoseconds = negative ? -(int64_t)made : (int64_t)made;
    return true;
}

/// The largest whole number of seconds up to a time.
static int64_t whole_seconds(int64_t nanoseconds)
{
    return nanoseconds / BILLION - (nanoseconds % BILLION < 0 ? 1 : 0);
}

int64_t exact_time_origin(int64_t nanoseconds)
{
    return nanoseconds > -EXACT && nanoseconds < EXACT ? 0 : whole_seconds(nanoseconds);
}

double exact_time_since(int64_t nanoseconds, int64_t origin)
{
    int64_t seconds = whole_seconds(nanoseconds), part = nanoseconds - seconds * BILLION, apart = seconds - origin;
    // One rounding where the nanoseconds fit a double.
    if (apart > -EXACT / BILLION && apart < EXACT / BILLION)
        return (double)(apart * BILLION + part) / (double)BILLION;
    return (double)apart + (double)part / (double)BILLION;
}

bool exact_time_nanoseconds(int64_t origin, double seconds, int64_t *nanoseconds)
{
    double whole = floor(seconds);
    if (!(fabs(seconds) < LONGEST) || origin > (int64_t)LONGEST || origin < -(int64_t)LONGEST)
        return false;
    int64_t sum = origin + (int64_t)whole;
    return !__builtin_mul_overflow(sum, BILLION, nanoseconds) &&
           !__builtin_add_overflow(*nanoseconds, (int64_t)llround((seconds - whole) * (double)BILLION), nanoseconds);
}

char *exact_time_write(char *out, int64_t origin, double seconds)
{
    int64_t nanoseconds;
    if (origin == 0)
        return number_write(out, seconds);
    if (!exact_time_nanoseconds(origin, seconds, &nanoseconds))
        return number_write(out, (double)origin + seconds);
    uint64_t positive = nanoseconds < 0 ? 0 - (uint64_t)nanoseconds : (uint64_t)nanoseconds;
    // With all nine decimals, so that a reader finds that they matter.
    return out + snprintf(out, EXACT_TIME_SIZE, "%s%" PRIu64 ".%09" PRIu64, nanoseconds < 0 ? "-" : "",
                          positive / (uint64_t)BILLION, positive % (uint64_t)BILLION);
}
