#include "curve/point_form.h"

#include "linalg/vector.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/// @file
/// The table of point forms, and conversions between columns and coordinates.

/// Tolerances of quaternions' lengths and of matrices' distances from a rotation, per entry. Numbers in files are rounded.
static const double LENGTH_TOLERANCE = 1e-3;
static const double MATRIX_TOLERANCE = 1e-6;
/// Quaternions with a squared length this near to 1 remain unchanged.
static const double LENGTH_ROUNDING = 1e-15;
/// The largest normal component of a velocity, relative to its length.
static const double TANGENT_TOLERANCE = 1e-6;

#define QUATERNION "qw", "qx", "qy", "qz"
#define MATRIX "m11", "m12", "m13", "m21", "m22", "m23", "m31", "m32", "m33"
#define VECTOR "rx", "ry", "rz"
#define MOVED "tx", "ty", "tz"
#define PLACED "x", "y", "z"
#define NAMES(...) ((const char *const[]){__VA_ARGS__, NULL})

static const char *const TURNS[] = {"wx", "wy", "wz", NULL};
static const char *const MOTIONS[] = {"vx", "vy", "vz", "wx", "wy", "wz", NULL};
static const char *const SPEEDS[] = {"vx", "vy", "vz", NULL};
static const char *const PLANE_SPEEDS[] = {"vx", "vy", NULL};
static const char *const TENSOR_SPEEDS[] = {"vxx", "vxy", "vxz", "vyy", "vyz", "vzz", NULL};
static const char *const PLANE_TENSOR_SPEEDS[] = {"vxx", "vxy", "vyy", NULL};

/// The forms of a space in order of preference. Forms with more columns come before forms whose names they contain.
static const point_form FORMS[] = {
    {"rotation", NAMES(QUATERNION), TURNS, 4, 3, ROTATION_QUATERNION, 0, true},
    {"rotation", NAMES(MATRIX), TURNS, 9, 3, ROTATION_MATRIX, 0, true},
    {"rotation", NAMES(VECTOR), TURNS, 3, 3, ROTATION_VECTOR, 0, true},
    {"rigid", NAMES(MOVED, QUATERNION), MOTIONS, 7, 6, ROTATION_QUATERNION, 3, true},
    {"rigid", NAMES(MOVED, MATRIX), MOTIONS, 12, 6, ROTATION_MATRIX, 3, true},
    {"rigid", NAMES(MOVED, VECTOR), MOTIONS, 6, 6, ROTATION_VECTOR, 3, true},
    {"rigid", NAMES(PLACED, QUATERNION), MOTIONS, 7, 6, ROTATION_QUATERNION, 3, true},
    {"rigid", NAMES(PLACED, MATRIX), MOTIONS, 12, 6, ROTATION_MATRIX, 3, true},
    {"rigid", NAMES(PLACED, VECTOR), MOTIONS, 6, 6, ROTATION_VECTOR, 3, true},
    {"spd", NAMES("xx", "xy", "xz", "yy", "yz", "zz"), TENSOR_SPEEDS, 6, 6, ROTATION_NONE, 0, true},
    {"spd", NAMES("xx", "xy", "yy"), PLANE_TENSOR_SPEEDS, 3, 3, ROTATION_NONE, 0, true},
    {"plane", NAMES("x", "y"), PLANE_SPEEDS, 2, 2, ROTATION_NONE, 0, false},
    {"disk", NAMES("x", "y"), PLANE_SPEEDS, 2, 2, ROTATION_NONE, 0, false},
    {"sphere", NAMES("x", "y", "z"), SPEEDS, 3, 3, ROTATION_NONE, 0, false},
    {"euclidean", NAMES("x", "y", "z"), SPEEDS, 3, 3, ROTATION_NONE, 0, false},
    {"euclidean", NAMES("x"), NAMES("vx"), 1, 1, ROTATION_NONE, 0, false},
};
static const int FORM_COUNT = sizeof FORMS / sizeof FORMS[0];

static const char *const TIMES[] = {"time", "t", "timestamp"};
/// Units of times in names, with the decimals of seconds that they have.
static const struct
{
    const char *name;
    int decimals;
} TIME_UNITS[] = {{"s", 0}, {"sec", 0}, {"seconds", 0}, {"ms", 3}, {"us", 6}, {"ns", 9}, {"nsec", 9}, {"nanoseconds", 9}};

static bool name_is(const char *column, const char *name)
{
    size_t length = strlen(name);
    bool quoted = column[0] == '"';
    return strncasecmp(column + quoted, name, length) == 0 && strcmp(column + quoted + length, quoted ? "\"" : "") == 0;
}

size_t column_find(const column_names *columns, const char *name)
{
    for (size_t i = 0; columns->names != NULL && i < columns->count; i++)
        if (name_is(columns->names[i], name))
            return i;
    return BAT_NO_INDEX;
}

int time_unit_decimals(const char *text, size_t size)
{
    for (size_t i = 0; i < sizeof TIME_UNITS / sizeof *TIME_UNITS; i++)
        if (strlen(TIME_UNITS[i].name) == size && strncasecmp(text, TIME_UNITS[i].name, size) == 0)
            return TIME_UNITS[i].decimals;
    return -1;
}

/// Whether a column is called by a name, an underscore or a blank, and a unit of time, which may be in brackets.
static bool name_has_unit(const char *column, const char *name, int *decimals)
{
    size_t length = strlen(name);
    column += column[0] == '"';
    if (strncasecmp(column, name, length) != 0 || strchr("_ [(", column[length]) == NULL || column[length] == '\0')
        return false;
    column += length + strspn(column + length, "_ [(");
    size_t size = strcspn(column, ")] \"");
    const char *rest = column + size;
    *decimals = rest[strspn(rest, ")] \"")] == '\0' ? time_unit_decimals(column, size) : -1;
    return *decimals >= 0;
}

size_t column_find_time(const column_names *columns, int *decimals)
{
    for (size_t i = 0; i < sizeof TIMES / sizeof *TIMES; i++)
    {
        size_t column = column_find(columns, TIMES[i]);
        if (decimals != NULL)
            *decimals = -1;
        for (size_t j = 0; decimals != NULL && column == BAT_NO_INDEX && columns->names != NULL && j < columns->count; j++)
            if (name_has_unit(columns->names[j], TIMES[i], decimals))
                return j;
        if (column != BAT_NO_INDEX)
            return column;
    }
    return BAT_NO_INDEX;
}

/// The number of names that exist; *missing is the first one that does not, or null.
static size_t count_found(const column_names *columns, const char *const *names, const char **missing)
{
    size_t found = 0;
    *missing = NULL;
    for (; *names != NULL; names++)
        if (column_find(columns, *names) != BAT_NO_INDEX)
            found++;
        else if (*missing == NULL)
            *missing = *names;
    return found;
}

const point_form *point_form_first(const char *space, size_t count)
{
    for (size_t i = 0; i < FORM_COUNT; i++)
    {
        size_t coordinates = FORMS[i].rotation == ROTATION_NONE ? FORMS[i].count : FORMS[i].rotation_at + 4;
        if (strcmp(FORMS[i].space, space) == 0 && coordinates == count)
            return &FORMS[i];
    }
    return NULL;
}

/// Whether any name of a space's strict forms exists.
static bool any_known(const char *space, const column_names *columns)
{
    const char *missing;
    for (size_t i = 0; i < FORM_COUNT; i++)
        if (strcmp(FORMS[i].space, space) == 0 &&
            (count_found(columns, FORMS[i].names, &missing) > 0 || count_found(columns, FORMS[i].velocities, &missing) > 0))
            return true;
    return column_find_time(columns, NULL) != BAT_NO_INDEX;
}

const point_form *point_form_find(const char *space, const column_names *columns)
{
    const char *missing;
    for (size_t i = 0; columns->names != NULL && i < FORM_COUNT; i++)
        if (strcmp(FORMS[i].space, space) == 0 && count_found(columns, FORMS[i].names, &missing) == FORMS[i].count)
            return &FORMS[i];
    bool positional = columns->names == NULL || !any_known(space, columns);
    const point_form *first = positional ? point_form_first(space, columns->count) : NULL;
    return first != NULL && first->strict ? first : NULL;
}

const point_form *point_form_of_motion(const column_names *columns)
{
    static const char *const spaces[] = {"rigid", "rotation", "spd"};
    for (size_t i = 0; columns->names != NULL && i < sizeof spaces / sizeof *spaces; i++)
    {
        const point_form *form = point_form_find(spaces[i], columns);
        if (form != NULL && form->strict && column_find(columns, form->names[0]) != BAT_NO_INDEX)
            return form;
    }
    return NULL;
}

size_t point_form_find_velocities(const point_form *form, const column_names *columns, size_t found[MAX_VELOCITIES])
{
    size_t part = form->rotation_at > 0 ? form->rotation_at : form->velocity_count, count = 0;
    for (size_t first = 0; first < form->velocity_count; first += part)
    {
        bool whole = true;
        for (size_t i = first; i < first + part; i++)
        {
            found[i] = column_find(columns, form->velocities[i]);
            whole = whole && found[i] != BAT_NO_INDEX;
        }
        for (size_t i = first; i < first + part && !whole; i++)
            found[i] = BAT_NO_INDEX;
        count += whole ? part : 0;
    }
    return count;
}

/// The form of a space with the most existing columns, and its first missing column.
static const point_form *nearest_form(const char *space, const column_names *columns, const char **missing)
{
    const point_form *nearest = NULL;
    size_t max_found = 0;
    for (size_t i = 0; i < FORM_COUNT; i++)
    {
        const char *absent;
        if (strcmp(FORMS[i].space, space) != 0)
            continue;
        size_t found = count_found(columns, FORMS[i].names, &absent);
        if (nearest != NULL && found <= max_found)
            continue;
        nearest = &FORMS[i];
        max_found = found;
        *missing = absent;
    }
    return nearest;
}

static bool is_one_of(const char *column, const char *const *names)
{
    for (; *names != NULL; names++)
        if (name_is(column, *names))
            return true;
    return false;
}

/// The first column without a meaning in a form, or null.
static const char *unknown_column(const point_form *form, const column_names *columns)
{
    int decimals;
    size_t time = column_find_time(columns, &decimals);
    for (size_t i = 0; i < columns->count; i++)
        if (i != time && !is_one_of(columns->names[i], form->names) && !is_one_of(columns->names[i], form->velocities))
            return columns->names[i];
    return NULL;
}

/// The first column whose name is there twice, or null.
static const char *repeated_column(const column_names *columns)
{
    for (size_t i = 1; i < columns->count; i++)
        for (size_t j = 0; j < i; j++)
            if (strcasecmp(columns->names[i], columns->names[j]) == 0)
                return columns->names[i];
    return NULL;
}

bool point_form_fault(const char *space, const point_form *form, const column_names *columns, char *text, size_t size)
{
    const char *missing = NULL;
    const point_form *nearest = nearest_form(space, columns, &missing);
    if (columns->names == NULL || nearest == NULL || !nearest->strict || !any_known(space, columns))
        return false;
    if (form == NULL)
    {
        (void)snprintf(text, size, "a point of the space %s needs a column '%s'", space, missing);
        return true;
    }
    const char *unknown = unknown_column(form, columns), *repeated = repeated_column(columns);
    size_t whole[MAX_VELOCITIES], velocities = count_found(columns, form->velocities, &missing);
    if (unknown != NULL)
        (void)snprintf(text, size, "the column '%.60s' has no meaning beside '%s' in the space %s", unknown, form->names[0],
                       space);
    else if (repeated != NULL)
        (void)snprintf(text, size, "the column '%.60s' is there twice", repeated);
    else if (velocities > point_form_find_velocities(form, columns, whole))
        (void)snprintf(text, size, "a velocity in the space %s needs a column '%s'", space, missing);
    else
        return false;
    return true;
}

bool point_form_incomplete(const point_form *form, const column_names *columns, char *text, size_t size)
{
    bool turned = form != NULL && form->rotation != ROTATION_NONE;
    for (size_t i = 0; columns->names != NULL && !turned && i < FORM_COUNT; i++)
    {
        const char *missing;
        bool unmistakable = FORMS[i].rotation == ROTATION_QUATERNION || FORMS[i].rotation == ROTATION_MATRIX;
        if (!unmistakable || FORMS[i].rotation_at > 0 || count_found(columns, FORMS[i].names, &missing) == 0 ||
            missing == NULL)
            continue;
        (void)snprintf(text, size, "a %s needs a column '%s'; where it is no %s, name the space",
                       FORMS[i].rotation == ROTATION_QUATERNION ? "quaternion" : "rotation matrix", missing,
                       FORMS[i].rotation == ROTATION_QUATERNION ? "quaternion" : "rotation matrix");
        return true;
    }
    return false;
}

static const char *read_quaternion(const double *numbers, bool project, double *quaternion)
{
    double square = 0, largest = 0;
    for (int i = 0; i < 4; i++)
    {
        square += numbers[i] * numbers[i];
        largest = fmax(largest, fabs(numbers[i]));
    }
    if (!(largest > 0))
        return "the quaternion is zero";
    if (fabs(square - 1) <= LENGTH_ROUNDING)
    {
        memcpy(quaternion, numbers, 4 * sizeof *numbers);
        return NULL;
    }
    if (!project && !(fabs(sqrt(square) - 1) <= LENGTH_TOLERANCE))
        return "the quaternion is not of unit length";
    double scaled = 0;
    for (int i = 0; i < 4; i++)
        scaled += numbers[i] / largest * (numbers[i] / largest);
    for (int i = 0; i < 4; i++)
        quaternion[i] = numbers[i] / largest / sqrt(scaled);
    return NULL;
}

static const char *read_matrix(const double *numbers, bool project, double *quaternion)
{
    static const char fault[] = "the matrix is not a rotation";
    double rotation[9];
    if (bat_rotation_from_matrix(numbers, quaternion, NULL) == BAT_OK)
        return NULL;
    if (bat_rotation_nearest(numbers, quaternion, NULL) != BAT_OK)
        return fault;
    bat_rotation_to_matrix(quaternion, rotation);
    for (int i = 0; i < 9 && !project; i++)
        if (!(fabs(rotation[i] - numbers[i]) <= MATRIX_TOLERANCE))
            return fault;
    return NULL;
}

const char *point_form_read(const point_form *form, const double *numbers, bool project, double *point)
{
    size_t before = form->rotation == ROTATION_NONE ? form->count : form->rotation_at;
    const double *from = numbers + before;
    double *to = point + before;
    memcpy(point, numbers, before * sizeof *point);
    if (form->rotation == ROTATION_QUATERNION)
        return read_quaternion(from, project, to);
    if (form->rotation == ROTATION_MATRIX)
        return read_matrix(from, project, to);
    bool too_long = form->rotation == ROTATION_VECTOR && bat_rotation_from_vector(from, to, NULL) != BAT_OK;
    return too_long ? "the rotation vector is too long" : NULL;
}

void point_form_write(const point_form *form, const double *point, double *numbers)
{
    size_t before = form->rotation == ROTATION_NONE ? form->count : form->rotation_at;
    const double *from = point + before;
    double *to = numbers + before;
    memcpy(numbers, point, before * sizeof *point);
    if (form->rotation == ROTATION_QUATERNION)
        memcpy(to, from, 4 * sizeof *to);
    else if (form->rotation == ROTATION_MATRIX)
        bat_rotation_to_matrix(from, to);
    else if (form->rotation == ROTATION_VECTOR)
        bat_rotation_to_vector(from, to);
}

/// The factor of velocities in the disk: at the centre the metric is 4 times the Euclidean one.
static double disk_scale(const double *point)
{
    return 2 / ((1 - hypot(point[0], point[1])) * (1 + hypot(point[0], point[1])));
}

/// Remove the normal component of a tangent vector of the sphere, if it is within the tolerance.
static void make_tangent(const double *point, double *tangent)
{
    double length = hypot(hypot(tangent[0], tangent[1]), tangent[2]);
    double out = point[0] * tangent[0] + point[1] * tangent[1] + point[2] * tangent[2];
    for (int i = 0; i < 3 && fabs(out) <= TANGENT_TOLERANCE * length; i++)
        tangent[i] -= out * point[i];
}

bool point_form_tangent(const point_form *form, const bat_space *space, const double *point, const double *velocity,
                        double *tangent)
{
    if (strcmp(form->space, "spd") == 0)
        return bat_positive_definite_tangent(space, point, velocity, tangent) == BAT_OK;
    double scale = strcmp(form->space, "disk") == 0 ? disk_scale(point) : 1;
    for (size_t i = 0; i < form->velocity_count; i++)
        tangent[i] = scale * velocity[i];
    if (strcmp(form->space, "sphere") == 0)
        make_tangent(point, tangent);
    return true;
}

bool point_form_velocity(const point_form *form, const bat_space *space, const double *point, const double *tangent,
                         double *velocity)
{
    if (strcmp(form->space, "spd") == 0)
        return bat_positive_definite_velocity(space, point, tangent, velocity) == BAT_OK;
    double scale = strcmp(form->space, "disk") == 0 ? 1 / disk_scale(point) : 1;
    for (size_t i = 0; i < form->velocity_count; i++)
        velocity[i] = scale * tangent[i];
    return true;
}

size_t quaternion_place(const bat_space *space)
{
    return strcmp(space->name, "rotation") == 0 ? 0 : strcmp(space->name, "rigid") == 0 ? 3 : BAT_NO_INDEX;
}

void quaternion_continue(const double *before, double *quaternion)
{
    double product = vector_dot(4, before, quaternion);
    for (int i = 0; i < 4 && product < 0; i++)
        quaternion[i] = 0 - quaternion[i]; // avoids -0
}
