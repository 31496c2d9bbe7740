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

/// Which columns of a file hold coordinates.
typedef struct csv_choice
{
    const char *space;                 ///< never null
    size_t columns[BAT_SPACE_MAX_DIM]; ///< for each coordinate; longitude before latitude
    size_t count;
    size_t altitude; ///< beside longitude and latitude, or BAT_NO_INDEX
    bool degrees;    ///< they are longitude and latitude, in degrees or radians
    bool radians;
    bool spelled;  ///< by names other than the short ones
    bool by_place; ///< not by names: all columns of numbers, or the first two
    size_t times;  ///< a column of times that would have been a coordinate by its place, or BAT_NO_INDEX
} csv_choice;

/// Choose the columns of coordinates by their names, else by their places among the columns of numbers. Forms of rotations,
/// poses and tensors are not considered.
/// @param space a name, or null for the space that the columns imply
void csv_columns_choose(const csv_columns *columns, const char *space, csv_choice *choice);

/// Set the place of each column: `chosen` are the coordinates, other numbers are channels. False when out of memory.
bool csv_columns_place(csv_columns *columns, const size_t *chosen, size_t count);

/// Whether the columns describe points of `coordinates` numbers with `channels` channels.
bool csv_columns_fit(const csv_columns *columns, size_t coordinates, size_t channels);

void csv_columns_free(csv_columns *columns);

/// Use these two columns as coordinates, and all others as channels. False when out of memory.
bool csv_columns_use_degrees(csv_columns *columns, size_t longitude, size_t latitude);

/// Use the columns of a form as coordinates, and all other numbers as channels. False when out of memory.
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
