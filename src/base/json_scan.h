#pragma once

#include "batten/base.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/// @file
/// Scanning and parsing of JSON text (RFC 8259).

/// A position in JSON text. The functions skip values without parsing them: they only examine brackets, quotes and commas,
/// except for json_scan_numbers(). A parser must check the syntax. Every function skips blanks first.
typedef struct json_scanner
{
    const char *at, *end; ///< the byte at `end` is readable
} json_scanner;

/// Skip blanks.
void json_scan_blanks(json_scanner *scan);
/// Whether the next byte is `byte`.
bool json_scan_at(json_scanner *scan, char byte);
/// Skip the next byte if it is `byte`.
bool json_scan_take(json_scanner *scan, char byte);

/// Skip a string. False when it has no end.
bool json_scan_string(json_scanner *scan);
/// Skip a key and its colon; `key` receives the text between the quotes. False when there is none.
bool json_scan_key(json_scanner *scan, json_scanner *key);
/// Whether the text from `at` to `end` equals `text`.
bool json_scan_is(const json_scanner *scan, const char *text);
/// Skip a value: up to its closing bracket, or up to the comma or bracket after a plain value.
bool json_scan_value(json_scanner *scan);

/// Advance to the next element of an array, behind its bracket and `index` elements. False behind the closing bracket.
bool json_scan_element(json_scanner *scan, size_t index);

/// Skip an array if it is valid JSON and holds only numbers and arrays, nested at most `depth` deep.
bool json_scan_numbers(json_scanner *scan, size_t depth);

/// The number of line breaks between two positions.
size_t json_scan_newlines(const char *begin, const char *end);

/// Parse JSON that begins on a line of a file, with a point as the decimal separator whatever the program's locale.
/// @param flags of json_loadb(), like JSON_ALLOW_NUL; a name twice in one object is always an error
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status json_parse(const char *text, size_t size, size_t flags, size_t first_line, json_t **value, bat_error *error);

/// Make text fit for an error message: bytes that do not print are replaced.
void json_printable(char *text);
