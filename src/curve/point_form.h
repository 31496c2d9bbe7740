#pragma once

#include "batten/space.h"

/// @file
/// Forms of points in files: the names of columns for points and velocities, and their conversion to coordinates of a space.

/// Representations of a rotation.
typedef enum rotation_form
{
    ROTATION_NONE, ///< the point has no rotation
    ROTATION_QUATERNION,
    ROTATION_MATRIX,
    ROTATION_VECTOR
} rotation_form;

enum
{
    /// The most columns of a point, and of a velocity.
    MAX_FORM_COLUMNS = 12,
    MAX_VELOCITIES = 6
};

/// A form of the points of a space.
typedef struct point_form
{
    const char *space;
    const char *const *names;      ///< of the columns of a point, null-terminated
    const char *const *velocities; ///< of the columns of a velocity, null-terminated
    size_t count;                  ///< the number of `names`
    size_t velocity_count;         ///< the number of `velocities`
    rotation_form rotation;
    size_t rotation_at; ///< the number of columns, and of coordinates, before those of the rotation
    bool strict;        ///< the file may have no other columns, except for the time
} point_form;

/// The names of a file's columns; `names` is null without a header.
typedef struct column_names
{
    char *const *names;
    size_t count;
} column_names;

/// The decimals of seconds that a unit of time has: "ms" has 3. -1 for other texts.
int time_unit_decimals(const char *text, size_t size);

/// The column with a name, in upper or lower case, with or without quotes; or BAT_NO_INDEX.
size_t column_find(const column_names *columns, const char *name);
/// The column of the times, or BAT_NO_INDEX.
/// @param decimals null: of plain names alone. Else names may end in a unit, as "time_ns" or "t [ms]"; receives the decimals
///                 of seconds that the unit has, or -1 where the name has none
size_t column_find_time(const column_names *columns, int *decimals);

/// The form of a file for a space: the first one whose columns all exist. Without a header it is the first form with this
/// number of columns. Null for plain coordinates.
const point_form *point_form_find(const char *space, const column_names *columns);
/// The first form of a space with `count` coordinates, or null.
const point_form *point_form_first(const char *space, size_t count);

/// The form of a table of keyframes: rotations, poses or tensors of any form whose columns all exist, or null.
const point_form *point_form_of_motion(const column_names *columns);

/// The columns of a form's velocities. Of poses, one part may be there alone, that of the translation or of the rotation.
/// @param found receives a column for each number of a velocity, or BAT_NO_INDEX
/// @return the number of columns that are there
size_t point_form_find_velocities(const point_form *form, const column_names *columns, size_t found[MAX_VELOCITIES]);

/// Whether the names of columns are invalid for a space; `text` of `size` bytes receives why. `form`: of point_form_find().
bool point_form_fault(const char *space, const point_form *form, const column_names *columns, char *text, size_t size);

/// Convert the numbers of a row to a point. Rotations up to rounding are normalized: quaternions of unit length within 1e-3,
/// orthogonal matrices within 1e-6. With `project` the nearest rotation is used.
/// @return null, or an error text
const char *point_form_read(const point_form *form, const double *numbers, bool project, double *point);
/// Convert a point to the numbers of a row.
void point_form_write(const point_form *form, const double *point, double *numbers);

/// Convert a velocity in a file to a tangent vector at a point, or back. False where that is undefined.
bool point_form_tangent(const point_form *form, const bat_space *space, const double *point, const double *velocity,
                        double *tangent);
bool point_form_velocity(const point_form *form, const bat_space *space, const double *point, const double *tangent,
                         double *velocity);

/// The index of the quaternion in the points of a space, or BAT_NO_INDEX.
size_t quaternion_place(const bat_space *space);
/// Choose the sign of a quaternion that is nearer to `before`.
void quaternion_continue(const double *before, double *quaternion);

/// Quaternions whose scalar product is nearer to 0 are rotations about half a turn apart, within some 6 degrees.
#define QUATERNION_ABOUT_HALF 0.05

/// Describe the columns that a quaternion or a rotation matrix lacks, in up to `size` bytes, where no space is named and
/// some of its columns exist. False if nothing is missing. `form` is what the columns were taken for; null for plain
/// coordinates.
bool point_form_incomplete(const point_form *form, const column_names *columns, char *text, size_t size);
