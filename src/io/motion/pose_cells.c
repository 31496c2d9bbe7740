#include "io/motion/pose_translation.h"

#include <stdarg.h>

void pose_note(pose_translation *work, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (work->note_count < POSE_NOTES)
        (void)vsnprintf(work->notes[work->note_count++], POSE_NOTE_SIZE, format, values);
    va_end(values);
}

bool pose_read_numbers(const file_text *source, const text_line *line, size_t count, double *numbers, char *separator)
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

void pose_write_tum(pose_translation *work, const double *place, const double *quaternion)
{
    const double row[7] = {place[0], place[1], place[2], quaternion[1], quaternion[2], quaternion[3], quaternion[0]};
    for (int i = 0; i < 7; i++)
        text_append_real(&work->text, " ", row[i]);
}

void pose_write_row(pose_translation *work, double time, const double *place, const double *quaternion)
{
    text_append_real(&work->text, "", time);
    pose_write_tum(work, place, quaternion);
    text_append_string(&work->text, "\n");
}

const char *pose_time_copy(csv_field cell, char separator, text_buffer *text)
{
    iso_time iso;
    double value;
    bool comma = false;
    cell = csv_unquoted(cell);
    const char *fault = iso_time_read(cell.begin, cell.end, &iso) ? NULL : csv_read_number(cell, separator, &value, &comma);
    for (const char *at = cell.begin; at < cell.end && fault == NULL; at++)
        text_append(text, *at == ',' ? "." : at, 1);
    return fault;
}

const char *pose_time_join(csv_field seconds, csv_field nanoseconds, text_buffer *text)
{
    static const int64_t BILLION = 1000000000;
    int64_t whole, part;
    char time[EXACT_TIME_SIZE + 1];
    if (!csv_read_whole(csv_unquoted(seconds), INT64_DIGITS, &whole) ||
        !csv_read_whole(csv_unquoted(nanoseconds), INT64_DIGITS, &part))
        return "not a whole number";
    if (part < 0 || part >= BILLION || whole > INT64_MAX / BILLION - 1 || whole < 0)
        return "out of range";
    *nanoseconds_write(time, whole * BILLION + part) = '\0';
    text_append_string(text, time);
    return NULL;
}

/// Names of columns after pose_name_normalize(). The canonical ones the CSV reader knows itself. Those of vectors come
/// before the letter of an axis: "position_x", "q_w".
static const struct
{
    role first; ///< that of x for vectors
    bool canonical, vector;
    const char *names[10]; ///< up to null
} NAMES[] = {
    {TIME, true, false, {"time", "t", "timestamp"}},
    {TIME, false, false, {"stamp"}},
    {SECONDS, false, false, {"sec", "secs", "stamp_sec", "stamp_secs"}},
    {NANOSECONDS, false, false, {"nsec", "nsecs", "nanosec", "stamp_nsec", "stamp_nsecs", "stamp_nanosec"}},
    {ROLL, false, false, {"roll"}},
    {PITCH, false, false, {"pitch"}},
    {YAW, false, false, {"yaw"}},
    {X, true, true, {"", "t"}},
    {QX, true, true, {"q"}},
    {VX, true, true, {"v"}},
    {WX, true, true, {"w"}},
    {X, false, true, {"p_", "p", "pos_", "position_", "translation_", "transform_translation_", "p_rs_r_"}},
    {QX, false, true, {"q_", "quat_", "quaternion_", "orientation_", "rot_", "rotation_", "transform_rotation_", "q_rs_"}},
    {VX, false, true, {"v_rs_r_"}},
    {RX, false, true, {"g", "gyr_", "gyro_", "gyroscope_", "w_", "omega_", "w_rs_s_", "angular_velocity_"}},
    {AX, false, true, {"a", "acc_", "accel_", "accelerometer_", "a_rs_s_", "acceleration_", "linear_acceleration_"}}};
/// Prefixes of messages, which are dropped.
static const char *const PREFIXES[] = {"_", "%", "#", "field_", "header_", "pose_", "msg_", "data_"};

static const struct
{
    column_unit unit;
    const char *names[5]; ///< up to null
} UNITS[] = {{UNIT_DEGREES, {"deg", "degree", "degrees", "\xC2\xB0"}},
             {UNIT_RADIANS, {"rad", "radian", "radians"}},
             {UNIT_DEGREES_A_SECOND, {"deg/s", "\xC2\xB0/s", "deg s^-1", "dps"}},
             {UNIT_RADIANS_A_SECOND, {"rad/s", "rad s^-1"}},
             {UNIT_METRES, {"m/s2", "m/s^2", "m s^-2", "m/s\xC2\xB2"}},
             {UNIT_GRAVITIES, {"g"}}};

int pose_unit_decimals(column_unit unit)
{
    return unit >= UNIT_SECONDS && unit <= UNIT_NANO ? 3 * ((int)unit - (int)UNIT_SECONDS) : 0;
}

/// The unit of a text; UNIT_NONE where it is not known as one.
static column_unit unit_of(const char *text)
{
    int decimals = time_unit_decimals(text, strlen(text));
    if (decimals >= 0)
        return (column_unit)((int)UNIT_SECONDS + decimals / 3);
    for (size_t i = 0; i < sizeof UNITS / sizeof *UNITS; i++)
        for (size_t j = 0; UNITS[i].names[j] != NULL; j++)
            if (strcmp(text, UNITS[i].names[j]) == 0)
                return UNITS[i].unit;
    return UNIT_NONE;
}

bool pose_name_is_px4(csv_field field)
{
    field = csv_unquoted(field);
    return field.end - field.begin == 4 && strncmp(field.begin, "q[", 2) == 0 && field.begin[2] >= '0' &&
           field.begin[2] <= '3' && field.begin[3] == ']';
}

void pose_name_normalize(csv_field field, char name[POSE_NAME_SIZE], column_unit *found)
{
    size_t length = 0;
    field = csv_unquoted(field);
    *found = UNIT_NONE;
    char unit_name[POSE_NAME_SIZE] = "";
    if (pose_name_is_px4(field))
    {
        (void)snprintf(name, POSE_NAME_SIZE, "q%c", "wxyz"[field.begin[2] - '0']);
        return;
    }
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
    column_unit unit = unit_of(unit_name);
    *found = unit != UNIT_NONE ? unit : *found;
    // "time_ns", "yaw_deg"; "stamp_sec" has a meaning of its own.
    bool angle = strncmp(name, "roll_", 5) == 0 || strncmp(name, "pitch_", 6) == 0 || strncmp(name, "yaw_", 4) == 0;
    bool time = strncmp(name, "time_", 5) == 0 || strncmp(name, "timestamp_", 10) == 0 || strncmp(name, "t_", 2) == 0;
    unit = last != NULL && (angle || time) && *found == UNIT_NONE ? unit_of(last + 1) : UNIT_NONE;
    if (unit == UNIT_NONE)
        return;
    *found = unit;
    *last = '\0';
}

role pose_name_role(const char *name, bool *canonical)
{
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++)
        for (size_t j = 0; NAMES[i].names[j] != NULL; j++)
        {
            size_t size = strlen(NAMES[i].names[j]);
            if (strncmp(name, NAMES[i].names[j], size) != 0 || strlen(name) != size + NAMES[i].vector)
                continue;
            char axis = name[size];
            *canonical = NAMES[i].canonical;
            if (!NAMES[i].vector || (axis >= (NAMES[i].first == QX ? 'w' : 'x') && axis <= 'z'))
                return (role)((int)NAMES[i].first + (NAMES[i].vector ? axis - 'x' : 0));
        }
    *canonical = false;
    return ROLES;
}
