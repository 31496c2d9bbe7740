#pragma once

#include "curve/curve_attributes.h"
#include "io/curve/builder.h"
#include "io/curve/formats.h"

/// @file
/// CSV: columns, their names, rows of text, cells that are carried along, and the state of a reader.

// Columns of CSV files.

typedef enum csv_kind
{
    CSV_NUMBER, ///< a coordinate or a channel
    CSV_ID,     ///< running numbers, which are written anew
    CSV_GROUP,  ///< one text for each curve
    CSV_TEXT,   ///< texts; new points take that of the point before
    CSV_TIME,   ///< ISO 8601 times; new points get times between
    CSV_GAPS,   ///< numbers and empty cells; new points get numbers between where both sides have one
    CSV_EMPTY,  ///< nothing
    CSV_CLOCK   ///< times in numbers, a channel; given points keep their text, new ones of halved edges get times between
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

/// Channels at the end of a row that tell a point's place between the rows of the file, where there are cells: the row k
/// of an open curve and 0, or cos and sin of 2 pi k / n for a closed one of n rows.
#define CSV_PLACE_CHANNELS 2

/// The columns of a CSV file that had a header, or other columns than numbers.
typedef struct csv_columns
{
    char **names;   ///< one block: the pointers, then the text; null without a header
    size_t *places; ///< what each column of numbers holds: coordinate `place`, or channel `place - coordinates`; null: in
                    ///< their order
    unsigned char *kinds; ///< a csv_kind for each column; null: all are numbers
    size_t count;
    size_t other_count;     ///< columns that are neither coordinates nor channels
    csv_cells cells;        ///< all zero without such columns
    bool has_places;        ///< each point has CSV_PLACE_CHANNELS
    int64_t first_id;       ///< of CSV_ID
    bool ids_begin_anew;    ///< with each curve
    bool degrees;           ///< the coordinates are longitude and latitude
    bool radians;           ///< they are written in radians
    const point_form *form; ///< how points are written, where not by their coordinates as they are
    size_t time;            ///< the column of the times, or BAT_NO_INDEX
    size_t altitude;        ///< the channel that is the altitude, or BAT_NO_INDEX
    size_t corner;          ///< where the file has its column of corners, which is not in `names`; or BAT_NO_INDEX
    char *chosen;           ///< the columns of coordinates, by their numbers from 1, where they were chosen; else null
} csv_columns;

typedef struct csv_field
{
    const char *begin, *end; ///< without blanks at both ends
} csv_field;

/// Store the names of a header row, which contain no zero bytes. False when out of memory.
bool csv_columns_name(csv_columns *columns, const csv_field *fields, size_t count);

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

/// Choose the columns of coordinates by names, else by places among the columns of numbers, without regard to forms.
/// @param space  a name, or null for the space that the columns imply
/// @param motion a single column beside that of the times is a coordinate
void csv_columns_choose(const csv_columns *columns, const char *space, bool motion, csv_choice *choice);
/// Whether coordinates were chosen by their places beside `count` columns of which some hold other than numbers, or `others`
/// say so: a reader refuses that, but for two or more in a space that is named.
bool csv_is_guess(const csv_columns *columns, size_t count, const csv_choice *choice, bool others, bool named_space);

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

/// Use the columns of a form as coordinates, and all other numbers as channels. False when out of memory.
bool csv_columns_use_form(csv_columns *columns, const point_form *form);

/// Find times and velocities among the columns after the first `coordinates`. `form` may be null: no velocities then.
void csv_columns_channels(const csv_columns *columns, size_t coordinates, const point_form *form, motion_channels *channels);

// Names of CSV columns in the spellings that people use.

/// The unit that a name gives: "Longitude (deg)", "lon_rad", "easting [m]".
typedef enum name_unit
{
    NAME_UNIT_NONE,
    NAME_UNIT_DEGREES,
    NAME_UNIT_RADIANS,
    NAME_UNIT_LENGTH,
    NAME_UNIT_OTHER
} name_unit;

enum
{
    /// The most characters of a name that is recognized, and a zero.
    NAME_BASE_SIZE = 40,
    /// x, y, z, w
    MAX_NAMED_COORDINATES = 4
};

/// A name without quotes, unit, case, blanks and punctuation: "decimallongitude".
typedef struct name_parts
{
    char base[NAME_BASE_SIZE]; ///< empty for a longer one
    name_unit unit;
} name_parts;

name_parts name_parse(const char *name);

/// Whether a column of this name numbers rows: "id", "index", "fid", "no", "#", … or no name.
bool name_is_index(const char *name);
/// Whether whole numbers in a column of this name are codes, which have no values between them: "track_id", "osm_id", …
bool name_is_code(const char *name);
/// Whether numbers in a column of this name are angles, which go around: "heading", "course_deg", …
bool name_is_angle(const char *name);
/// Whether the values of a column of this name may tell curves apart: "track", "trip_id", "segment", …
bool name_is_group(const char *name);

/// The columns of coordinates that names tell.
typedef struct named_coordinates
{
    size_t columns[MAX_NAMED_COORDINATES]; ///< longitude and latitude; or x, y, and z and w where they exist
    size_t count;                          ///< 0: the names tell none
    size_t altitude;                       ///< beside longitude and latitude, or BAT_NO_INDEX
    bool geographic;
    bool radians; ///< of geographic columns; else degrees
    bool spelled; ///< the names are other than lon, lng, long, longitude, lat, latitude, x, y, z
} named_coordinates;

/// `planar`: longitude and latitude are none.
named_coordinates names_find_coordinates(const column_names *names, bool planar);

// Rows of CSV text: separators, quotes and numbers.

/// The separator that a row shows: comma, semicolon or tab outside quotes, or runs of blanks; a comma comes last.
char csv_find_separator(const text_line *line);

/// Split a row into up to BAT_SPACE_MAX_DIM fields without blanks around them. Quotes stay; separators between them do not
/// count. `text` is the whole file: with tabs, blanks at the ends of the line separate empty fields.
/// @return null, or an error text
const char *csv_split(const file_text *text, const text_line *line, char separator, csv_field *fields, size_t *count);

/// The text without blanks around it.
csv_field csv_trimmed(const char *begin, const char *end);
/// The field without quotes around it.
csv_field csv_unquoted(csv_field field);
/// The same of a whole text.
csv_field csv_text(const char *text);
/// Null for a field that can stand in a file that is written again, else an error text.
const char *csv_field_fault(csv_field field);

/// Read a number, with or without quotes. Where the separator is no comma, a comma may be the decimal point; `*comma` is
/// then set. Returns null or an error text.
const char *csv_read_number(csv_field field, char separator, double *value, bool *comma);

/// Whether a field holds nothing: it is empty, NA, N/A, NaN, null or none, in either case.
bool csv_is_missing(csv_field field);

enum
{
    EXACT_DIGITS = 15, ///< of any double
    INT64_DIGITS = 19
};
/// Whether a field is a whole number of at most so many digits, and within int64_t.
bool csv_read_whole(csv_field field, int max_digits, int64_t *value);

// Cells of CSV columns that are carried along: texts, times, and numbers with gaps.

/// Cells during reading, row after row.
typedef struct cell_builder
{
    text_buffer text;
    size_t *offsets, *first_rows;
    unsigned char *closed;
    size_t offset_count, offset_capacity, first_capacity, closed_capacity;
    size_t columns, row_count, curve_count;
} cell_builder;

/// Append the next of the `columns` cells of a row. A cell equal to the one above shares its text. False: out of memory.
bool cells_add(cell_builder *cells, csv_field cell);
void cells_drop_row(cell_builder *cells);
/// End a curve, whose rows begin where the last one ended. False when out of memory.
bool cells_end_curve(cell_builder *cells, bool closed);
/// Hand the cells over. The builder is empty afterwards.
void cells_finish(cell_builder *cells, csv_cells *result);
void cells_free(cell_builder *cells);

/// The place channels of row k among n.
void cells_place(size_t k, size_t n, bool closed, double place[CSV_PLACE_CHANNELS]);
/// The places of all points between the rows of the file, from the last channels of each point: k + t lies between row k and
/// the next, 0 <= t < 1. Between two neighbouring rows that are both among the points, places are evenly spaced.
void cells_places(const csv_cells *cells, const bat_curve *curve, size_t curve_index, double *places);

/// Append a cell at a place: its text, or a value between those of two rows.
void cells_write(const csv_cells *cells, csv_kind kind, size_t column, size_t curve_index, double place, text_buffer *text);
/// Append a text as a field between commas, in quotes where it needs them: blanks separate fields of one column alone.
void cells_write_text(const char *cell, bool alone, text_buffer *text);

enum
{
    /// timestamp tx ty tz qx qy qz qw
    TUM_COLUMNS = 8,
    /// Of a directive that names columns.
    MAX_COLUMN_LIST = 200
};

/// What is known of a column's kind. It survives when the file is read again, after a cell that does not fit the kind.
typedef struct column_state
{
    csv_kind kind;
    bool has_number; ///< a cell was a number
    bool is_coordinate;
    bool is_watched;         ///< a column of numbers that may tell curves apart
    size_t gaps, first_gap;  ///< missing cells, and the line of the first
    size_t changes;          ///< cells that differ from the one above
    const char *begin, *end; ///< the cell above
    bool not_whole;          ///< a cell was no whole number
} column_state;

typedef struct csv_reader
{
    const file_text *text;
    const bat_curve_read_options *options;
    bat_curve_attributes *attributes;
    curve_builder builder;
    cell_builder cells;
    csv_field fields[BAT_SPACE_MAX_DIM];
    double numbers[BAT_SPACE_MAX_DIM]; ///< of a row, coordinates first
    column_state columns[BAT_SPACE_MAX_DIM];
    size_t column_count; ///< 0 before the first row
    size_t coordinate_count, number_count;
    char separator;                    ///< a comma, semicolon or tab, or a blank for runs of blanks
    char space_name[EXCERPT_SIZE];     ///< from a directive; empty without one
    char column_list[MAX_COLUMN_LIST]; ///< from a directive; empty without one
    csv_choice choice;
    bool closed;                  ///< from a directive for the current curve
    size_t header_line;           ///< 0 without a header
    size_t time_channel;          ///< BAT_NO_INDEX without times
    int time_decimals;            ///< of the unit in the name of the times; -1 without
    bool time_by_size;            ///< the unit of the times is told by their size
    bool left[BAT_SPACE_MAX_DIM]; ///< columns of the file that are no part of a motion, and in no other table here
    size_t left_count, left_rows, first_left_row; ///< rows that repeat a time, and the line of the first
    size_t short_count, first_short;              ///< curves with too few points, and the last line of the first
    bool drop_short;                              ///< they are dropped, as there are other curves
    char left_name[EXCERPT_SIZE];                 ///< of the first of them
    size_t group;                                 ///< the column of the option, or BAT_NO_INDEX
    size_t row_count;
    int64_t next_id;
    bool motion;      ///< has times or velocities: repeated points stay
    bool begun;       ///< a row of numbers was read
    bool strict;      ///< all columns are numbers
    bool kinds_known; ///< from the first row, also when the file is read again
    bool chosen;      ///< the coordinates were chosen by the caller
    bool comma;       ///< a number has a decimal comma
    bool again;       ///< a kind has changed: the file is read again from its beginning
    bool unnamed_tum; ///< a CSV file contains rows of a trajectory without a header
    bool tum;         ///< the TUM format, and rows of EuRoC in its order with velocities: blank lines, headers and
                      ///< directives have no meaning
} csv_reader;

/// The number of a column, from 1, in the file: the column of corners is not among the fields.
size_t csv_column_number(const csv_reader *reader, size_t column);

/// Find a column by its name, or by its number from 1.
/// @param numbered the name is a number, whatever the header says
bat_status csv_find_column(const csv_reader *reader, const char *option, const char *name, size_t length, bool numbered,
                           size_t *column, bat_error *error);

/// Name the columns of the TUM format as a CSV header would. False when out of memory.
bool csv_name_tum_columns(csv_reader *reader);

/// Leave out the columns that are no part of a motion, by the names and the first row. False when out of memory.
bool csv_leave_columns(csv_reader *reader);
/// Take the cells of columns that are left out from a row.
void csv_drop_left(csv_reader *reader);

/// Choose the kinds of the columns by the first row, the space and the columns of coordinates.
bat_status csv_choose(csv_reader *reader, const text_line *line, bat_error *error);

/// Take the cells of a row that are no numbers, and change kinds that a cell does not fit.
bat_status csv_take_cells(csv_reader *reader, const text_line *line, bat_error *error);
/// Whether a column's cell that is no number changes its kind: then the file is read again.
bool csv_change_kind(csv_reader *reader, size_t column);

/// Whether a column has dates that are taken as times.
bool csv_takes_dates(const csv_reader *reader, size_t column);

/// Count what the notes tell about a cell.
void csv_watch_cell(csv_reader *reader, const text_line *line, size_t column);

bool csv_note_columns(csv_reader *reader);
