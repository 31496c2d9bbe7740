#ifndef IO_SURFACE_SURFACE_ROWS_H
#define IO_SURFACE_SURFACE_ROWS_H

#include "io/common/block_writer.h"

/// @file
/// Texts of many rows of numbers, formatted on all threads.

/// Append the text of a row, with its end.
typedef void row_text(const void *context, size_t row, text_buffer *text);

bat_status rows_write(text_sink *sink, size_t count, row_text *append, const void *context, bat_error *error);

/// Append numbers with blanks between them and the end of the line.
void rows_append_numbers(text_buffer *text, const double *numbers, size_t count);

/// Write the text of a format of printf() that holds no floating-point numbers, which would be written as the locale has
/// them.
bat_status rows_heading(text_sink *sink, bat_error *error, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
