#include "io/motion/pose_translation.h"
#include "space/quaternion.h"

/// @file
/// Tables of poses with the names of columns.

/// Append seconds and nanoseconds of two columns as seconds. Returns null, or an error text.
static const char *pose_time_join(csv_field seconds, csv_field nanoseconds, text_buffer *text)
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

/// Whether a column is a part of a quaternion as logs of PX4 name it: "q[0]" is w.
static bool pose_name_is_px4(csv_field field)
{
    field = csv_unquoted(field);
    return field.end - field.begin == 4 && strncmp(field.begin, "q[", 2) == 0 && field.begin[2] >= '0' &&
           field.begin[2] <= '3' && field.begin[3] == ']';
}

/// The name of a column in lower case without quotes, unit and prefixes, with '_' for dots, slashes and blanks.
static void pose_name_normalize(csv_field field, char name[POSE_NAME_SIZE], column_unit *found)
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

/// The role of a normalized name, or ROLES. `*canonical` tells whether the reader of CSV knows the name itself.
static role pose_name_role(const char *name, bool *canonical)
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

static const char *const OUTPUT_NAMES[ROLES] = {
    [TIME] = "time", [X] = "tx",  [Y] = "ty",  [Z] = "tz",  [QW] = "qw", [QX] = "qx", [QY] = "qy",
    [QZ] = "qz",     [VX] = "vx", [VY] = "vy", [VZ] = "vz", [WX] = "wx", [WY] = "wy", [WZ] = "wz",
    [RX] = "wx",     [RY] = "wy", [RZ] = "wz", [AX] = "ax", [AY] = "ay", [AZ] = "az"};

/// How many of `count` roles have columns.
static size_t count_roles(const pose_translation *work, role first, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += work->columns[(size_t)first + i] != BAT_NO_INDEX;
    return found;
}

static void read_roles(pose_translation *work, const csv_field *fields, size_t count, pose_header *names)
{
    *names = (pose_header){.twice = BAT_NO_INDEX};
    memset(work->columns, 0xFF, sizeof work->columns); // BAT_NO_INDEX
    memset(work->units, 0, sizeof work->units);
    for (size_t i = 0; i < count; i++)
    {
        char name[POSE_NAME_SIZE] = "";
        bool canonical;
        column_unit found;
        pose_name_normalize(fields[i], name, &found);
        role what = pose_name_role(name, &canonical);
        names->globe = names->globe || strncmp(name, "lon", 3) == 0 || strncmp(name, "lat", 3) == 0;
        names->euroc = names->euroc || strncmp(name, "q_rs_", 5) == 0;
        names->px4 = names->px4 || strcmp(name, "timestamp_sample") == 0 || pose_name_is_px4(fields[i]);
        if (what > WZ && what < ROLES && work->columns[what] == BAT_NO_INDEX)
        {
            work->columns[what] = i;
            work->units[what] = found;
        }
        if (what > WZ)
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
        work->units[what] = found;
    }
    if (names->px4 && work->units[TIME] == UNIT_NONE)
        work->units[TIME] = UNIT_MICRO;
    work->width = count;
}

/// Whether orientations are by roll, pitch and yaw.
static bool has_angles(const pose_translation *work)
{
    return count_roles(work, QW, 4) < 4 && count_roles(work, ROLL, 3) == 3;
}

static bool has_orientation(const pose_translation *work)
{
    return has_angles(work) || count_roles(work, QW, 4) == 4;
}

/// The order and the unit of angles, by the names and the option.
static bat_status choose_angles(pose_translation *work, size_t line, bat_error *error)
{
    const char *euler = work->options->euler;
    column_unit found = work->units[ROLL], asked = UNIT_NONE;
    (void)snprintf(work->order, sizeof work->order, "%.3s", euler != NULL ? euler : "zyx");
    if (euler != NULL && strlen(euler) > 3)
        asked = strcmp(euler + 4, "degrees") == 0 ? UNIT_DEGREES : UNIT_RADIANS;
    if (work->units[PITCH] != found || work->units[YAW] != found)
        return ERROR_FILE(error, line, "roll, pitch and yaw have different units in their names");
    bool named = found == UNIT_DEGREES || found == UNIT_RADIANS;
    if (!named && asked == UNIT_NONE)
        return error_remedy(error, ERROR_FILE(error, line, "roll, pitch and yaw have no unit in their names"), "euler",
                            "names it, as in zyx,degrees or zyx,radians");
    if (named && asked != UNIT_NONE && asked != found)
        return ERROR_FILE(error, line, "the names of roll, pitch and yaw tell another unit than the option euler");
    work->angle_unit = named ? found : asked;
    return BAT_OK;
}

/// Append the quaternion of three angles: turns about the body's axes in the order of the letters.
static void turn_by_angles(const pose_translation *work, const double angles[3], double *quaternion)
{
    double before[4], turn[3] = {0};
    memcpy(quaternion, (const double[]){1, 0, 0, 0}, sizeof before);
    for (int k = 0; k < 3; k++)
    {
        int axis = work->order[k] - 'x';
        memcpy(before, quaternion, sizeof before);
        turn[axis] = angles[axis] * (work->angle_unit == UNIT_DEGREES ? ANGLE_DEGREE : 1);
        quaternion_turn(before, turn[0], turn[1], turn[2], quaternion);
        turn[axis] = 0;
    }
}

static bat_status cell_fault(const csv_field *fields, size_t column, size_t line, const char *fault, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    return ERROR_FILE(error, line, "column %zu: '%s' %s", column + 1,
                      text_excerpt(excerpt, fields[column].begin, fields[column].end), fault);
}

/// What makes a rate radians a second, an acceleration metres a square second; NaN for a unit of other things.
static double scale_of(role what, column_unit unit)
{
    static const double GRAVITY = 9.80665; // of the third General Conference on Weights and Measures
    if (what < RX || unit == UNIT_NONE || unit == (what < AX ? UNIT_RADIANS_A_SECOND : UNIT_METRES))
        return 1;
    return unit != (what < AX ? UNIT_DEGREES_A_SECOND : UNIT_GRAVITIES) ? NAN : what < AX ? ANGLE_DEGREE : GRAVITY;
}

static bat_status translate_row(pose_translation *work, const text_line *line, bat_error *error)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t count;
    bool comma = false;
    double numbers[ROLES] = {0};
    const char *fault = csv_split(work->source, line, work->separator, fields, &count);
    if (fault != NULL)
        return ERROR_FILE(error, line->number, "%s", fault);
    while (count > work->width && fields[count - 1].begin == fields[count - 1].end)
        count--;
    if (count < work->width || (count > work->width && work->options != NULL)) // without options: of rates
        return ERROR_FILE(error, line->number, "%zu columns, but the header has %zu", count, work->width);
    size_t timed = work->columns[SECONDS] != BAT_NO_INDEX ? work->columns[SECONDS] : work->columns[TIME];
    if (work->columns[SECONDS] != BAT_NO_INDEX)
        fault = pose_time_join(fields[timed], fields[work->columns[NANOSECONDS]], &work->text);
    else if (timed != BAT_NO_INDEX)
        fault = pose_time_copy(fields[timed], work->separator, &work->text);
    if (fault != NULL)
        return cell_fault(fields, timed, line->number, fault, error);
    for (size_t i = X; i < ROLES; i++)
        if (work->columns[i] != BAT_NO_INDEX &&
            (fault = csv_read_number(fields[work->columns[i]], work->separator, &numbers[i], &comma)) != NULL)
            return cell_fault(fields, work->columns[i], line->number, fault, error);
    bool angles = has_angles(work);
    if (angles)
        turn_by_angles(work, numbers + ROLL, numbers + QW);
    bool first = timed == BAT_NO_INDEX;
    for (size_t i = X; i < ROLES; i++)
    {
        bool turned = angles && i >= QW && i <= QZ;
        if (OUTPUT_NAMES[i] == NULL || (work->columns[i] == BAT_NO_INDEX && !turned))
            continue;
        text_append_real(&work->text, first ? "" : ",", numbers[i] * scale_of((role)i, work->units[i]));
        first = false;
    }
    return BAT_OK; // a lack of memory is told at the end
}

static void write_names(pose_translation *work)
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
        if (i == TIME)
            text_append_string(&work->text, exact_time_suffix(pose_unit_decimals(work->units[TIME])));
        first = false;
    }
}

/// Check that the columns of a table make poses, and forget those that do not belong to one.
static bat_status check_table(pose_translation *work, pose_header *names, size_t line, bat_error *error)
{
    size_t places = count_roles(work, X, 3), speeds = count_roles(work, VX, 3), turns = count_roles(work, WX, 3);
    if (names->twice != BAT_NO_INDEX)
        return error_remedy(error, ERROR_FILE(error, line, "column %zu has the meaning of another one", names->twice + 1),
                            "columns", "names the coordinates");
    if ((work->columns[SECONDS] != BAT_NO_INDEX) != (work->columns[NANOSECONDS] != BAT_NO_INDEX))
        return ERROR_FILE(error, line, "of seconds and nanoseconds, only one column is there");
    if (places != 0 && places != 3)
        return ERROR_FILE(error, line, "a pose needs columns x, y and z, or none of them");
    for (size_t i = VX; i < ROLES; i++)
    {
        bool kept = i < WX ? speeds == 3 && places == 3 : i <= WZ && turns == 3 && has_orientation(work);
        if (!kept && i <= WZ && work->columns[i] != BAT_NO_INDEX)
            names->others++;
        work->columns[i] = kept ? work->columns[i] : BAT_NO_INDEX;
    }
    if (names->others > 0 && work->options->strict)
        return ERROR_FILE(error, line, "%zu columns are no part of a pose, as %.40s", names->others, names->other);
    return BAT_OK;
}

bool pose_wants_table(const pose_translation *work, const pose_header *names, csv_field time)
{
    iso_time iso;
    const char *space = work->options->space;
    bool turned = has_orientation(work), stamped = work->columns[SECONDS] != BAT_NO_INDEX;
    csv_field bare = csv_unquoted(time);
    bool by_size = work->units[TIME] == UNIT_NONE && exact_time_decimals(bare.begin, bare.end) > 0;
    bool scaled = stamped || by_size || pose_unit_decimals(work->units[TIME]) > 0;
    bool placed = count_roles(work, X, 3) == 3;
    if (names->globe || (space != NULL && strcmp(space, "rigid") != 0 && strcmp(space, "rotation") != 0))
        return false;
    if (turned)
        return names->foreign || scaled || iso_time_read(bare.begin, bare.end, &iso);
    return placed && (stamped || pose_unit_decimals(work->units[TIME]) > 0) && space == NULL;
}

static bat_status translate_lines(pose_translation *work, size_t header, bat_error *error)
{
    bat_status status = BAT_OK;
    text_line line = text_line_start(work->source);
    while (status == BAT_OK && text_line_next(work->source, &line))
    {
        if (line.number == header)
            write_names(work);
        else if (line.begin != line.end && *line.begin == '#')
            text_append(&work->text, line.begin, (size_t)(line.end - line.begin));
        else if (line.begin != line.end)
            status = translate_row(work, &line, error);
        text_append_string(&work->text, "\n");
    }
    return status;
}

bat_status pose_translate_table(pose_translation *work, const text_line *head, pose_header *names, bat_error *error)
{
    bat_status status = check_table(work, names, head->number, error);
    if (status == BAT_OK && has_angles(work))
        status = choose_angles(work, head->number, error);
    if (status == BAT_OK)
        status = translate_lines(work, head->number, error);
    work->reader = BAT_CURVE_FORMAT_CSV;
    work->format = names->euroc && has_orientation(work) && count_roles(work, X, 3) == 3 ? BAT_CURVE_FORMAT_EUROC
                                                                                         : BAT_CURVE_FORMAT_CSV;
    if (names->euroc)
        pose_note(work, "EuRoC poses of the body S in the reference frame R, quaternions w x y z");
    else if (has_angles(work))
        pose_note(work, "poses by roll, pitch and yaw in %s, turned about the body's axes in the order %s%s",
                  work->angle_unit == UNIT_DEGREES ? "degrees" : "radians", work->order,
                  work->options->euler != NULL ? "" : " (another can be named)");
    else if (has_orientation(work))
        pose_note(work, "poses by names of columns: quaternions from the body's frame to the fixed one");
    if (work->columns[SECONDS] != BAT_NO_INDEX)
        pose_note(work, "times in seconds and nanoseconds are seconds, with all of their digits");
    if (names->others > 0)
        pose_note(work, "left out %zu column%s no part of a pose%s%.40s", names->others,
                  names->others > 1 ? "s that are" : " that is", names->other[0] != '\0' ? ", as " : "", names->other);
    return status;
}

bool pose_find_header(pose_translation *work, text_line *head, pose_header *names, csv_field *time)
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
        bool timed = count_roles(work, X, 3) == 3 && pose_unit_decimals(work->units[TIME]) > 0;
        bool turns = count_roles(work, WX, 3) == 3 || count_roles(work, RX, 3) == 3;
        found = !comment || has_orientation(work) || timed || turns;
        work->separator = separator;
        *head = line;
    }
    return false;
}

bat_status pose_translate_rates(pose_translation *work, bat_error *error)
{
    text_line head;
    pose_header names;
    csv_field time;
    if (!pose_find_header(work, &head, &names, &time))
        return BAT_OK;
    role first = count_roles(work, RX, 3) > 0 ? RX : WX;
    memmove(work->columns + RX, work->columns + first, 3 * sizeof *work->columns);
    memmove(work->units + RX, work->units + first, 3 * sizeof *work->units);
    memset(work->columns + X, 0xFF, (RX - X) * sizeof *work->columns); // BAT_NO_INDEX
    bool timed =
        count_roles(work, SECONDS, 2) == 2 || (work->columns[TIME] != BAT_NO_INDEX && count_roles(work, SECONDS, 2) == 0);
    bool known = work->units[TIME] <= UNIT_NANO;
    for (size_t i = RX; i < ROLES; i++)
        known = known && !isnan(scale_of((role)i, work->units[i]));
    if (timed && known && count_roles(work, RX, 3) == 3 && count_roles(work, AX, 3) % 3 == 0)
        return translate_lines(work, head.number, error);
    return ERROR_FILE(error, head.number, "%s: %.*s",
                      !known ? "rates are in rad/s or deg/s, accelerations in m/s^2 or g, times in s to ns"
                             : "the names tell no time with rates gx, gy, gz, and accelerations ax, ay, az or none",
                      (int)(head.end - head.begin), head.begin);
}
