#ifndef IO_COMMON_JSON_TEXT_H
#define IO_COMMON_JSON_TEXT_H

#include "base/text_buffer.h"

#include <jansson.h>

/// Append a JSON value in compact form. Members keep their order, real numbers have as few digits as bring back the same
/// double, text is UTF-8. Unlike json_dumps() it may run on several threads for the same value.
void json_text(text_buffer *text, const json_t *value);

/// Append a JSON string with its quotes.
void json_text_string(text_buffer *text, const char *string, size_t length);

#endif
