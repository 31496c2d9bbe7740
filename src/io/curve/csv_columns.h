#ifndef IO_CURVE_CSV_COLUMNS_H
#define IO_CURVE_CSV_COLUMNS_H

#include "curve/curve_attributes.h"
#include "curve/point_form.h"

/// @file
/// Columns of CSV files.

/// What a CSV column holds.
typedef enum csv_kind
{
    CSV_NUMBER, ///< a coordinate or a channel
    CSV_ID,     ///< running numbers, which are written anew
    CSV_GROUP,  ///< one text for each curve
    CSV_TEXT,   ///< texts; new points take that of the point before
    CSV_TIME,   ///< ISO 8601 times; new points get times between
    CSV_GAPS,   ///< numbers and empty cells; new points get numbers between where both sides have one
    CSV_EMPTY   ///< nothing
} csv_kind;

/// The cells of the columns that are neither coordinates nor channels nor running numbers.
typedef struct csv_cells
{
    size_t columns; ///< with cells, in the order of the file
    size_t curves;
    size_t *first_rows;    ///< the row that each curve begins with, then the number of all rows
    unsigned char *closed; ///< whether each curve was closed
    size_t *offsets;       ///< rows x columns, into `text`
    char *text;            ///< cells with a zero after each
} csv_cells;

enum
{
    /// Channels at the end of a row that tell a point's place between the rows of the file, where there are cells: the row k
    /// of an open curve and 0, or cos and sin of 2 pi k / n for a closed one of n rows.
    CSV_PLACE_CHANNELS = 2
};

/// The columns of a CSV file that had a header, or other columns than numbers.
typedef struct csv_columns
{
    char **names;   ///< one block: the pointers, then the text; null without a header
    size_t *places; ///< what each column of numbers holds: coordinate `place`, or channel `place - coordinates`; null: in
                    ///< their order
    unsigned char *kinds; ///< a csv_kind for each column; null: all are numbers
    size_t count;
    size_t other_count;     ///< columns that are no numbers
    csv_cells cells;        ///< all zero without such columns
    bool has_places;        ///< each point has CSV_PLACE_CHANNELS
    int64_t first_id;       ///< of CSV_ID
    bool ids_begin_anew;    ///< with each curve
    bool degrees;           ///< the coordinates are longitude and latitude
    bool radians;           ///< they are written in radians
    const point_form *form; ///< how points are written, where not by their coordinates as they are
    size_t altitude;        ///< the channel that is the altitude, or BAT_NO_INDEX
    size_t corner;          ///< where the file has its column of corners, which is not in `names`; or BAT_NO_INDEX
    char *chosen;           ///< the columns of coordinates, by their numbers from 1, where they were chosen; else null
} csv_columns;

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

/// Attributes with columns, which are empty. Null when out of memory.
bat_curve_attributes *csv_attributes_new(bat_curve_format format);
/// Tell the attributes of curves in a space what their columns mean.
void csv_attributes_describe(bat_curve_attributes *attributes, const bat_space *space);
/// The columns of a result in time, whose attributes have none: times, points, velocities. False when out of memory.
/// @param columns need csv_columns_free(), also after a failure
bool csv_columns_of_motion(const bat_curve_attributes *attributes, csv_columns *columns);

/// Use these two columns as coordinates, and all others as channels. False when out of memory.
bool csv_columns_use_degrees(csv_columns *columns, size_t longitude, size_t latitude);

/// Use the columns of a form as coordinates, and all other numbers as channels. False when out of memory.
bool csv_columns_use_form(csv_columns *columns, const point_form *form);

/// Find times and velocities among the columns after the first `coordinates`. `form` may be null; there are no velocities
/// then.
void csv_columns_channels(const csv_columns *columns, size_t coordinates, const point_form *form, motion_channels *channels);

#endif
