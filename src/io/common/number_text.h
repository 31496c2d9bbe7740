#ifndef IO_COMMON_NUMBER_TEXT_H
#define IO_COMMON_NUMBER_TEXT_H

#include "batten/base.h"

/// Numbers as decimal text, with a point as the decimal separator whatever the locale.

/// Room that any number needs; no final zero is written.
enum
{
    NUMBER_TEXT_SIZE = 32
};

/// Write a finite number with as few of 15, 16 or 17 significant digits as give the same double back; returns the end.
char *number_write(char *out, double value);

/// Write the number `units` * 10^-decimals without trailing zeros, |units| < 10^18 and 0 <= decimals <= 18; returns the end.
char *number_write_fixed(char *out, int64_t units, int decimals);

/// 10^decimals, 0 <= decimals <= 18.
int64_t number_power_of_ten(int decimals);

/// Read the decimal number that fills the text from `begin` to `end`, rounded to the nearest double. Null when it is one,
/// else a few words that say why not. Hexadecimal, "nan" and "inf" are not numbers.
const char *number_read(const char *begin, const char *end, double *value);

/// Read the decimal number that the text from `begin` to `end` begins with; returns where it ends, or null when the text
/// begins with none, or with one too large.
const char *number_scan(const char *begin, const char *end, double *value);

/// True when the text begins as something strtod() reads, right or wrong: what decides between a header and a bad number.
bool number_resembles(const char *begin, const char *end);

/// The text from `begin` to `end` for an error message: cut to fit, bytes that do not print replaced. Returns `excerpt`.
enum
{
    EXCERPT_SIZE = 32
};
const char *text_excerpt(char excerpt[EXCERPT_SIZE], const char *begin, const char *end);

#endif
