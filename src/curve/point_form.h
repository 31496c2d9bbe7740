#ifndef CURVE_POINT_FORM_H
#define CURVE_POINT_FORM_H

#include "batten/space.h"

/// @file
/// How files write the points of a space in columns, and velocities beside them: what the columns are called, and how their
/// numbers become the coordinates of the space.

/// The ways to write a rotation.
typedef enum rotation_form
{
    ROTATION_NONE, ///< the point has none
    ROTATION_QUATERNION,
    ROTATION_MATRIX,
    ROTATION_VECTOR
} rotation_form;

enum
{
    /// Columns of a point in any form.
    MAX_FORM_COLUMNS = 12
};

/// One way to write the points of a space.
typedef struct point_form
{
    const char *space;
    const char *const *names;      ///< of the columns that make a point, null-terminated
    const char *const *velocities; ///< of those that make a velocity, null-terminated
    size_t count;                  ///< of `names`
    size_t velocity_count;         ///< of `velocities`
    rotation_form rotation;
    size_t rotation_at; ///< how many columns, and coordinates, stand before those of the rotation
    bool strict;        ///< other columns than these and the time are not allowed beside them
} point_form;

/// The names of the columns of a file; null `names` without a header.
typedef struct column_names
{
    char *const *names;
    size_t count;
} column_names;

/// The column with a name, in either case, with or without quotes around it; BAT_NO_INDEX when there is none.
size_t column_find(const column_names *columns, const char *name);
/// The column of the times.
size_t column_find_time(const column_names *columns);

/// The form that a file with these columns uses for a space: the first whose columns are all there. Without a header the
/// space's first form of as many columns. Null when the columns are the coordinates as they are.
const point_form *point_form_find(const char *space, const column_names *columns);
/// The first form of a space with `count` coordinates; null where there is none.
const point_form *point_form_first(const char *space, size_t count);

/// Why columns with names cannot be those of a space, in up to `size` bytes; false when they can. `form` is what
/// point_form_find() said.
bool point_form_fault(const char *space, const point_form *form, const column_names *columns, char *text, size_t size);

/// The point that the numbers of a row make. What is a rotation up to rounding (quaternions of unit length to 1e-3, matrices
/// orthogonal to 1e-6) becomes one; with `project`, whatever has a nearest rotation.
/// @return null when that is one, else a few words that say why not
const char *point_form_read(const point_form *form, const double *numbers, bool project, double *point);
/// The numbers of a point.
void point_form_write(const point_form *form, const double *point, double *numbers);

/// The tangent vector at a point that a file's velocity means, and the reverse. False where there is none.
bool point_form_tangent(const point_form *form, const bat_space *space, const double *point, const double *velocity,
                        double *tangent);
bool point_form_velocity(const point_form *form, const bat_space *space, const double *point, const double *tangent,
                         double *velocity);

/// Where the quaternion begins in the points of a space; BAT_NO_INDEX where there is none.
size_t quaternion_place(const bat_space *space);
/// Give a quaternion the sign that is nearer to the one before it.
void quaternion_continue(const double *before, double *quaternion);

#endif
