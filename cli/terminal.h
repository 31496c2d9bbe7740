#ifndef CLI_TERMINAL_H
#define CLI_TERMINAL_H

#include <stdarg.h>
#include <stdio.h>

/// @file
/// Text for people. Names of files and what files contain may hold control characters, which a terminal would obey.

/// Replace each control character by '?', in place: of ASCII, also line breaks, and of the C1 set. So are bytes that are no
/// UTF-8.
void terminal_clean(char *text);

/// As fprintf(), with control characters replaced but for a line break that ends the format.
void terminal_print(FILE *stream, const char *format, ...) __attribute__((format(printf, 2, 3)));
void terminal_print_list(FILE *stream, const char *format, va_list list) __attribute__((format(printf, 2, 0)));

#endif
