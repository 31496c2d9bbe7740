#pragma once

#include "base/error.h"
#include "io/common/number_text.h"

/// @file
/// The text of a file and its lines.

typedef struct file_text
{
    char *data; ///< `size` bytes without a byte order mark, then a zero byte
    size_t size;
    size_t points;    ///< bat_limits::points
    const char *path; ///< the file, as the caller named it; null for bytes in memory
} file_text;

/// Read a file into memory; pipes are allowed, and "-" is standard input.
/// @param limits null for the defaults
/// @return BAT_OK, BAT_FILE_ACCESS, BAT_BAD_FILE for a text in UTF-16, BAT_TOO_LARGE or BAT_NO_MEMORY
bat_status file_text_read(const char *path, const bat_limits *limits, file_text *text, bat_error *error);

/// Copy bytes in memory, without the byte order mark and with a final zero byte.
/// @return as file_text_read()
bat_status file_text_copy(const char *bytes, size_t size, const bat_limits *limits, file_text *text, bat_error *error);

/// Check the length of an input.
/// @return BAT_OK or BAT_TOO_LARGE
bat_status file_text_bytes(const bat_limits *limits, uintmax_t bytes, bat_error *error);

/// Check the number of points that compression and instances make of a text, and files beside it, of `bytes` bytes in all.
/// @return BAT_OK or BAT_TOO_LARGE
bat_status file_text_points(const file_text *text, size_t bytes, size_t points, bat_error *error);

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

// Scanning of text files made of words and numbers.

/// A position in a text of lines of words. '#' begins a comment up to the end of its line. Blanks separate words.
typedef struct word_scan
{
    const char *at, *end;
    size_t line; ///< the line of `at`, counted from 1
} word_scan;

static inline word_scan word_scan_start(const char *text, size_t size)
{
    return (word_scan){text, text + size, 1};
}

static inline void scan_skip_blanks(word_scan *scan)
{
    while (scan->at < scan->end && (*scan->at == ' ' || *scan->at == '\t' || *scan->at == '\r'))
        scan->at++;
}

static inline bool scan_word_ends(const word_scan *scan, const char *at)
{
    return at == scan->end || text_is_blank(*at) || *at == '#';
}

/// Whether only blanks and a comment remain on the line. Advances to the next word otherwise.
static inline bool scan_line_done(word_scan *scan)
{
    scan_skip_blanks(scan);
    return scan->at == scan->end || *scan->at == '\n' || *scan->at == '#';
}

/// Advance to the start of the next line; false at the end of the text.
static inline bool scan_next_line(word_scan *scan)
{
    const char *newline = scan->at < scan->end ? memchr(scan->at, '\n', (size_t)(scan->end - scan->at)) : NULL;
    scan->at = newline != NULL ? newline + 1 : scan->end;
    scan->line += newline != NULL;
    return scan->at < scan->end;
}

/// Advance to the next word, also on later lines; false at the end of the text.
static inline bool scan_next_content(word_scan *scan)
{
    while (scan_line_done(scan))
        if (!scan_next_line(scan))
            return false;
    return true;
}

/// Read the next word of the line as a number. False, without moving, when it is not a number.
static inline bool scan_number(word_scan *scan, double *value)
{
    scan_skip_blanks(scan);
    const char *end = number_scan(scan->at, scan->end, value);
    if (end == NULL || !scan_word_ends(scan, end))
        return false;
    scan->at = end;
    return true;
}

/// Read the next word of the line where it is a number that is not finite, such as nan or -inf; the value is NaN. False,
/// without moving, when it is not.
bool scan_not_finite(word_scan *scan, double *value);

/// Read decimal digits as a number below `limit` <= 2^60. False, without moving, when there is none.
static inline bool scan_digits_below(word_scan *scan, uint64_t limit, uint64_t *value)
{
    uint64_t number = 0;
    const char *at = scan->at;
    for (; at < scan->end && *at >= '0' && *at <= '9' && number < limit; at++)
        number = 10 * number + (unsigned)(*at - '0');
    if (at == scan->at || number >= limit)
        return false;
    scan->at = at;
    *value = number;
    return true;
}

/// Read the next word of the line as an integer, 0 <= value < `limit` <= 2^60. False, without moving, when it is not one.
static inline bool scan_count(word_scan *scan, uint64_t limit, uint64_t *value)
{
    scan_skip_blanks(scan);
    const char *begin = scan->at;
    if (scan_digits_below(scan, limit, value) && scan_word_ends(scan, scan->at))
        return true;
    scan->at = begin;
    return false;
}

static inline const char *scan_word_end(const word_scan *scan)
{
    const char *at = scan->at;
    while (!scan_word_ends(scan, at))
        at++;
    return at;
}

static inline bool scan_word(word_scan *scan, const char *word)
{
    scan_skip_blanks(scan);
    size_t size = (size_t)(scan_word_end(scan) - scan->at);
    if (size != strlen(word) || memcmp(scan->at, word, size) != 0)
        return false;
    scan->at += size;
    return true;
}

/// The line of a statement, by its number from 0 on among those whose first word `takes` takes, as scan_word() does.
size_t scan_line_of(const file_text *text, bool (*takes)(word_scan *scan, const char *word), const char *word,
                    size_t number);

/// BAT_BAD_FILE for the next word of the line, which should be a number. The message names its error, or `what` is missing.
bat_status scan_number_fault(word_scan *scan, size_t index, const char *what, bat_error *error);

/// BAT_BAD_FILE for the next word of the line. `fault` follows the word, as in "is not the index of a vertex".
bat_status scan_word_fault(word_scan *scan, size_t index, const char *fault, bat_error *error);
