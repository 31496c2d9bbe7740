#ifndef IO_COMMON_FILE_TEXT_H
#define IO_COMMON_FILE_TEXT_H

#include "batten/base.h"

/// @file
/// The text of a file and its lines.

typedef struct file_text
{
    char *data; ///< `size` bytes without a byte order mark, then a zero byte
    size_t size;
    const char *path; ///< the file, as the caller named it; null for bytes in memory
} file_text;

/// Read a file into memory; pipes are allowed, and "-" is standard input.
/// @return BAT_OK, BAT_FILE_ACCESS, BAT_BAD_FILE for a text in UTF-16, or BAT_NO_MEMORY
bat_status file_text_read(const char *path, file_text *text, bat_error *error);

/// Copy bytes in memory, without the byte order mark and with a final zero byte.
/// @return BAT_OK, BAT_BAD_FILE for a text in UTF-16, or BAT_NO_MEMORY
bat_status file_text_copy(const char *bytes, size_t size, file_text *text, bat_error *error);

void file_text_free(file_text *text);

typedef struct text_line
{
    const char *begin, *end; ///< without blanks at both ends
    size_t number;           ///< counted from 1; 0 before the first line
    const char *next;        ///< the start of the next line
} text_line;

/// The state before the first line.
text_line text_line_start(const file_text *text);
/// Advance to the next line; false at the end of the text.
bool text_line_next(const file_text *text, text_line *line);

#endif
