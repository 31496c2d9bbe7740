#pragma once

#include "base/text_buffer.h"

/// @file
/// Numbers as decimal text, with a decimal point in every locale.

/// The most characters of a number, without a terminating zero.
#define NUMBER_TEXT_SIZE 32

/// Write a number with the fewest of 15, 16 or 17 significant digits that identify the double; "nan" or "inf" where it is
/// not finite. Returns the end.
char *number_write(char *out, double value);

/// Write `units` * 10^-decimals without trailing zeros, for |units| < 10^18 and 0 <= decimals <= 18. Returns the end.
char *number_write_fixed(char *out, int64_t units, int decimals);

/// Append a text, then a finite number.
void text_append_real(text_buffer *text, const char *before, double value);
/// Append a text, then `units` * 10^-decimals.
void text_append_fixed(text_buffer *text, const char *before, int64_t units, int decimals);
/// Append a finite number, then the character `after`.
void text_append_number(text_buffer *text, double value, char after);
/// Append a line: a text, then finite numbers with blanks between them.
void text_append_numbers(text_buffer *text, const char *before, const double *numbers, size_t count);
/// Append a whole number, then `after`.
void text_append_count(text_buffer *text, size_t count, const char *after);
/// Append a text of at most 511 characters, without floating-point numbers: printf() depends on the locale.
void text_append_format(text_buffer *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

/// 10^decimals for 0 <= decimals <= 18.
int64_t number_power_of_ten(int decimals);

/// Read the decimal number from `begin` to `end`, rounded to the nearest double. Returns null, or a few words that state the
/// error. Hexadecimal numbers, "nan" and "inf" are errors.
const char *number_read(const char *begin, const char *end, double *value);

/// Read the decimal number at `begin`. Returns its end, or null when there is none or it is too large.
const char *number_scan(const char *begin, const char *end, double *value);

/// Whether strtod() would read something at `begin`. This tells a header from an invalid number.
bool number_resembles(const char *begin, const char *end);

/// The text from `begin` to `end` for an error message: truncated, with unprintable bytes replaced. Returns `excerpt`.
#define EXCERPT_SIZE 32
const char *text_excerpt(char excerpt[EXCERPT_SIZE], const char *begin, const char *end);

static inline bool text_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}
