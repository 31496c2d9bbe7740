#ifndef CURVE_CSV_COLUMNS_H
#define CURVE_CSV_COLUMNS_H

#include "curve/curve_attributes.h"
#include "curve/point_form.h"

enum
{
    /// Numbers in the velocities that files can hold.
    MAX_VELOCITIES = 6
};

/// A field of a row.
typedef struct csv_field
{
    const char *begin, *end; ///< without blanks at either end
} csv_field;

/// Take the names of a header row, which have no zero bytes. False when out of memory.
bool csv_columns_name(csv_columns *columns, const csv_field *fields, size_t count);

/// Find the columns that are called longitude and latitude, if both are there.
bool csv_columns_geographic(const csv_columns *columns, size_t *longitude, size_t *latitude);

/// Say that the coordinates are these two columns and the others are channels. False when out of memory.
bool csv_columns_use_degrees(csv_columns *columns, size_t longitude, size_t latitude);

/// Say that the coordinates are written in a form; the other columns are channels. False when out of memory.
bool csv_columns_use_form(csv_columns *columns, const point_form *form);

/// Which channels of a curve are its times and its velocities.
typedef struct motion_channels
{
    size_t time; ///< BAT_NO_INDEX without times
    size_t velocity[MAX_VELOCITIES];
    size_t velocity_count; ///< 0 without velocities
} motion_channels;

/// Find times and velocities among the columns after the `coordinates` that make a point. `form` may be null: there are no
/// velocities then.
void csv_columns_channels(const csv_columns *columns, size_t coordinates, const point_form *form, motion_channels *channels);

#endif
