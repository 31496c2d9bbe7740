#include "io/motion/pose_translation.h"

#include "io/common/exact_time.h"
#include "io/common/number_text.h"

#include <stdio.h>
#include <string.h>

static const int64_t BILLION = 1000000000;

bool pose_read_whole(csv_field cell, int64_t *value)
{
    bool negative = cell.begin < cell.end && *cell.begin == '-';
    const char *at = cell.begin + negative;
    uint64_t made = 0;
    if (at == cell.end || cell.end - at > 19)
        return false;
    for (; at < cell.end; at++)
    {
        if (*at < '0' || *at > '9')
            return false;
        made = 10 * made + (uint64_t)(*at - '0');
    }
    if (made > INT64_MAX)
        return false;
    *value = negative ? -(int64_t)made : (int64_t)made;
    return true;
}

/// Write nanoseconds as seconds since the origin, exactly. The first time sets the origin.
static const char *write_since(pose_clock *clock, int64_t nanoseconds, char *out, size_t size)
{
    if (!clock->begun)
        clock->origin = exact_time_origin(nanoseconds);
    clock->begun = true;
    int64_t since;
    if (__builtin_sub_overflow(nanoseconds, clock->origin * BILLION, &since))
        return "out of range";
    uint64_t positive = since < 0 ? 0 - (uint64_t)since : (uint64_t)since, power = (uint64_t)BILLION;
    (void)snprintf(out, size, "%s%llu.%09llu", since < 0 ? "-" : "", (unsigned long long)(positive / power),
                   (unsigned long long)(positive % power));
    return NULL;
}

/// Whether a time in seconds has more digits than a double.
static bool pose_time_is_long(csv_field cell)
{
    enum
    {
        DOUBLE_DIGITS = 15
    };
    int digits = 0;
    cell = csv_unquoted(cell);
    for (const char *at = cell.begin; at < cell.end; at++)
        digits += *at >= '0' && *at <= '9';
    return digits > DOUBLE_DIGITS;
}

const char *pose_time_write(pose_clock *clock, csv_field cell, char separator, column_unit unit, char *out, size_t size)
{
    int64_t whole, nanoseconds;
    iso_time iso;
    double value;
    bool comma = false;
    cell = csv_unquoted(cell);
    if (iso_time_read(cell.begin, cell.end, &iso))
    {
        if (!clock->begun && cell.end - cell.begin < (ptrdiff_t)sizeof clock->first)
            (void)snprintf(clock->first, sizeof clock->first, "%.*s", (int)(cell.end - cell.begin), cell.begin);
        return write_since(clock, iso.nanoseconds, out, size);
    }
    int decimals = pose_unit_decimals(unit);
    int64_t power = number_power_of_ten(EXACT_TIME_DECIMALS - decimals);
    if (decimals > 0 && pose_read_whole(cell, &whole) && !__builtin_mul_overflow(whole, power, &nanoseconds))
        return write_since(clock, nanoseconds, out, size);
    if (decimals == 0 && pose_time_is_long(cell) && exact_time_read(cell.begin, cell.end, &nanoseconds))
        return write_since(clock, nanoseconds, out, size);
    const char *fault = csv_read_number(cell, separator, &value, &comma);
    clock->begun = true;
    if (fault == NULL)
        *number_write(out, value / (double)number_power_of_ten(decimals) - (double)clock->origin) = '\0';
    return fault;
}

const char *pose_time_write_split(pose_clock *clock, csv_field seconds, csv_field nanoseconds, char *out, size_t size)
{
    int64_t whole, part;
    if (!pose_read_whole(csv_unquoted(seconds), &whole) || !pose_read_whole(csv_unquoted(nanoseconds), &part))
        return "not a whole number";
    if (part < 0 || part >= BILLION || whole > INT64_MAX / BILLION - 1 || whole < 0)
        return "out of range";
    return write_since(clock, whole * BILLION + part, out, size);
}

column_unit pose_unit_by_size(csv_field cell)
{
    int64_t whole;
    if (!pose_read_whole(csv_unquoted(cell), &whole) || whole < 100000000000)
        return UNIT_NONE;
    return whole >= 100000000000000000 ? UNIT_NANO : whole >= 100000000000000 ? UNIT_MICRO : UNIT_MILLI;
}
