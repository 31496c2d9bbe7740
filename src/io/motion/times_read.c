#include "batten/motion.h"

#include "base/error.h"
#include "base/number_digits.h"
#include "curve/curve_attributes.h"
#include "io/common/number_text.h"
#include "io/common/time_text.h"
#include "io/motion/pose_translation.h"

#include <stdlib.h>
#include <string.h>

/// Rates beside a time, and accelerations beside these.
#define RATES 3

typedef struct time_list
{
    double *times;
    size_t count, capacity;
    bool with_rates;
    bool with_forces;       ///< accelerations are wanted; from the first row on: are there
    double *rates, *forces; ///< count x RATES
    size_t rate_count, rate_capacity, force_count, force_capacity;
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

static bat_status add_line(time_list *list, const file_text *text, const text_line *line, bat_error *error)
{
    csv_field fields[BAT_SPACE_MAX_DIM] = {{line->begin, line->end}};
    char excerpt[EXCERPT_SIZE], before[NUMBER_DIGITS_SIZE], digits[NUMBER_DIGITS_SIZE], separator = csv_find_separator(line);
    double time, rate;
    size_t found = 1;
    if (line->begin == line->end || *line->begin == '#')
        return BAT_OK;
    const char *fault = list->with_rates ? csv_split(text, line, separator, fields, &found) : NULL;
    bool comma = false;
    for (size_t c = RATES + 1; c <= 2 * RATES && list->count == 0 && number_resembles(line->begin, fields[0].end); c++)
        list->with_forces = list->with_forces && c < found && csv_read_number(fields[c], separator, &rate, &comma) == NULL;
    size_t wanted = list->with_forces ? 1 + 2 * RATES : list->with_rates ? 1 + RATES : 1;
    if (fault == NULL && found < wanted)
        fault =
            list->with_forces ? "a row has a time, three rates and three accelerations" : "a row has a time and three rates";
    if (fault != NULL)
        return ERROR_FILE(error, line->number, "%s", fault);
    const char *begin = fields[0].begin, *end = fields[0].end;
    if (list->count == 0 &&
        (list->with_rates ? !number_resembles(begin, end) : end - begin == 4 && strncmp(begin, "time", 4) == 0))
        return BAT_OK;
    fault = read_time(list, begin, end, &time);
    if (fault != NULL)
        return ERROR_FILE(error, line->number, "'%s' is not a time (%s)%s", text_excerpt(excerpt, begin, end), fault,
                          list->with_rates ? "" : ": a line has one number");
    if (list->count > 0 && !(time > list->times[list->count - 1]))
        return ERROR_FILE(error, line->number, "the time %s does not come after %s", number_digits(time, digits),
                          number_digits(list->times[list->count - 1], before));
    bool good = ARRAY_ADD(list->times, list->capacity, list->count, time);
    for (size_t c = 1; good && c < wanted; c++)
    {
        fault = csv_read_number(fields[c], separator, &rate, &comma);
        if (fault != NULL)
            return ERROR_FILE(error, line->number, "'%s' %s", text_excerpt(excerpt, fields[c].begin, fields[c].end), fault);
        good = c <= RATES ? ARRAY_ADD(list->rates, list->rate_capacity, list->rate_count, rate)
                          : ARRAY_ADD(list->forces, list->force_capacity, list->force_count, rate);
    }
    return good ? BAT_OK : error_memory(error, list->count * sizeof time);
}

static bat_status read_list(const char *path, const bat_curve_set *set, double **times, double **rates, double **forces,
                            size_t *count, bat_error *error)
{
    file_text text = {0};
    time_list list = {.with_rates = rates != NULL,
                      .with_forces = forces != NULL,
                      .origin = set != NULL ? bat_curve_set_time_origin(set) : 0,
                      .decimals = set != NULL && set->attributes != NULL ? set->attributes->time_decimals : 0};
    bat_status status = file_text_read(path, NULL, &text, error);
    text_line line = text_line_start(&text);
    while (status == BAT_OK && text_line_next(&text, &line))
        status = add_line(&list, &text, &line, error);
    if (status == BAT_OK && list.count == 0)
        status = ERROR_FILE(error, 0, "the file has no times");
    file_text_free(&text);
    if (status == BAT_OK)
    {
        *times = list.times;
        *count = list.count;
        if (rates != NULL)
            *rates = list.rates;
        if (forces != NULL)
            *forces = list.forces;
        return BAT_OK;
    }
    free(list.times);
    free(list.rates);
    free(list.forces);
    return status;
}

bat_status bat_motion_rates_read(const char *path, const bat_curve_set *set, double **times, double **rates, size_t *count,
                                 bat_error *error)
{
    return read_list(path, set, times, rates, NULL, count, error);
}

bat_status bat_motion_gyro_read(const char *path, const bat_curve_set *set, bat_motion_gyro *gyro, bat_error *error)
{
    double *times, *rates, *forces;
    bat_status status = read_list(path, set, &times, &rates, &forces, &gyro->count, error);
    if (status == BAT_OK)
        *gyro = (bat_motion_gyro){times, rates, gyro->count, forces};
    return status;
}

void bat_motion_gyro_free(bat_motion_gyro *gyro)
{
    free((void *)gyro->times);
    free((void *)gyro->rates);
    free((void *)gyro->forces);
    *gyro = (bat_motion_gyro){0};
}

bat_status bat_motion_times_read(const char *path, const bat_curve_set *set, double **times, size_t *count, bat_error *error)
{
    return read_list(path, set, times, NULL, NULL, count, error);
}
