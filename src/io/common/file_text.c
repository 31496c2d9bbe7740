#include "io/common/file_text.h"

#include "base/file_bytes.h"

#include <math.h>
#include <strings.h>
#include <sys/stat.h>

/// @file
/// Input files as text in memory, and their lines.

static const char BYTE_ORDER_MARK[] = "\xEF\xBB\xBF";

bat_status file_text_bytes(const bat_limits *limits, uintmax_t bytes, bat_error *error)
{
    if (limits == NULL || limits->bytes == 0 || bytes <= limits->bytes)
        return BAT_OK;
    (void)ERROR_TOO_LARGE(error, "the input has more than %zu bytes", limits->bytes);
    return error_remedy(error, BAT_TOO_LARGE, "limits.bytes", "allows more");
}

static bat_status text_finish(text_buffer *buffer, const bat_limits *limits, file_text *text, bat_error *error)
{
    size_t mark = sizeof BYTE_ORDER_MARK - 1;
    text_append(buffer, "", 1);
    if (buffer->failed)
    {
        size_t size = buffer->size;
        text_free(buffer);
        return error_memory(error, size);
    }
    *text = (file_text){.data = buffer->data, .size = buffer->size - 1};
    text->points = limits != NULL ? limits->points : 0;
    size_t skipped = 0;
    while (text->size - skipped >= mark && memcmp(text->data + skipped, BYTE_ORDER_MARK, mark) == 0)
        skipped += mark;
    text->size -= skipped;
    if (skipped > 0)
        memmove(text->data, text->data + skipped, text->size + 1);
    // The byte order mark of UTF-16 and a character of ASCII.
    const unsigned char *byte = (const unsigned char *)text->data;
    if (text->size < 4 || !((byte[0] == 0xFF && byte[1] == 0xFE && byte[2] < 0x80 && byte[3] == 0) ||
                            (byte[0] == 0xFE && byte[1] == 0xFF && byte[2] == 0 && byte[3] < 0x80)))
        return BAT_OK;
    file_text_free(text);
    return ERROR_FILE(error, 1, "the text is UTF-16; save it as UTF-8");
}

bat_status file_text_read(const char *path, const bat_limits *limits, file_text *text, bat_error *error)
{
    text_buffer buffer = {0};
    struct stat about;
    bool regular = stat(path, &about) == 0 && S_ISREG(about.st_mode);
    bat_status status = file_text_bytes(limits, regular ? (uintmax_t)about.st_size : 0, error);
    if (status == BAT_OK)
        status = file_bytes_read(path, limits != NULL && limits->bytes > 0 ? limits->bytes : FILE_MAX_BYTES, &buffer, error);
    if (status == BAT_OK)
        status = text_finish(&buffer, limits, text, error);
    if (status == BAT_OK)
        text->path = path;
    return status;
}

bat_status file_text_copy(const char *bytes, size_t size, const bat_limits *limits, file_text *text, bat_error *error)
{
    text_buffer buffer = {0};
    bat_status status = file_text_bytes(limits, size, error);
    if (status != BAT_OK)
        return status;
    text_append(&buffer, bytes, size);
    return text_finish(&buffer, limits, text, error);
}

bat_status file_text_points(const file_text *text, size_t bytes, size_t points, bat_error *error)
{
    static const size_t ALWAYS = 1 << 20;
    size_t most = text->points > 0 ? text->points : ALWAYS + bytes;
    if (points <= most)
        return BAT_OK;
    (void)ERROR_TOO_LARGE(error, "the file stands for more than %zu points", most);
    return error_remedy(error, BAT_TOO_LARGE, "limits.points", "allows more");
}

void file_text_free(file_text *text)
{
    free(text->data);
    *text = (file_text){0};
}

text_line text_line_start(const file_text *text)
{
    return (text_line){.next = text->data};
}

bool text_line_next(const file_text *text, text_line *line)
{
    const char *text_end = text->data + text->size;
    if (line->next >= text_end)
        return false;
    line->begin = line->next;
    const char *newline = memchr(line->begin, '\n', (size_t)(text_end - line->begin));
    line->end = newline != NULL ? newline : text_end;
    line->next = newline != NULL ? newline + 1 : text_end;
    line->number++;
    while (line->begin < line->end && text_is_blank(*line->begin))
        line->begin++;
    while (line->end > line->begin && text_is_blank(line->end[-1]))
        line->end--;
    return true;
}

// Error messages for words of a text file.

size_t scan_line_of(const file_text *text, bool (*takes)(word_scan *scan, const char *word), const char *word, size_t number)
{
    word_scan scan = word_scan_start(text->data, text->size);
    do
    {
        if (takes(&scan, word) && number-- == 0)
            break;
    } while (scan_next_line(&scan));
    return scan.line;
}

bat_status scan_word_fault(word_scan *scan, size_t index, const char *fault, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    scan_skip_blanks(scan);
    return error_set(error, BAT_BAD_FILE, index, scan->line, "'%s' %s", text_excerpt(excerpt, scan->at, scan_word_end(scan)),
                     fault);
}

bool scan_not_finite(word_scan *scan, double *value)
{
    static const char *const WORDS[] = {"nan", "inf", "infinity", "nan(ind)", "1.#ind", "1.#qnan", "1.#inf"};
    scan_skip_blanks(scan);
    const char *begin = scan->at, *end = scan_word_end(scan);
    begin += begin < end && (*begin == '-' || *begin == '+');
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++)
        if ((size_t)(end - begin) == strlen(WORDS[i]) && strncasecmp(begin, WORDS[i], strlen(WORDS[i])) == 0)
        {
            scan->at = end;
            *value = NAN;
            return true;
        }
    return false;
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
