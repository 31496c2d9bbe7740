#ifndef BASE_JSON_PARSE_H
#define BASE_JSON_PARSE_H

#include "batten/base.h"

#include <jansson.h>

/// Parse JSON that begins on a line of a file, with a point as the decimal separator whatever the program's locale.
/// @param flags of json_loadb(), like JSON_ALLOW_NUL; a name twice in one object is always an error
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status json_parse(const char *text, size_t size, size_t flags, size_t first_line, json_t **value, bat_error *error);

/// Make text fit for an error message: bytes that do not print are replaced.
void json_printable(char *text);

#endif
