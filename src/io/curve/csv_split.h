#ifndef IO_CURVE_CSV_SPLIT_H
#define IO_CURVE_CSV_SPLIT_H

#include "io/common/file_text.h"
#include "io/curve/csv_columns.h"

/// @file
/// Rows of CSV text: separators, quotes and numbers.

/// The separator that a row shows: a comma, semicolon or tab outside quotes, or a blank for runs of blanks. Semicolons and
/// tabs come before commas that can be decimal ones.
char csv_find_separator(const text_line *line);

/// Split a row into up to BAT_SPACE_MAX_DIM fields without blanks around them. Quotes stay; separators between them do not
/// count. `text` is the whole file: with tabs, blanks at the ends of the line separate empty fields.
/// @return null, or an error text
const char *csv_split(const file_text *text, const text_line *line, char separator, csv_field *fields, size_t *count);

/// The text without blanks around it.
csv_field csv_trimmed(const char *begin, const char *end);
/// The field without quotes around it.
csv_field csv_unquoted(csv_field field);

/// Read a number, with or without quotes. Where the separator is no comma, a comma may be the decimal point; `*comma` is
/// then set. Returns null or an error text.
const char *csv_read_number(csv_field field, char separator, double *value, bool *comma);

/// Whether a field holds nothing: it is empty, NA, N/A, NaN, null or none, in either case.
bool csv_is_missing(csv_field field);

/// Whether a field is a whole number of at most 15 digits.
bool csv_read_whole(csv_field field, int64_t *value);

#endif
