#ifndef IO_CURVE_ROWS_H
#define IO_CURVE_ROWS_H

#include "batten/curve_file.h"
#include "io/common/block_writer.h"

/// @file
/// Output of curve sets as rows of text.

/// A part of a curve: its points begin, …, end - 1.
typedef struct row_span
{
    const bat_curve *curve;
    size_t curve_index;
    size_t first_row; ///< of the curve, counted over the set
    size_t begin, end;
} row_span;

/// Append the text of a span.
typedef bat_status row_format(const void *context, const row_span *span, text_buffer *text, bat_error *error);

/// Write all points of a set, in blocks of equal size that several threads format.
bat_status rows_write(const bat_curve_set *set, text_sink *sink, int threads, row_format *format, const void *context,
                      bat_error *error);

/// BAT_INVALID_POINT for the point `point` of a span, which is not finite.
bat_status row_not_finite(const row_span *span, size_t point, bat_error *error);

#endif
