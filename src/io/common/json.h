#pragma once

#include "base/json_scan.h"
#include "base/text_buffer.h"

/// @file
/// Writing of JSON text; base/json_scan.h scans it.

/// Append a JSON value in compact form. Members keep their order, real numbers have the fewest digits that identify the
/// double, and text is UTF-8. Unlike json_dumps(), several threads may write the same value.
void json_text(text_buffer *text, const json_t *value);
/// json_text() as a string, which free() releases. Null when out of memory.
char *json_text_make(const json_t *value);

/// Append a JSON string with its quotes.
void json_text_string(text_buffer *text, const char *string, size_t length);
