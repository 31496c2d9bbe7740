#ifndef IO_COMMON_JSON_H
#define IO_COMMON_JSON_H

#include "batten/base.h"
#include "base/text_buffer.h"

#include <jansson.h>

/// Find one's way in JSON text without parsing it. Only brackets, quotes and commas are looked at, save by
/// json_scan_numbers(); it is for a parser to decide whether the whole is JSON. Every function first goes behind blanks.
typedef struct json_scanner
{
    const char *at, *end; ///< the byte at `end` is readable
} json_scanner;

/// Go behind blanks.
void json_scan_blanks(json_scanner *scan);
/// Whether this byte is next.
bool json_scan_at(json_scanner *scan, char byte);
/// Go behind this byte if it is next.
bool json_scan_take(json_scanner *scan, char byte);

/// Go behind the string that begins here. False when it has no end.
bool json_scan_string(json_scanner *scan);
/// Go behind the key that begins here and its colon; `key` is what stands between the quotes. False when there is none.
bool json_scan_key(json_scanner *scan, json_scanner *key);
/// Whether what lies between `at` and `end` is this text.
bool json_scan_is(const json_scanner *scan, const char *text);
/// Go behind the value that begins here: to the end of its brackets, or to the comma or bracket that follows a plain value.
bool json_scan_value(json_scanner *scan);

/// Inside an array whose opening bracket was taken and of which `index` elements were passed: go to the next. False, and
/// behind the array's end, when there is none.
bool json_scan_element(json_scanner *scan, size_t index);

/// Go behind the array that begins here if it is right JSON and holds nothing but numbers and arrays, at most `depth` deep.
bool json_scan_numbers(json_scanner *scan, size_t depth);

/// The line breaks between two places.
size_t json_scan_newlines(const char *begin, const char *end);

/// Append a JSON value in compact form. Members keep their order, real numbers have as few digits as bring back the same
/// double, text is UTF-8. Unlike json_dumps() it may run on several threads for the same value.
void json_text(text_buffer *text, const json_t *value);

/// Append a JSON string with its quotes.
void json_text_string(text_buffer *text, const char *string, size_t length);

#endif
