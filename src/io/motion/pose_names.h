#ifndef IO_MOTION_POSE_NAMES_H
#define IO_MOTION_POSE_NAMES_H

#include "io/curve/csv_split.h"

/// @file
/// The names of columns that ROS, EuRoC and flight logs use for poses, and the units in them.

enum
{
    POSE_NAME_SIZE = 64
};

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

/// The decimals that a unit of time has below seconds.
int pose_unit_decimals(column_unit unit);

/// The name of a column in lower case without quotes, unit and prefixes, with '_' for dots, slashes and blanks.
void pose_name_normalize(csv_field field, char name[POSE_NAME_SIZE], column_unit *found);

/// The role of a normalized name, or ROLES. `*canonical` tells whether the reader of CSV knows the name itself.
role pose_name_role(const char *name, bool *canonical);

#endif
