#ifndef IO_CURVE_ROWS_H
#define IO_CURVE_ROWS_H

#include "batten/curve_file.h"
#include "io/common/block_writer.h"

/// @file
/// Output of curve sets as rows of text.

/// The points of all curves of a set, partitioned into blocks of equal size.
typedef struct row_blocks
{
    const bat_curve_set *set;
    size_t *first_rows; ///< for each curve, then the number of all rows
    size_t block_count;
} row_blocks;

/// A part of a curve: its points begin, …, end - 1.
typedef struct row_span
{
    const bat_curve *curve;
    size_t curve_index;
    size_t begin, end;
} row_span;

/// Append the text of a span.
typedef bat_status row_format(const void *context, const row_span *span, text_buffer *text, bat_error *error);

bat_status row_blocks_begin(const bat_curve_set *set, row_blocks *blocks, bat_error *error);
bat_status row_blocks_write(const row_blocks *blocks, text_sink *sink, int threads, row_format *format, const void *context,
                            bat_error *error);
void row_blocks_end(row_blocks *blocks);

/// BAT_INVALID_POINT for the point `point` of a span, which is not finite.
bat_status row_not_finite(const row_span *span, size_t point, bat_error *error);

#endif
