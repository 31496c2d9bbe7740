#include "io/common/time_text.h"

#include "io/common/number_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

/// @file
/// ISO 8601 times in the proleptic Gregorian calendar.

enum
{
    /// Decimals of interpolated times.
    NEW_DECIMALS = 6,
    FIRST_YEAR = 1678, ///< 64 bits of nanoseconds reach from 1677 to 2262
    LAST_YEAR = 2261
};

static const int64_t SECOND = 1000000000, MINUTE = 60000000000, DAY = 86400000000000;

static bool read_digits(const char **at, const char *end, int count, int *value)
{
    *value = 0;
    for (int i = 0; i < count; i++, ++*at)
    {
        if (*at == end || **at < '0' || **at > '9')
            return false;
        *value = 10 * *value + (**at - '0');
    }
    return true;
}

static bool read_mark(const char **at, const char *end, char mark)
{
    if (*at == end || **at != mark)
        return false;
    ++*at;
    return true;
}

/// Days since 1970-01-01 (Richards 2013, "Calendars", in the Explanatory Supplement: years begin in March).
static int64_t days_of_date(int year, int month, int day)
{
    int64_t shifted = month <= 2 ? year - 1 : year, era = shifted / 400, of_era = shifted % 400;
    int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

static void date_of_days(int64_t days, int *year, int *month, int *day)
{
    int64_t shifted = days + 719468, era = shifted / 146097, rest = shifted % 146097;
    int64_t of_era = (rest - rest / 1460 + rest / 36524 - rest / 146096) / 365;
    int64_t of_year = rest - (365 * of_era + of_era / 4 - of_era / 100), part = (5 * of_year + 2) / 153;
    *day = (int)(of_year - (153 * part + 2) / 5 + 1);
    *month = (int)(part < 10 ? part + 3 : part - 9);
    *year = (int)(400 * era + of_era + (*month <= 2 ? 1 : 0));
}

static int month_length(int year, int month)
{
    static const int lengths[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    return lengths[month - 1] + (month == 2 && leap ? 1 : 0);
}

static bool read_date(const char **at, const char *end, int64_t *days)
{
    int year, month, day;
    if (!read_digits(at, end, 4, &year) || !read_mark(at, end, '-') || !read_digits(at, end, 2, &month) ||
        !read_mark(at, end, '-') || !read_digits(at, end, 2, &day))
        return false;
    if (year < FIRST_YEAR || year > LAST_YEAR || month < 1 || month > 12 || day < 1 || day > month_length(year, month))
        return false;
    *days = days_of_date(year, month, day);
    return true;
}

/// The seconds with their decimals, in nanoseconds.
static bool read_seconds(const char **at, const char *end, iso_time *time, int64_t *nanoseconds)
{
    int seconds;
    if (!read_digits(at, end, 2, &seconds) || seconds > 59)
        return false;
    *nanoseconds = seconds * SECOND;
    time->has_seconds = true;
    if (*at == end || (**at != '.' && **at != ','))
        return true;
    int64_t unit = SECOND;
    for (++*at; *at < end && **at >= '0' && **at <= '9' && time->decimals < EXACT_TIME_DECIMALS; ++*at, time->decimals++)
    {
        unit /= 10;
        *nanoseconds += (**at - '0') * unit;
    }
    return time->decimals > 0;
}

static bool read_zone(const char *at, const char *end, iso_time *time)
{
    size_t length = (size_t)(end - at);
    if (length >= sizeof time->zone)
        return false;
    memcpy(time->zone, at, length);
    time->zone[length] = '\0';
    if (length == 0 || (length == 1 && (*at == 'Z' || *at == 'z')))
        return true;
    int hours, minutes = 0;
    bool west = *at == '-';
    if ((!west && *at != '+') || (++at, !read_digits(&at, end, 2, &hours)))
        return false;
    if (at < end && ((*at == ':' && ++at == end) || !read_digits(&at, end, 2, &minutes)))
        return false;
    time->zone_minutes = (west ? -1 : 1) * (60 * hours + minutes);
    return at == end && hours <= 23 && minutes <= 59;
}

bool iso_time_read(const char *begin, const char *end, iso_time *time)
{
    int64_t days, seconds = 0;
    int hours, minutes;
    const char *at = begin;
    *time = (iso_time){.between = 'T'};
    if (!read_date(&at, end, &days) || at == end || (*at != 'T' && *at != 't' && *at != ' '))
        return false;
    time->between = *at++;
    if (!read_digits(&at, end, 2, &hours) || !read_mark(&at, end, ':') || !read_digits(&at, end, 2, &minutes) ||
        hours > 23 || minutes > 59)
        return false;
    if (read_mark(&at, end, ':') && !read_seconds(&at, end, time, &seconds))
        return false;
    if (!read_zone(at, end, time))
        return false;
    time->nanoseconds = days * DAY + (60 * hours + minutes - time->zone_minutes) * MINUTE + seconds;
    return true;
}

/// a / b rounded down, and the rest.
static int64_t divide_down(int64_t a, int64_t b, int64_t *rest)
{
    int64_t quotient = a / b - (a % b < 0 ? 1 : 0);
    *rest = a - quotient * b;
    return quotient;
}

char *iso_time_write(char *out, const iso_time *form, int64_t nanoseconds)
{
    int decimals = form->decimals > NEW_DECIMALS ? form->decimals : NEW_DECIMALS, year, month, day;
    int64_t unit = SECOND, rest;
    for (int i = 0; i < decimals; i++)
        unit /= 10;
    int64_t units = divide_down(nanoseconds + unit / 2, unit, &rest);
    int64_t in_day, days = divide_down(units * unit + form->zone_minutes * MINUTE, DAY, &in_day);
    date_of_days(days, &year, &month, &day);
    char *end = out + ISO_TIME_SIZE;
    out += snprintf(out, ISO_TIME_SIZE, "%04d-%02d-%02d%c%02d:%02d", year, month, day, form->between,
                    (int)(in_day / (60 * MINUTE)), (int)(in_day / MINUTE % 60));
    int64_t seconds = in_day % MINUTE;
    if (form->has_seconds || seconds != 0)
        out += snprintf(out, (size_t)(end - out), ":%02d", (int)(seconds / SECOND));
    int64_t fraction = seconds % SECOND / unit;
    while (decimals > form->decimals && fraction % 10 == 0)
    {
        fraction /= 10;
        decimals--;
    }
    if (decimals > 0)
        out += snprintf(out, (size_t)(end - out), ".%0*d", decimals, (int)fraction);
    return out + snprintf(out, (size_t)(end - out), "%s", form->zone);
}

/// Nanoseconds that doubles of seconds hold exactly, and the largest seconds of a double beside an origin.
static const int64_t EXACT = 1000000000000000;
static const double LONGEST = 9e9;

bool exact_time_read(const char *begin, const char *end, int decimals, int64_t *nanoseconds)
{
    bool negative = begin < end && *begin == '-', point = false;
    uint64_t made = 0;
    int digits = 0;
    for (const char *at = begin + negative; at < end; at++)
    {
        if (*at == '.' && !point)
        {
            point = true;
            continue;
        }
        if (*at < '0' || *at > '9' || (point && decimals == EXACT_TIME_DECIMALS && *at != '0'))
            return false;
        if (point && decimals == EXACT_TIME_DECIMALS)
            continue;
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

int exact_time_decimals(const char *begin, const char *end)
{
    static const int SMALLEST = 12, STEP = 3; // digits of milliseconds; those between units
    const char *at = begin;
    while (at < end && *at >= '0' && *at <= '9')
        at++;
    int digits = (int)(at - begin);
    int units = digits < SMALLEST ? 0 : 1 + (digits - SMALLEST) / STEP;
    return STEP * (units < 3 ? units : 3);
}

const char *exact_time_unit(int decimals)
{
    static const char *const names[] = {"seconds", "milliseconds", "microseconds", "nanoseconds"};
    return names[decimals / 3];
}

const char *exact_time_suffix(int decimals)
{
    static const char *const suffixes[] = {"", "_ms", "_us", "_ns"};
    return suffixes[decimals / 3];
}

/// The largest whole number of seconds up to a time.
static int64_t whole_seconds(int64_t nanoseconds)
{
    return nanoseconds / SECOND - (nanoseconds % SECOND < 0 ? 1 : 0);
}

int64_t exact_time_origin(int64_t nanoseconds)
{
    return nanoseconds > -EXACT && nanoseconds < EXACT ? 0 : whole_seconds(nanoseconds);
}

double exact_time_since(int64_t nanoseconds, int64_t origin)
{
    int64_t seconds = whole_seconds(nanoseconds), part = nanoseconds - seconds * SECOND, apart = seconds - origin;
    // One rounding where the nanoseconds fit a double.
    if (apart > -EXACT / SECOND && apart < EXACT / SECOND)
        return (double)(apart * SECOND + part) / (double)SECOND;
    return (double)apart + (double)part / (double)SECOND;
}

bool exact_time_nanoseconds(int64_t origin, double seconds, int64_t *nanoseconds)
{
    double whole = floor(seconds);
    if (!(fabs(seconds) < LONGEST) || origin > (int64_t)LONGEST || origin < -(int64_t)LONGEST)
        return false;
    int64_t sum = origin + (int64_t)whole;
    return !__builtin_mul_overflow(sum, SECOND, nanoseconds) &&
           !__builtin_add_overflow(*nanoseconds, (int64_t)llround((seconds - whole) * (double)SECOND), nanoseconds);
}

char *nanoseconds_write(char *out, int64_t nanoseconds)
{
    uint64_t positive = nanoseconds < 0 ? 0 - (uint64_t)nanoseconds : (uint64_t)nanoseconds;
    return out + snprintf(out, EXACT_TIME_SIZE, "%s%" PRIu64 ".%09" PRIu64, nanoseconds < 0 ? "-" : "",
                          positive / (uint64_t)SECOND, positive % (uint64_t)SECOND);
}

char *exact_time_write(char *out, int64_t origin, int decimals, double seconds)
{
    int64_t nanoseconds, part = number_power_of_ten(EXACT_TIME_DECIMALS - decimals);
    if (origin == 0 && decimals == 0)
        return number_write(out, seconds);
    if (!exact_time_nanoseconds(origin, seconds, &nanoseconds))
        return number_write(out, ((double)origin + seconds) * (double)number_power_of_ten(decimals));
    // Seconds with all nine decimals, so that a reader finds that they matter.
    if (decimals == 0)
        return nanoseconds_write(out, nanoseconds);
    int64_t whole = nanoseconds / part, rest = nanoseconds % part;
    out += snprintf(out, EXACT_TIME_SIZE, "%s%" PRId64, whole == 0 && rest < 0 ? "-" : "", whole);
    if (rest == 0)
        return out;
    out += snprintf(out, EXACT_TIME_SIZE, ".%0*" PRId64, EXACT_TIME_DECIMALS - decimals, rest < 0 ? -rest : rest);
    while (out[-1] == '0')
        out--;
    return out;
}
