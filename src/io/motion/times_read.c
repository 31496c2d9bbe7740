#include "batten/motion.h"

#include "base/error.h"
#include "base/number_digits.h"
#include "curve/curve_attributes.h"
#include "io/common/number_text.h"
#include "io/common/time_text.h"
#include "io/motion/pose_translation.h"

#include <stdlib.h>
#include <string.h>

typedef struct time_list
{
    double *times;
    size_t count, capacity;
    int64_t origin;
    int decimals; ///< of the unit; 0: by the size
} time_list;

/// Read a time, less the origin. Returns null or an error text.
static const char *read_time(const time_list *list, const char *begin, const char *end, double *time)
{
    int64_t whole;
    iso_time date;
    int decimals = list->decimals > 0 ? list->decimals : exact_time_decimals(begin, end);
    bool counts = iso_time_read(begin, end, &date);
    if (counts)
        whole = date.nanoseconds;
    else
        counts = (decimals > 0 || list->origin != 0) && exact_time_read(begin, end, decimals, &whole);
    if (counts)
    {
        *time = exact_time_since(whole, list->origin);
        return NULL;
    }
    const char *fault = number_read(begin, end, time);
    if (fault == NULL)
        *time = *time / (double)number_power_of_ten(decimals) - (double)list->origin;
    return fault;
}

static bat_status add_line(time_list *list, const text_line *line, bat_error *error)
{
    const char *begin = line->begin, *end = line->end;
    char excerpt[EXCERPT_SIZE], before[NUMBER_DIGITS_SIZE], digits[NUMBER_DIGITS_SIZE];
    double time;
    bool title = list->count == 0 && end - begin == 4 && strncmp(begin, "time", 4) == 0;
    if (begin == end || *begin == '#' || title)
        return BAT_OK;
    const char *fault = read_time(list, begin, end, &time);
    if (fault != NULL)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "'%s' is not a time (%s): a line has one number",
                         text_excerpt(excerpt, begin, end), fault);
    if (list->count > 0 && !(time > list->times[list->count - 1]))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "the time %s does not come after %s",
                         number_digits(time, digits), number_digits(list->times[list->count - 1], before));
    return ARRAY_ADD(list->times, list->capacity, list->count, time) ? BAT_OK
                                                                     : error_memory(error, list->count * sizeof time);
}

bat_status bat_motion_times_read(const char *path, const bat_curve_set *set, double **times, size_t *count, bat_error *error)
{
    file_text text = {0};
    time_list list = {.origin = set != NULL ? bat_curve_set_time_origin(set) : 0,
                      .decimals = set != NULL && set->attributes != NULL ? set->attributes->time_decimals : 0};
    bat_status status = file_text_read(path, NULL, &text, error);
    text_line line = text_line_start(&text);
    while (status == BAT_OK && text_line_next(&text, &line))
        status = add_line(&list, &line, error);
    if (status == BAT_OK && list.count == 0)
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "the file has no times");
    file_text_free(&text);
    if (status == BAT_OK)
    {
        *times = list.times;
        *count = list.count;
    }
    else
        free(list.times);
    return status;
}
