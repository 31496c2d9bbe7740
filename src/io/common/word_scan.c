#include "io/common/word_scan.h"

/// @file
/// Error messages for words of a text file.

bat_status scan_word_fault(word_scan *scan, size_t index, const char *fault, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    scan_skip_blanks(scan);
    return error_set(error, BAT_BAD_FILE, index, scan->line, "'%s' %s", text_excerpt(excerpt, scan->at, scan_word_end(scan)),
                     fault);
}

bat_status scan_number_fault(word_scan *scan, size_t index, const char *what, bat_error *error)
{
    double value;
    if (scan_line_done(scan))
        return error_set(error, BAT_BAD_FILE, index, scan->line, "%s", what);
    const char *fault = number_read(scan->at, scan_word_end(scan), &value);
    return fault != NULL ? scan_word_fault(scan, index, fault, error)
                         : error_set(error, BAT_BAD_FILE, index, scan->line, "%s", what);
}
