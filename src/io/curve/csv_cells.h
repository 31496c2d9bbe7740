#ifndef IO_CURVE_CSV_CELLS_H
#define IO_CURVE_CSV_CELLS_H

#include "base/text_buffer.h"
#include "io/curve/csv_columns.h"

/// @file
/// Cells of CSV columns that are carried along: texts, times, and numbers with gaps.

/// Cells during reading, row after row.
typedef struct cell_builder
{
    text_buffer text;
    size_t *offsets, *first_rows;
    unsigned char *closed;
    size_t offset_count, offset_capacity, first_capacity, closed_capacity;
    size_t columns, row_count, curve_count;
} cell_builder;

/// Append the next cell of a row; a row has `columns` of them. A cell equal to the one above shares its text. False when out
/// of memory.
bool cells_add(cell_builder *cells, csv_field cell);
/// End a row.
void cells_end_row(cell_builder *cells);
/// Drop the last row.
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
/// Append a text as a field between commas, in quotes where it needs them.
void cells_write_text(const char *cell, text_buffer *text);

#endif
