#include "batten/motion.h"

#include "base/error.h"
#include "base/file_bytes.h"
#include "base/number_digits.h"
#include "io/common/number_text.h"
#include "io/common/time_text.h"
#include "io/motion/pose_translation.h"

#include <stdlib.h>
#include <string.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

typedef struct time_list
{
    double *times;
    size_t count, capacity;
    int64_t origin;
} time_list;

/// Read a time, less the origin. Returns null or an error text.
static const char *read_time(const char *begin, const char *end, int64_t origin, double *time)
{
    static const int64_t LEAST = 100000000000000000;
    int64_t whole;
    iso_time date;
    bool counts = iso_time_read(begin, end, &date);
    if (counts)
        whole = date.nanoseconds;
    else
        counts = (csv_read_whole((csv_field){begin, end}, INT64_DIGITS, &whole) && whole >= LEAST) ||
                 (origin != 0 && exact_time_read(begin, end, &whole));
    if (counts)
    {
        *time = exact_time_since(whole, origin);
        return NULL;
    }
    const char *fault = number_read(begin, end, time);
    *time -= fault == NULL ? (double)origin : 0;
    return fault;
}

static bat_status add_line(time_list *list, const char *begin, const char *end, size_t line, bat_error *error)
{
    char excerpt[EXCERPT_SIZE], before[NUMBER_DIGITS_SIZE], digits[NUMBER_DIGITS_SIZE];
    double time;
    while (begin < end && is_blank(*begin))
        begin++;
    while (end > begin && is_blank(end[-1]))
        end--;
    bool title = list->count == 0 && end - begin == 4 && strncmp(begin, "time", 4) == 0;
    if (begin == end || *begin == '#' || title)
        return BAT_OK;
    const char *fault = read_time(begin, end, list->origin, &time);
    if (fault != NULL)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, "'%s' is not a time (%s): a line has one number",
                         text_excerpt(excerpt, begin, end), fault);
    if (list->count > 0 && !(time > list->times[list->count - 1]))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, "the time %s does not come after %s",
                         number_digits(time, digits), number_digits(list->times[list->count - 1], before));
    return ARRAY_ADD(list->times, list->capacity, list->count, time) ? BAT_OK
                                                                     : error_memory(error, list->count * sizeof time);
}

bat_status bat_motion_times_read(const char *path, int64_t origin, double **times, size_t *count, bat_error *error)
{
    text_buffer text = {0};
    time_list list = {.origin = origin};
    bat_status status = file_bytes_read(path, FILE_MAX_BYTES, &text, error);
    size_t line = 1;
    for (const char *at = text.data, *end = text.data + text.size; status == BAT_OK && at < end; line++)
    {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        stop = stop != NULL ? stop : end;
        status = add_line(&list, at, stop, line, error);
        at = stop < end ? stop + 1 : end;
    }
    if (status == BAT_OK && list.count == 0)
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "the file has no times");
    text_free(&text);
    if (status == BAT_OK)
    {
        *times = list.times;
        *count = list.count;
    }
    else
        free(list.times);
    return status;
}
