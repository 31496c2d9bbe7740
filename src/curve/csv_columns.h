#ifndef CURVE_CSV_COLUMNS_H
#define CURVE_CSV_COLUMNS_H

#include "curve/curve_attributes.h"
#include "curve/point_form.h"

/// @file
/// Columns of CSV files.

enum
{
    /// The most numbers of a velocity.
    MAX_VELOCITIES = 6
};

/// A field of a row.
typedef struct csv_field
{
    const char *begin, *end; ///< without blanks at both ends
} csv_field;

/// Store the names of a header row, which contain no zero bytes. False when out of memory.
bool csv_columns_name(csv_columns *columns, const csv_field *fields, size_t count);

/// Find the columns of longitude and latitude. False unless both exist.
bool csv_columns_geographic(const csv_columns *columns, size_t *longitude, size_t *latitude);

/// Use these two columns as coordinates, and all others as channels. False when out of memory.
bool csv_columns_use_degrees(csv_columns *columns, size_t longitude, size_t latitude);

/// Use the columns of a form as coordinates, and all others as channels. False when out of memory.
bool csv_columns_use_form(csv_columns *columns, const point_form *form);

/// The channels of a curve that hold times and velocities.
typedef struct motion_channels
{
    size_t time; ///< BAT_NO_INDEX without times
    size_t velocity[MAX_VELOCITIES];
    size_t velocity_count; ///< 0 without velocities
} motion_channels;

/// Find times and velocities among the columns after the first `coordinates`. `form` may be null; there are no velocities
/// then.
void csv_columns_channels(const csv_columns *columns, size_t coordinates, const point_form *form, motion_channels *channels);

#endif
