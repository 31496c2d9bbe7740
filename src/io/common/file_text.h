#ifndef IO_COMMON_FILE_TEXT_H
#define IO_COMMON_FILE_TEXT_H

#include "batten/base.h"

/// The whole content of a file.
typedef struct file_text
{
    char *data; ///< `size` bytes and a final zero, without a byte order mark
    size_t size;
} file_text;

/// Read a file, which need not be seekable, into memory; "-" is standard input.
/// @return BAT_OK, BAT_FILE_ACCESS or BAT_NO_MEMORY
bat_status file_text_read(const char *path, file_text *text, bat_error *error);

/// A copy of bytes in memory, with the final zero and without the byte order mark.
bat_status file_text_copy(const char *bytes, size_t size, file_text *text, bat_error *error);

void file_text_free(file_text *text);

/// A line of a text.
typedef struct text_line
{
    const char *begin, *end; ///< without blanks at either end
    size_t number;           ///< counted from 1; 0 before the first
    const char *next;        ///< where the next line begins
} text_line;

/// Before the first line of a text.
text_line text_line_start(const file_text *text);
/// Go to the next line; false at the end of the text.
bool text_line_next(const file_text *text, text_line *line);

#endif
