#include "io/motion/pose_text.h"

#include "base/error.h"
#include "base/text_buffer.h"
#include "batten/motion.h"
#include "batten/space.h"
#include "curve/curve_attributes.h"
#include "io/common/iso_time.h"
#include "io/common/number_text.h"
#include "io/curve/csv_split.h"
#include "io/curve/formats.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum
{
    TUM_NUMBERS = 8,
    KITTI_NUMBERS = 12,
    EUROC_NUMBERS = 17,
    /// Rows that must agree before a text without names is taken for a trajectory.
    PROBED_ROWS = 100,
    NAME_SIZE = 64,
    MAX_NOTES = 6,
    NOTE_SIZE = 240,
    /// Decimals of seconds in whole nanoseconds.
    NANO = 9
};

/// Matrices in files: the largest distance of an entry from the nearest rotation, and the one worth a note.
static const double MATRIX_TOLERANCE = 1e-3, MATRIX_ROUNDING = 1e-6;
/// Four numbers of about unit length are taken for a quaternion.
static const double UNIT_TOLERANCE = 1e-2;

/// What a column of a table holds.
typedef enum role
{
    TIME,
    SECONDS,
    NANOSECONDS,
    X,
    Y,
    Z,
    QW,
    QX,
    QY,
    QZ,
    ROLL,
    PITCH,
    YAW,
    VX,
    VY,
    VZ,
    WX,
    WY,
    WZ,
    ROLES
} role;

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
static const char *const OUTPUT_NAMES[ROLES] = {
    [TIME] = "time", [X] = "tx",  [Y] = "ty",  [Z] = "tz",  [QW] = "qw", [QX] = "qx", [QY] = "qy",
    [QZ] = "qz",     [VX] = "vx", [VY] = "vy", [VZ] = "vz", [WX] = "wx", [WY] = "wy", [WZ] = "wz"};

/// Units that the name of a column has.
typedef enum column_unit
{
    UNIT_NONE,
    UNIT_SECONDS,
    UNIT_MILLI,
    UNIT_MICRO,
    UNIT_NANO,
    UNIT_DEGREES,
    UNIT_RADIANS,
    UNIT_OTHER
} column_unit;

static const struct
{
    const char *name;
    column_unit unit;
} UNITS[] = {{"s", UNIT_SECONDS},   {"sec", UNIT_SECONDS},    {"seconds", UNIT_SECONDS}, {"ms", UNIT_MILLI},
             {"us", UNIT_MICRO},    {"ns", UNIT_NANO},        {"nsec", UNIT_NANO},       {"nanoseconds", UNIT_NANO},
             {"deg", UNIT_DEGREES}, {"degree", UNIT_DEGREES}, {"degrees", UNIT_DEGREES}, {"\xC2\xB0", UNIT_DEGREES},
             {"rad", UNIT_RADIANS}, {"radian", UNIT_RADIANS}, {"radians", UNIT_RADIANS}};

/// The decimals that a unit of time has below seconds.
static int decimals_of(column_unit unit)
{
    return unit == UNIT_NANO ? NANO : unit == UNIT_MICRO ? 6 : unit == UNIT_MILLI ? 3 : 0;
}

/// The work on a text.
typedef struct translation
{
    const file_text *source;
    const bat_curve_read_options *options;
    text_buffer text;
    bat_curve_format reader; ///< of the translated text; BAT_CURVE_FORMAT_AUTO where the text is none of poses
    bat_curve_format format; ///< that the set is of
    bool as_it_is;           ///< the source needs no translation
    char notes[MAX_NOTES][NOTE_SIZE];
    size_t note_count;
    // Of tables:
    size_t columns[ROLES]; ///< BAT_NO_INDEX where there is none
    column_unit time_unit, angle_unit;
    char separator;
    size_t width; ///< columns of the header
    char order[4];
} translation;

__attribute__((format(printf, 2, 3))) static void add_note(translation *work, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (work->note_count < MAX_NOTES)
        (void)vsnprintf(work->notes[work->note_count++], NOTE_SIZE, format, values);
    va_end(values);
}

static bat_status fail(bat_error *error, size_t line, const char *text)
{
    return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, "%s", text);
}

const char *poses_euler_fault(const char *euler)
{
    static const char *const orders[] = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};
    static const char fault[] = "euler must be an order of x, y and z, as zyx, with ,degrees or ,radians where the names "
                                "of the columns do not tell";
    if (euler == NULL)
        return NULL;
    bool known = false;
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++)
        known = known || strncmp(euler, orders[i], 3) == 0;
    if (!known)
        return fault;
    const char *rest = euler + 3;
    return *rest == '\0' || strcmp(rest, ",degrees") == 0 || strcmp(rest, ",radians") == 0 ? NULL : fault;
}

// Rows of numbers without names

/// Read a row of exactly `count` numbers. False where it is none.
static bool read_numbers(const file_text *source, const text_line *line, size_t count, double *numbers, char *separator)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t found;
    bool comma = false;
    *separator = csv_find_separator(line);
    if (csv_split(source, line, *separator, fields, &found) != NULL)
        return false;
    while (found > count && fields[found - 1].begin == fields[found - 1].end)
        found--;
    if (found != count)
        return false;
    for (size_t i = 0; i < count; i++)
        if (csv_read_number(fields[i], *separator, &numbers[i], &comma) != NULL)
            return false;
    return !comma;
}

static bool is_unit(const double *q)
{
    return fabs(sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) - 1) <= UNIT_TOLERANCE;
}

/// The nearest rotation of the 3x4 matrix of a row, and the largest distance of an entry from it. Infinite where there is
/// none.
static double matrix_deviation(const double *row, double *quaternion)
{
    double matrix[9], nearest[9], largest = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix[3 * i + j] = row[4 * i + j];
    if (bat_rotation_nearest(matrix, quaternion, NULL) != BAT_OK)
        return INFINITY;
    bat_rotation_to_matrix(quaternion, nearest);
    for (int i = 0; i < 9; i++)
        largest = fmax(largest, fabs(nearest[i] - matrix[i]));
    return largest;
}

/// Whether a row agrees with a form without names; `before` is the time of the row before.
static bool row_fits(const translation *work, const text_line *line, size_t width, double *before, char *separator)
{
    double numbers[EUROC_NUMBERS], quaternion[4];
    if (!read_numbers(work->source, line, width, numbers, separator))
        return false;
    if (width == KITTI_NUMBERS)
        return matrix_deviation(numbers, quaternion) <= MATRIX_TOLERANCE;
    double time = numbers[0];
    bool later = time > *before;
    *before = time;
    return later && is_unit(numbers + 4);
}

/// Whether the first rows all agree with a form of `width` numbers. `*first` receives the first number.
static bool probe(const translation *work, size_t width, double *first, char *separator)
{
    text_line line = text_line_start(work->source);
    size_t rows = 0;
    double before = -INFINITY;
    while (rows < PROBED_ROWS && text_line_next(work->source, &line))
    {
        if (line.begin == line.end || *line.begin == '#')
            continue;
        // Any row of a file of matrices decides.
        if (rows > 0 && width == KITTI_NUMBERS)
            return true;
        if (!row_fits(work, &line, width, &before, separator))
            return false;
        if (rows++ == 0)
            *first = before;
    }
    return rows > 1;
}

/// Write a row of the TUM format.
static void write_tum(translation *work, const char *time, const double *place, const double *quaternion)
{
    char *out;
    text_append_string(&work->text, time);
    double row[7] = {place[0], place[1], place[2], quaternion[1], quaternion[2], quaternion[3], quaternion[0]};
    if ((out = text_reserve(&work->text, 7 * (NUMBER_TEXT_SIZE + 1) + 1)) == NULL)
        return;
    for (int i = 0; i < 7; i++)
    {
        *out++ = ' ';
        out = number_write(out, row[i]);
    }
    text_advance(&work->text, out);
}

/// Find the times of the rows of KITTI, where they were given.
static bat_status read_key_times(const translation *work, double **times, size_t *count, bat_error *error)
{
    *times = NULL;
    *count = 0;
    if (work->options->key_times == NULL)
        return BAT_OK;
    bat_status status = bat_motion_times_read(work->options->key_times, times, count, error);
    if (status == BAT_OK || error == NULL)
        return status;
    char text[BAT_ERROR_TEXT_SIZE];
    (void)snprintf(text, sizeof text, "%.80s: %s%.100s", work->options->key_times, "", error->text);
    if (error->line > 0)
        (void)snprintf(text, sizeof text, "%.80s:%zu: %.100s", work->options->key_times, error->line, error->text);
    return error_set(error, status, BAT_NO_INDEX, 0, "%s", text);
}

static bat_status translate_matrix(translation *work, const text_line *line, const double *times, size_t time_count,
                                   size_t row, double *worst, size_t *worst_line, bat_error *error)
{
    double numbers[KITTI_NUMBERS], quaternion[4];
    char separator, time[NUMBER_TEXT_SIZE + 1];
    if (!read_numbers(work->source, line, KITTI_NUMBERS, numbers, &separator))
        return fail(error, line->number, "a row of KITTI poses has 12 numbers, a matrix of 3 rows and 4 columns");
    double deviation = matrix_deviation(numbers, quaternion);
    if (!(deviation <= MATRIX_TOLERANCE) && !(work->options->project && deviation < INFINITY))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number,
                         deviation < INFINITY ? "the matrix is no rotation: an entry is off by %.3g; --project takes the "
                                                "nearest rotation"
                                              : "the matrix is no rotation",
                         deviation);
    if (deviation > *worst)
    {
        *worst = deviation;
        *worst_line = line->number;
    }
    if (times != NULL && row >= time_count)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "there are more poses than times, which are %zu",
                         time_count);
    *number_write(time, times != NULL ? times[row] : (double)row) = '\0';
    write_tum(work, time, (double[3]){numbers[3], numbers[7], numbers[11]}, quaternion);
    return BAT_OK;
}

static bat_status translate_kitti(translation *work, bat_error *error)
{
    double *times, worst = 0;
    size_t time_count, rows = 0, worst_line = 0;
    bat_status status = read_key_times(work, &times, &time_count, error);
    text_line line = text_line_start(work->source);
    while (status == BAT_OK && text_line_next(work->source, &line))
    {
        if (line.begin != line.end && *line.begin != '#')
            status = translate_matrix(work, &line, times, time_count, rows++, &worst, &worst_line, error);
        text_append_string(&work->text, "\n");
    }
    if (status == BAT_OK && times != NULL && rows != time_count)
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line.number, "there are %zu poses, but %zu times", rows,
                           time_count);
    work->reader = BAT_CURVE_FORMAT_TUM;
    work->format = times != NULL ? BAT_CURVE_FORMAT_TUM : BAT_CURVE_FORMAT_KITTI;
    add_note(work, "KITTI poses: matrices from the camera's frame (x right, y down, z forward) to that of the first pose");
    if (times == NULL)
        add_note(work, "no times: pose i is at time i, the number of its frame; --key-times FILE gives times");
    if (worst > MATRIX_ROUNDING)
        add_note(work, "matrices are up to %.2g from rotations, most on line %zu; they became the nearest ones", worst,
                 worst_line);
    free(times);
    return status;
}

// Times

/// A whole number of up to 18 digits, or 19 below the largest one.
static bool read_whole(csv_field cell, int64_t *value)
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

/// Write units of 10^-decimals seconds, exactly.
static void write_units(int64_t units, int decimals, char *out, size_t size)
{
    uint64_t positive = units < 0 ? 0 - (uint64_t)units : (uint64_t)units, power = (uint64_t)number_power_of_ten(decimals);
    if (decimals == 0)
        (void)snprintf(out, size, "%lld", (long long)units);
    else
        (void)snprintf(out, size, "%s%llu.%0*llu", units < 0 ? "-" : "", (unsigned long long)(positive / power), decimals,
                       (unsigned long long)(positive % power));
}

/// The text of a time in seconds. Returns null, or an error text.
static const char *write_time(csv_field cell, char separator, column_unit unit, char *out, size_t size)
{
    int64_t whole;
    iso_time iso;
    double value;
    bool comma = false;
    cell = csv_unquoted(cell);
    if (iso_time_read(cell.begin, cell.end, &iso))
    {
        write_units(iso.nanoseconds, NANO, out, size);
        return NULL;
    }
    if (read_whole(cell, &whole))
    {
        write_units(whole, decimals_of(unit), out, size);
        return NULL;
    }
    const char *fault = csv_read_number(cell, separator, &value, &comma);
    if (fault == NULL)
        *number_write(out, value / (double)number_power_of_ten(decimals_of(unit))) = '\0';
    return fault;
}

/// Seconds and nanoseconds in two columns.
static const char *write_split_time(csv_field seconds, csv_field nanoseconds, char *out, size_t size)
{
    int64_t whole, part;
    if (!read_whole(csv_unquoted(seconds), &whole) || !read_whole(csv_unquoted(nanoseconds), &part))
        return "not a whole number";
    if (part < 0 || part >= number_power_of_ten(NANO) || whole > INT64_MAX / number_power_of_ten(NANO) - 1 || whole < 0)
        return "out of range";
    write_units(whole * number_power_of_ten(NANO) + part, NANO, out, size);
    return NULL;
}

/// The unit of whole times that are too large for seconds since 1970.
static column_unit unit_by_size(csv_field cell)
{
    int64_t whole;
    if (!read_whole(csv_unquoted(cell), &whole) || whole < 100000000000)
        return UNIT_NONE;
    return whole >= 100000000000000000 ? UNIT_NANO : whole >= 100000000000000 ? UNIT_MICRO : UNIT_MILLI;
}

// EuRoC without names

static bat_status translate_euroc_row(translation *work, const text_line *line, bat_error *error)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t count;
    double numbers[7];
    bool comma = false;
    char time[NUMBER_TEXT_SIZE + 32], separator = csv_find_separator(line);
    const char *fault = csv_split(work->source, line, separator, fields, &count);
    if (fault == NULL && count < TUM_NUMBERS)
        fault = "a row of EuRoC poses has 8 numbers or more";
    if (fault == NULL)
        fault = write_time(fields[0], separator, UNIT_NANO, time, sizeof time);
    for (size_t i = 0; i < 7 && fault == NULL; i++)
        fault = csv_read_number(fields[1 + i], separator, &numbers[i], &comma);
    if (fault != NULL)
        return fail(error, line->number, fault);
    write_tum(work, time, numbers, numbers + 3);
    return BAT_OK;
}

static bat_status translate_euroc(translation *work, bool named, bat_error *error)
{
    bat_status status = BAT_OK;
    text_line line = text_line_start(work->source);
    bool begun = false;
    while (status == BAT_OK && text_line_next(work->source, &line))
    {
        bool header = !begun && line.begin != line.end && *line.begin != '#' && !number_resembles(line.begin, line.end);
        if (line.begin != line.end && *line.begin != '#' && !header)
        {
            status = translate_euroc_row(work, &line, error);
            begun = true;
        }
        text_append_string(&work->text, "\n");
    }
    work->reader = BAT_CURVE_FORMAT_TUM;
    work->format = BAT_CURVE_FORMAT_EUROC;
    add_note(work,
             "EuRoC poses%s: of the body in the reference frame, quaternions w x y z; velocities and biases are left "
             "out",
             named ? "" : ", by their numbers");
    add_note(work, "times in nanoseconds became seconds, to 0.12 microseconds");
    return status;
}

// Tables with names

/// The name of a column in lower case without quotes, unit and prefixes, with '_' for dots, slashes and blanks.
static void normalized_name(csv_field field, char name[NAME_SIZE], column_unit *found)
{
    size_t length = 0;
    field = csv_unquoted(field);
    *found = UNIT_NONE;
    char unit_name[NAME_SIZE] = "";
    for (const char *at = field.begin; at < field.end && length + 1 < NAME_SIZE; at++)
    {
        if (*at == '[' || *at == '(')
        {
            size_t size = 0;
            while (++at < field.end && *at != ']' && *at != ')' && size + 1 < NAME_SIZE)
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

/// The role of a normalized name, or ROLES.
static role role_of(const char *name, bool *canonical)
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

/// How many of `count` roles have columns.
static size_t count_roles(const translation *work, role first, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += work->columns[(size_t)first + i] != BAT_NO_INDEX;
    return found;
}

/// What the names of a header tell.
typedef struct header
{
    size_t others;         ///< columns without a role
    char other[NAME_SIZE]; ///< the first of them
    bool foreign;          ///< a name is not one that the CSV reader knows
    bool globe;            ///< there are longitudes or latitudes
    bool euroc;            ///< names of EuRoC
    size_t twice;          ///< a second column of a role, or BAT_NO_INDEX
    column_unit angles[3];
} header;

static void read_roles(translation *work, const csv_field *fields, size_t count, header *names)
{
    *names = (header){.twice = BAT_NO_INDEX};
    for (size_t i = 0; i < ROLES; i++)
        work->columns[i] = BAT_NO_INDEX;
    work->time_unit = UNIT_NONE;
    for (size_t i = 0; i < count; i++)
    {
        char name[NAME_SIZE];
        bool canonical;
        column_unit found;
        normalized_name(fields[i], name, &found);
        role what = role_of(name, &canonical);
        names->globe = names->globe || strncmp(name, "lon", 3) == 0 || strncmp(name, "lat", 3) == 0;
        names->euroc = names->euroc || strncmp(name, "q_rs_", 5) == 0;
        if (what == ROLES)
        {
            csv_field other = csv_unquoted(fields[i]);
            if (names->others++ == 0)
                (void)snprintf(names->other, sizeof names->other, "%.*s", (int)(other.end - other.begin), other.begin);
            continue;
        }
        bool stamp = what == TIME && strcmp(name, "stamp") == 0;
        size_t bare = strlen(name);
        csv_field plain = csv_unquoted(fields[i]);
        names->foreign = names->foreign || !canonical || (size_t)(plain.end - plain.begin) != bare;
        if (work->columns[what] != BAT_NO_INDEX && !stamp)
        {
            names->twice = what == TIME ? names->twice : i;
            continue;
        }
        work->columns[what] = i;
        if (what == TIME)
            work->time_unit = found;
        if (what >= ROLL && what <= YAW)
            names->angles[what - ROLL] = found;
    }
    work->width = count;
}

static bool has_orientation(const translation *work)
{
    return count_roles(work, QW, 4) == 4 || count_roles(work, ROLL, 3) == 3;
}

/// The order and the unit of angles, by the names and the option.
static bat_status choose_angles(translation *work, const header *names, size_t line, bat_error *error)
{
    const char *euler = work->options->euler;
    column_unit found = names->angles[0], asked = UNIT_NONE;
    (void)snprintf(work->order, sizeof work->order, "%.3s", euler != NULL ? euler : "zyx");
    if (euler != NULL && strlen(euler) > 3)
        asked = strcmp(euler + 4, "degrees") == 0 ? UNIT_DEGREES : UNIT_RADIANS;
    if (names->angles[1] != found || names->angles[2] != found)
        return fail(error, line, "roll, pitch and yaw have different units in their names");
    bool named = found == UNIT_DEGREES || found == UNIT_RADIANS;
    if (!named && asked == UNIT_NONE)
        return fail(error, line,
                    "roll, pitch and yaw have no unit in their names: --euler zyx,degrees or --euler zyx,radians tells it");
    if (named && asked != UNIT_NONE && asked != found)
        return fail(error, line, "the names of roll, pitch and yaw tell another unit than --euler");
    work->angle_unit = named ? found : asked;
    return BAT_OK;
}

static void note_table(translation *work, const header *names, bool by_size)
{
    static const char *const units[] = {
        [UNIT_NONE] = "seconds",       [UNIT_SECONDS] = "seconds",  [UNIT_MILLI] = "milliseconds",
        [UNIT_MICRO] = "microseconds", [UNIT_NANO] = "nanoseconds", [UNIT_DEGREES] = "seconds",
        [UNIT_RADIANS] = "seconds",    [UNIT_OTHER] = "seconds"};
    bool split = work->columns[SECONDS] != BAT_NO_INDEX, timed = split || work->columns[TIME] != BAT_NO_INDEX;
    bool angles = count_roles(work, QW, 4) < 4 && count_roles(work, ROLL, 3) == 3;
    bool turned = has_orientation(work);
    if (names->euroc)
        add_note(work, "EuRoC poses of the body S in the reference frame R, quaternions w x y z");
    else if (angles)
        add_note(work, "poses by roll, pitch and yaw in %s, turned about the body's axes in the order %s%s",
                 work->angle_unit == UNIT_DEGREES ? "degrees" : "radians", work->order,
                 work->options->euler != NULL ? "" : " (--euler names another)");
    else if (turned)
        add_note(work, "poses by names of columns: quaternions from the body's frame to the fixed one");
    if (timed)
        add_note(work, "times in %s%s%s", split ? "seconds and nanoseconds" : units[work->time_unit],
                 by_size ? " (by their size)" : "",
                 split || decimals_of(work->time_unit) > 0 ? " became seconds, rounded to doubles (0.12 microseconds today)"
                                                           : "");
    if (names->others > 0)
        add_note(work, "%zu column%s no part of a pose and left out, the first '%.40s'", names->others,
                 names->others > 1 ? "s are" : " is", names->other);
}

/// Append the quaternion of three angles: turns about the body's axes in the order of the letters.
static void turn_by_angles(const translation *work, const double angles[3], double *quaternion)
{
    static const double DEGREE = 3.14159265358979323846 / 180;
    double q[4] = {1, 0, 0, 0};
    for (int k = 0; k < 3; k++)
    {
        int axis = work->order[k] - 'x';
        double half = angles[axis] * (work->angle_unit == UNIT_DEGREES ? DEGREE : 1) / 2, c = cos(half), s = sin(half);
        double t[4] = {c, 0, 0, 0};
        t[1 + axis] = s;
        double made[4] = {
            q[0] * t[0] - q[1] * t[1] - q[2] * t[2] - q[3] * t[3], q[0] * t[1] + q[1] * t[0] + q[2] * t[3] - q[3] * t[2],
            q[0] * t[2] + q[2] * t[0] + q[3] * t[1] - q[1] * t[3], q[0] * t[3] + q[3] * t[0] + q[1] * t[2] - q[2] * t[1]};
        memcpy(q, made, sizeof q);
    }
    memcpy(quaternion, q, sizeof q);
}

static bat_status cell_fault(const csv_field *fields, size_t column, size_t line, const char *fault, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, "column %zu: '%s' %s", column + 1,
                     text_excerpt(excerpt, fields[column].begin, fields[column].end), fault);
}

static bat_status translate_row(translation *work, const text_line *line, bat_error *error)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t count;
    bool comma = false;
    char time[NUMBER_TEXT_SIZE + 32], *out;
    double numbers[ROLES] = {0};
    const char *fault = csv_split(work->source, line, work->separator, fields, &count);
    if (fault != NULL)
        return fail(error, line->number, fault);
    while (count > work->width && fields[count - 1].begin == fields[count - 1].end)
        count--;
    if (count != work->width)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "%zu columns, but the header has %zu", count,
                         work->width);
    size_t timed = work->columns[SECONDS] != BAT_NO_INDEX ? work->columns[SECONDS] : work->columns[TIME];
    if (work->columns[SECONDS] != BAT_NO_INDEX)
        fault = write_split_time(fields[timed], fields[work->columns[NANOSECONDS]], time, sizeof time);
    else if (timed != BAT_NO_INDEX)
        fault = write_time(fields[timed], work->separator, work->time_unit, time, sizeof time);
    if (fault != NULL)
        return cell_fault(fields, timed, line->number, fault, error);
    for (size_t i = X; i < ROLES; i++)
        if (work->columns[i] != BAT_NO_INDEX &&
            (fault = csv_read_number(fields[work->columns[i]], work->separator, &numbers[i], &comma)) != NULL)
            return cell_fault(fields, work->columns[i], line->number, fault, error);
    bool angles = count_roles(work, QW, 4) < 4 && count_roles(work, ROLL, 3) == 3;
    if (angles)
        turn_by_angles(work, numbers + ROLL, numbers + QW);
    if (timed != BAT_NO_INDEX)
        text_append_string(&work->text, time);
    if ((out = text_reserve(&work->text, ROLES * (NUMBER_TEXT_SIZE + 1))) == NULL)
        return BAT_OK; // told at the end
    bool first = timed == BAT_NO_INDEX;
    for (size_t i = X; i < ROLES; i++)
    {
        bool turned = angles && i >= QW && i <= QZ;
        if (OUTPUT_NAMES[i] == NULL || (work->columns[i] == BAT_NO_INDEX && !turned))
            continue;
        if (!first)
            *out++ = ',';
        first = false;
        out = number_write(out, numbers[i]);
    }
    text_advance(&work->text, out);
    return BAT_OK;
}

static void write_names(translation *work)
{
    bool turned = has_orientation(work), first = true;
    for (size_t i = 0; i < ROLES; i++)
    {
        bool there = work->columns[i] != BAT_NO_INDEX || (turned && i >= QW && i <= QZ) ||
                     (i == TIME && work->columns[SECONDS] != BAT_NO_INDEX);
        if (OUTPUT_NAMES[i] == NULL || !there)
            continue;
        bool plain = !turned && i >= X && i <= Z;
        text_append_string(&work->text, first ? "" : ",");
        text_append_string(&work->text, OUTPUT_NAMES[i] + plain);
        first = false;
    }
}

/// Check that the columns of a table make poses, and forget those that do not belong to one.
static bat_status check_table(translation *work, const header *names, size_t line, bat_error *error)
{
    size_t places = count_roles(work, X, 3), speeds = count_roles(work, VX, 3), turns = count_roles(work, WX, 3);
    if (names->twice != BAT_NO_INDEX)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line,
                         "column %zu has the meaning of another one; --columns names the coordinates", names->twice + 1);
    if ((work->columns[SECONDS] != BAT_NO_INDEX) != (work->columns[NANOSECONDS] != BAT_NO_INDEX))
        return fail(error, line, "of seconds and nanoseconds, only one column is there");
    if (places != 0 && places != 3)
        return fail(error, line, "a pose needs columns x, y and z, or none of them");
    bool whole = has_orientation(work) ? turns == 3 && (speeds == 3 || places == 0) : speeds == 3;
    for (size_t i = VX; i <= WZ && !whole; i++)
        work->columns[i] = BAT_NO_INDEX;
    return BAT_OK;
}

/// Whether a table needs to be translated. Poses whose names the CSV reader knows do not, unless their times are none in
/// seconds.
static bool wants_table(const translation *work, const header *names, csv_field time, bool *by_size)
{
    iso_time iso;
    const char *space = work->options->space;
    bool turned = has_orientation(work), stamped = work->columns[SECONDS] != BAT_NO_INDEX;
    csv_field bare = csv_unquoted(time);
    *by_size = work->time_unit == UNIT_NONE && unit_by_size(time) != UNIT_NONE;
    bool scaled = stamped || *by_size || decimals_of(work->time_unit) > 0;
    bool placed = count_roles(work, X, 3) == 3;
    if (names->globe || (space != NULL && strcmp(space, "rigid") != 0 && strcmp(space, "rotation") != 0))
        return false;
    if (turned)
        return names->foreign || scaled || iso_time_read(bare.begin, bare.end, &iso);
    return placed && (stamped || decimals_of(work->time_unit) > 0) && space == NULL;
}

static bat_status translate_table(translation *work, const text_line *head, const header *names, bool by_size,
                                  bat_error *error)
{
    bat_status status = check_table(work, names, head->number, error);
    if (status == BAT_OK && count_roles(work, QW, 4) < 4 && has_orientation(work))
        status = choose_angles(work, names, head->number, error);
    text_line line = text_line_start(work->source);
    while (status == BAT_OK && text_line_next(work->source, &line))
    {
        if (line.number == head->number)
            write_names(work);
        else if (line.begin != line.end && *line.begin == '#')
            text_append(&work->text, line.begin, (size_t)(line.end - line.begin));
        else if (line.begin != line.end)
            status = translate_row(work, &line, error);
        text_append_string(&work->text, "\n");
    }
    work->reader = BAT_CURVE_FORMAT_CSV;
    work->format = names->euroc && has_orientation(work) && count_roles(work, X, 3) == 3 ? BAT_CURVE_FORMAT_EUROC
                                                                                         : BAT_CURVE_FORMAT_CSV;
    note_table(work, names, by_size);
    return status;
}

/// Find the header of a table. A line that begins with '#' is one where it has separators and names of poses.
static bool find_header(translation *work, text_line *head, header *names, csv_field *time)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    text_line line = text_line_start(work->source);
    size_t count;
    bool found = false;
    while (text_line_next(work->source, &line))
    {
        if (line.begin == line.end)
            continue;
        bool comment = *line.begin == '#';
        char separator = csv_find_separator(&line);
        if ((comment && (separator == ' ' || found)) || csv_split(work->source, &line, separator, fields, &count) != NULL)
        {
            if (comment)
                continue;
            return false;
        }
        if (found)
        {
            size_t place = work->columns[TIME];
            *time = place != BAT_NO_INDEX && place < count ? fields[place] : (csv_field){line.end, line.end};
            return true;
        }
        for (size_t i = 0; i < count && !comment; i++)
            if (number_resembles(fields[i].begin, fields[i].end) && !csv_is_missing(fields[i]))
                return false;
        read_roles(work, fields, count, names);
        bool timed = count_roles(work, X, 3) == 3 && decimals_of(work->time_unit) > 0;
        found = !comment || has_orientation(work) || timed;
        work->separator = separator;
        *head = line;
    }
    return false;
}

static bat_status guess(translation *work, bool names_alone, bat_error *error)
{
    text_line head;
    header names;
    csv_field time;
    bool by_size;
    double first = 0;
    char separator = ' ';
    if (find_header(work, &head, &names, &time) && wants_table(work, &names, time, &by_size))
    {
        if (by_size)
            work->time_unit = unit_by_size(time);
        return translate_table(work, &head, &names, by_size, error);
    }
    const char *space = work->options->space;
    if (names_alone || (space != NULL && strcmp(space, "rigid") != 0))
        return BAT_OK;
    if (probe(work, KITTI_NUMBERS, &first, &separator))
        return translate_kitti(work, error);
    if (probe(work, EUROC_NUMBERS, &first, &separator) && first >= 1e17)
        return translate_euroc(work, false, error);
    if (!probe(work, TUM_NUMBERS, &first, &separator))
        return BAT_OK;
    if (separator != ' ' && separator != '\t' && first >= 1e17)
        return translate_euroc(work, false, error);
    if (separator != ' ' && separator != '\t')
        return space != NULL ? BAT_OK
                             : error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0,
                                         "the rows look like times, positions and quaternions, but nothing names their "
                                         "order; --from tum takes quaternions as x y z w, --space euclidean takes numbers");
    work->reader = work->format = BAT_CURVE_FORMAT_TUM;
    work->as_it_is = true;
    add_note(work,
             "a TUM trajectory, by its content: times in seconds, positions, quaternions x y z w from the body's frame "
             "to the fixed one");
    return BAT_OK;
}

static bat_status read_translated(translation *work, bat_curve_set *set, bat_error *error)
{
    file_text made = {work->text.data, work->text.size};
    bat_curve_read_options options = *work->options;
    options.format = BAT_CURVE_FORMAT_AUTO;
    const file_text *text = work->as_it_is ? work->source : &made;
    bat_status status =
        work->reader == BAT_CURVE_FORMAT_TUM ? tum_read(text, &options, set, error) : csv_read(text, &options, set, error);
    if (status != BAT_OK)
        return status;
    set->attributes->format = work->format;
    for (size_t i = 0; i < work->note_count; i++)
        if (!attributes_note(set->attributes, "%s", work->notes[i]))
        {
            bat_curve_set_free(set);
            return error_memory(error, NOTE_SIZE);
        }
    return BAT_OK;
}

bat_status poses_read(const file_text *text, bat_curve_format format, const bat_curve_read_options *options,
                      bat_curve_set *set, bool *taken, bat_error *error)
{
    *taken = true;
    bat_curve_set made = {0};
    translation *work = calloc(1, sizeof *work);
    if (work == NULL)
        return error_memory(error, sizeof *work);
    work->source = text;
    work->options = options;
    bool forced = format == BAT_CURVE_FORMAT_EUROC || format == BAT_CURVE_FORMAT_KITTI;
    bat_status status = BAT_OK;
    if (forced && options->space != NULL && strcmp(options->space, "rigid") != 0)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "%s poses are in the space rigid, not %.60s",
                           bat_curve_format_name(format), options->space);
    else if (format == BAT_CURVE_FORMAT_KITTI)
        status = translate_kitti(work, error);
    else if (format == BAT_CURVE_FORMAT_EUROC)
        status = translate_euroc(work, true, error);
    else if (options->columns == NULL && options->group == NULL)
        status = guess(work, format == BAT_CURVE_FORMAT_CSV, error);
    text_append(&work->text, "", 1);
    if (status == BAT_OK && work->text.failed)
        status = error_memory(error, text->size);
    else if (!work->text.failed)
        work->text.size--;
    *taken = status != BAT_OK || work->reader != BAT_CURVE_FORMAT_AUTO;
    if (status == BAT_OK && *taken)
        status = read_translated(work, &made, error);
    if (status == BAT_OK && *taken)
        *set = made;
    text_free(&work->text);
    free(work);
    return status;
}

bat_status euroc_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bool taken;
    return poses_read(text, BAT_CURVE_FORMAT_EUROC, options, set, &taken, error);
}

bat_status kitti_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bool taken;
    return poses_read(text, BAT_CURVE_FORMAT_KITTI, options, set, &taken, error);
}
