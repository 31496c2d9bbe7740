#include "io/motion/pose_translation.h"

#include "io/common/number_text.h"
#include "io/common/time_text.h"

#include <stdio.h>
#include <string.h>

static const int64_t BILLION = 1000000000;

/// Write nanoseconds as seconds since the origin, exactly. The first time sets the origin.
static const char *write_since(pose_clock *clock, int64_t nanoseconds, char *out)
{
    if (!clock->begun)
        clock->origin = exact_time_origin(nanoseconds);
    clock->begun = true;
    int64_t since;
    if (__builtin_sub_overflow(nanoseconds, clock->origin * BILLION, &since))
        return "out of range";
    (void)nanoseconds_write(out, since);
    return NULL;
}

/// Whether a time in seconds has more digits than a double.
static bool pose_time_is_long(csv_field cell)
{
    static const int DOUBLE_DIGITS = 15;
    int digits = 0;
    cell = csv_unquoted(cell);
    for (const char *at = cell.begin; at < cell.end; at++)
        digits += *at >= '0' && *at <= '9';
    return digits > DOUBLE_DIGITS;
}

const char *pose_time_write(pose_clock *clock, csv_field cell, char separator, column_unit unit, char *out)
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
        return write_since(clock, iso.nanoseconds, out);
    }
    int decimals = pose_unit_decimals(unit);
    int64_t power = number_power_of_ten(EXACT_TIME_DECIMALS - decimals);
    if (decimals > 0 && csv_read_whole(cell, INT64_DIGITS, &whole) && !__builtin_mul_overflow(whole, power, &nanoseconds))
        return write_since(clock, nanoseconds, out);
    if (decimals == 0 && pose_time_is_long(cell) && exact_time_read(cell.begin, cell.end, &nanoseconds))
        return write_since(clock, nanoseconds, out);
    const char *fault = csv_read_number(cell, separator, &value, &comma);
    clock->begun = true;
    if (fault == NULL)
        *number_write(out, value / (double)number_power_of_ten(decimals) - (double)clock->origin) = '\0';
    return fault;
}

const char *pose_time_write_split(pose_clock *clock, csv_field seconds, csv_field nanoseconds, char *out)
{
    int64_t whole, part;
    if (!csv_read_whole(csv_unquoted(seconds), INT64_DIGITS, &whole) ||
        !csv_read_whole(csv_unquoted(nanoseconds), INT64_DIGITS, &part))
        return "not a whole number";
    if (part < 0 || part >= BILLION || whole > INT64_MAX / BILLION - 1 || whole < 0)
        return "out of range";
    return write_since(clock, whole * BILLION + part, out);
}

column_unit pose_unit_by_size(csv_field cell)
{
    int64_t whole;
    if (!csv_read_whole(csv_unquoted(cell), INT64_DIGITS, &whole) || whole < 100000000000)
        return UNIT_NONE;
    return whole >= 100000000000000000 ? UNIT_NANO : whole >= 100000000000000 ? UNIT_MICRO : UNIT_MILLI;
}

/// Decimals of seconds in whole nanoseconds.
static const int NANO = 9;

/// Names of columns after normalized_name(). The canonical ones come first; the CSV reader knows them itself.
static const struct
{
    const char *name;
    role role;
    bool canonical;
} NAMES[] = {
    {"time", TIME, true},
    {"t", TIME, true},
    {"timestamp", TIME, true},
    {"stamp", TIME, false},
    {"sec", SECONDS, false},
    {"secs", SECONDS, false},
    {"stamp_sec", SECONDS, false},
    {"stamp_secs", SECONDS, false},
    {"nsec", NANOSECONDS, false},
    {"nsecs", NANOSECONDS, false},
    {"nanosec", NANOSECONDS, false},
    {"stamp_nsec", NANOSECONDS, false},
    {"stamp_nsecs", NANOSECONDS, false},
    {"stamp_nanosec", NANOSECONDS, false},
    {"x", X, true},
    {"y", Y, true},
    {"z", Z, true},
    {"tx", X, true},
    {"ty", Y, true},
    {"tz", Z, true},
    {"qw", QW, true},
    {"qx", QX, true},
    {"qy", QY, true},
    {"qz", QZ, true},
    {"roll", ROLL, false},
    {"pitch", PITCH, false},
    {"yaw", YAW, false},
    {"vx", VX, true},
    {"vy", VY, true},
    {"vz", VZ, true},
    {"wx", WX, true},
    {"wy", WY, true},
    {"wz", WZ, true},
};

/// Prefixes of an axis: "position_x", "q_w".
static const char *const PLACES[] = {"p_", "p", "pos_", "position_", "translation_", "transform_translation_", "p_rs_r_"};
static const char *const TURNS[] = {"q_",   "quat_",     "quaternion_",         "orientation_",
                                    "rot_", "rotation_", "transform_rotation_", "q_rs_"};
/// Prefixes of messages, which are dropped.
static const char *const PREFIXES[] = {"%", "#", "field_", "header_", "pose_", "msg_", "data_"};

static const struct
{
    const char *name;
    column_unit unit;
} UNITS[] = {{"s", UNIT_SECONDS},   {"sec", UNIT_SECONDS},    {"seconds", UNIT_SECONDS}, {"ms", UNIT_MILLI},
             {"us", UNIT_MICRO},    {"ns", UNIT_NANO},        {"nsec", UNIT_NANO},       {"nanoseconds", UNIT_NANO},
             {"deg", UNIT_DEGREES}, {"degree", UNIT_DEGREES}, {"degrees", UNIT_DEGREES}, {"\xC2\xB0", UNIT_DEGREES},
             {"rad", UNIT_RADIANS}, {"radian", UNIT_RADIANS}, {"radians", UNIT_RADIANS}};

int pose_unit_decimals(column_unit unit)
{
    return unit == UNIT_NANO ? NANO : unit == UNIT_MICRO ? 6 : unit == UNIT_MILLI ? 3 : 0;
}

void pose_name_normalize(csv_field field, char name[POSE_NAME_SIZE], column_unit *found)
{
    size_t length = 0;
    field = csv_unquoted(field);
    *found = UNIT_NONE;
    char unit_name[POSE_NAME_SIZE] = "";
    for (const char *at = field.begin; at < field.end && length + 1 < POSE_NAME_SIZE; at++)
    {
        if (*at == '[' || *at == '(')
        {
            size_t size = 0;
            while (++at < field.end && *at != ']' && *at != ')' && size + 1 < POSE_NAME_SIZE)
                unit_name[size++] = (char)(*at >= 'A' && *at <= 'Z' ? *at - 'A' + 'a' : *at);
            unit_name[size] = '\0';
            *found = size > 0 ? UNIT_OTHER : UNIT_NONE;
            break;
        }
        char c = *at >= 'A' && *at <= 'Z' ? (char)(*at - 'A' + 'a') : *at;
        name[length++] = (char)(strchr("./ -", c) != NULL ? '_' : c);
    }
    while (length > 0 && name[length - 1] == '_')
        length--;
    name[length] = '\0';
    for (bool stripped = true; stripped;)
    {
        stripped = false;
        while (name[0] == '_')
            memmove(name, name + 1, strlen(name));
        for (size_t i = 0; i < sizeof PREFIXES / sizeof *PREFIXES; i++)
        {
            size_t size = strlen(PREFIXES[i]);
            if (strncmp(name, PREFIXES[i], size) == 0 && name[size] != '\0')
            {
                memmove(name, name + size, strlen(name + size) + 1);
                stripped = true;
            }
        }
    }
    char *last = strrchr(name, '_');
    for (size_t i = 0; i < sizeof UNITS / sizeof *UNITS; i++)
        if (strcmp(unit_name, UNITS[i].name) == 0)
            *found = UNITS[i].unit;
    // "time_ns", "yaw_deg"; "stamp_sec" has a meaning of its own.
    bool angle = strncmp(name, "roll_", 5) == 0 || strncmp(name, "pitch_", 6) == 0 || strncmp(name, "yaw_", 4) == 0;
    bool time = strncmp(name, "time_", 5) == 0 || strncmp(name, "timestamp_", 10) == 0 || strncmp(name, "t_", 2) == 0;
    for (size_t i = 0; last != NULL && (angle || time) && i < sizeof UNITS / sizeof *UNITS; i++)
        if (*found == UNIT_NONE && strcmp(last + 1, UNITS[i].name) == 0)
        {
            *found = UNITS[i].unit;
            *last = '\0';
            break;
        }
}

role pose_name_role(const char *name, bool *canonical)
{
    *canonical = false;
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++)
        if (strcmp(name, NAMES[i].name) == 0)
        {
            *canonical = NAMES[i].canonical;
            return NAMES[i].role;
        }
    size_t length = strlen(name);
    const char axis = length > 0 ? name[length - 1] : '\0';
    for (size_t i = 0; axis >= 'x' && axis <= 'z' && i < sizeof PLACES / sizeof *PLACES; i++)
        if (strlen(PLACES[i]) + 1 == length && strncmp(name, PLACES[i], length - 1) == 0)
            return (role)(X + (axis - 'x'));
    for (size_t i = 0; axis >= 'w' && axis <= 'z' && i < sizeof TURNS / sizeof *TURNS; i++)
        if (strlen(TURNS[i]) + 1 == length && strncmp(name, TURNS[i], length - 1) == 0)
            return (role)(QW + (axis - 'w'));
    return ROLES;
}
