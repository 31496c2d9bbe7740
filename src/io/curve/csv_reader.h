#ifndef IO_CURVE_CSV_READER_H
#define IO_CURVE_CSV_READER_H

#include "base/error.h"
#include "io/common/number_text.h"
#include "io/curve/builder.h"
#include "io/curve/csv_cells.h"
#include "io/curve/csv_split.h"
#include "io/curve/formats.h"

/// @file
/// The state of reading a CSV file, and the meaning of its columns.

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
    bool closed;         ///< from a directive for the current curve
    size_t header_line;  ///< 0 without a header
    size_t time_channel; ///< BAT_NO_INDEX without times
    size_t group;        ///< the column of the option, or BAT_NO_INDEX
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
    bool tum;         ///< the TUM format: blank lines, headers and directives have no meaning
} csv_reader;

/// The number of a column, from 1, in the file: the column of corners is not among the fields.
size_t csv_column_number(const csv_reader *reader, size_t column);

/// Find a column by its name or number.
bat_status csv_find_column(const csv_reader *reader, const char *option, const char *name, size_t length, size_t *column,
                           bat_error *error);

/// Name the columns of the TUM format as a CSV header would. False when out of memory.
bool csv_name_tum_columns(csv_reader *reader);

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

/// Notes about the columns, after the file.
bool csv_note_columns(csv_reader *reader);

#endif
