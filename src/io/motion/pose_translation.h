#pragma once

#include "io/common/time_text.h"
#include "io/curve/csv.h"

/// @file
/// The translation of a text of poses, line by line, and its parts: rows without names, matrices, tables with names.

// The names of columns that ROS, EuRoC and flight logs use for poses, and the units in them.

#define POSE_NAME_SIZE 64

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
    // Of inertial units, no part of poses:
    RX,
    RY,
    RZ,
    AX,
    AY,
    AZ,
    ROLES
} role;

typedef enum column_unit
{
    UNIT_NONE,
    UNIT_SECONDS,
    UNIT_MILLI,
    UNIT_MICRO,
    UNIT_NANO,
    UNIT_DEGREES,
    UNIT_RADIANS,
    UNIT_DEGREES_A_SECOND,
    UNIT_RADIANS_A_SECOND,
    UNIT_METRES, ///< a square second
    UNIT_GRAVITIES,
    UNIT_OTHER
} column_unit;

/// The decimals that a unit of time has below seconds.
int pose_unit_decimals(column_unit unit);

// The times of poses, which the reader of CSV understands: numbers in a unit, and ISO 8601.

/// Append a time as it is, with a decimal point. Returns null, or an error text.
const char *pose_time_copy(csv_field cell, char separator, text_buffer *text);

enum
{
    POSE_NOTES = 6,
    POSE_NOTE_SIZE = 240,
    TUM_NUMBERS = 8,
    KITTI_NUMBERS = 12,
    EUROC_NUMBERS = 17,
    EUROC_SPEEDS = 11 ///< of them up to the velocity
};

/// Matrices in files: the largest distance of an entry from the nearest rotation.
#define POSE_MATRIX_TOLERANCE 1e-3

typedef struct pose_translation
{
    const file_text *source;
    const bat_curve_read_options *options;
    text_buffer text;
    bat_curve_format reader; ///< of the translated text; BAT_CURVE_FORMAT_AUTO where the text is none of poses
    bat_curve_format format; ///< that the set is of
    bool as_it_is;           ///< the source needs no translation
    char notes[POSE_NOTES][POSE_NOTE_SIZE];
    size_t note_count;
    // Of tables:
    size_t columns[ROLES]; ///< BAT_NO_INDEX where there is none
    column_unit units[ROLES], angle_unit;
    char separator;
    size_t width; ///< columns of the header
    char order[4];
} pose_translation;

void pose_note(pose_translation *work, const char *format, ...) __attribute__((format(printf, 2, 3)));
/// Read a row of exactly `count` numbers. False where it is none.
bool pose_read_numbers(const file_text *source, const text_line *line, size_t count, double *numbers, char *separator);
/// Append a pose to a time that stands there, or as a row at a time.
void pose_write_tum(pose_translation *work, const double *place, const double *quaternion);
void pose_write_row(pose_translation *work, double time, const double *place, const double *quaternion);

/// What the names of a header tell.
typedef struct pose_header
{
    size_t others;              ///< columns without a role
    char other[POSE_NAME_SIZE]; ///< the first of them
    bool foreign;               ///< a name is not one that the CSV reader knows
    bool globe;                 ///< there are longitudes or latitudes
    bool euroc;                 ///< names of EuRoC
    bool px4;                   ///< names of a log of PX4, whose times are microseconds
    size_t twice;               ///< a second column of a role, or BAT_NO_INDEX
} pose_header;

/// Find the header of a table. A line that begins with '#' is one where it has separators and names of poses.
bool pose_find_header(pose_translation *work, text_line *head, pose_header *names, csv_field *time);
/// Whether a table needs translation: not one that the CSV reader knows, unless its times are none in seconds.
bool pose_wants_table(const pose_translation *work, const pose_header *names, csv_field time);
bat_status pose_translate_table(pose_translation *work, const text_line *head, pose_header *names, bat_error *error);
/// Translate a table of an inertial unit, where it has names, to times, rates in rad/s, and accelerations in m/s^2 if any.
bat_status pose_translate_rates(pose_translation *work, bat_error *error);
