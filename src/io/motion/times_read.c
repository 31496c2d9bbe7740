#include "batten/motion.h"

#include "io/motion/pose_translation.h"

#include <math.h>

/// Rates beside a time, and accelerations beside these.
#define RATES 3

typedef struct time_list
{
    size_t parts; ///< 1: times; 2: rates, too; 3: accelerations, too, where the first row has them
    struct
    {
        double *values;
        size_t count, capacity;
    } arrays[3]; ///< of the parts
    int64_t origin;
    int decimals; ///< of the unit; 0: by the size
    size_t repeats, first_repeat;
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
    char excerpt[EXCERPT_SIZE], before[EXACT_TIME_SIZE + 1], separator = csv_find_separator(line);
    double numbers[1 + 2 * RATES], last = -INFINITY;
    size_t found = 1, count = list->arrays[0].count;
    if (line->begin == line->end || *line->begin == '#')
        return BAT_OK;
    const char *fault = list->parts > 1 ? csv_split(text, line, separator, fields, &found) : NULL;
    const char *begin = fields[0].begin, *end = fields[0].end;
    if (count == 0 && (list->parts > 1 ? !number_resembles(begin, end) : end - begin == 4 && strncmp(begin, "time", 4) == 0))
        return BAT_OK;
    bool comma = false;
    for (size_t c = RATES + 1; c <= 2 * RATES && count == 0 && list->parts > 2; c++)
        list->parts -= c >= found || csv_read_number(fields[c], separator, numbers, &comma) != NULL;
    size_t wanted = 1 + (list->parts - 1) * RATES;
    if (fault == NULL && found < wanted)
        fault =
            list->parts > 2 ? "a row has a time, three rates and three accelerations" : "a row has a time and three rates";
    if (fault != NULL)
        return ERROR_FILE(error, line->number, "%s", fault);
    fault = read_time(list, begin, end, numbers);
    (void)text_excerpt(excerpt, begin, end);
    if (fault != NULL)
        return ERROR_FILE(error, line->number, "'%s' is not a time (%s)%s", excerpt, fault,
                          list->parts > 1 ? "" : ": a line has one number");
    if (count > 0)
        last = list->arrays[0].values[count - 1];
    if (list->parts > 1 && numbers[0] == last)
    {
        list->first_repeat = list->repeats++ == 0 ? line->number : list->first_repeat;
        return BAT_OK;
    }
    if (!(numbers[0] > last))
    {
        *exact_time_write(before, list->origin, list->decimals, last) = '\0';
        return ERROR_FILE(error, line->number, "the time %s does not come after %s", excerpt, before);
    }
    for (size_t c = 0; c < wanted; c++)
    {
        size_t part = (c + RATES - 1) / RATES;
        fault = c > 0 ? csv_read_number(fields[c], separator, &numbers[c], &comma) : NULL;
        if (fault != NULL)
            return ERROR_FILE(error, line->number, "'%s' %s", text_excerpt(excerpt, fields[c].begin, fields[c].end), fault);
        if (!ARRAY_ADD(list->arrays[part].values, list->arrays[part].capacity, list->arrays[part].count, numbers[c]))
            return error_memory(error, count * sizeof *numbers);
    }
    return BAT_OK;
}

/// Read the parts of a table into arrays.
static bat_status read_list(const char *path, const bat_curve_set *set, size_t parts, double **const arrays[], size_t *count,
                            bat_error *error)
{
    file_text text = {0};
    time_list list = {.parts = parts,
                      .origin = set != NULL ? bat_curve_set_time_origin(set) : 0,
                      .decimals = set != NULL && set->attributes != NULL ? set->attributes->time_decimals : 0};
    pose_translation named = {.source = &text};
    bat_status status = file_text_read(path, NULL, &text, error);
    if (status == BAT_OK && parts > 1)
        status = pose_translate_rates(&named, error);
    if (named.text.size > 0 && (named.units[TIME] != UNIT_NONE || named.columns[SECONDS] != BAT_NO_INDEX))
        list.decimals = pose_unit_decimals(named.units[TIME]);
    const file_text rows = named.text.size > 0 ? (file_text){.data = named.text.data, .size = named.text.size} : text;
    text_line line = text_line_start(&rows);
    while (status == BAT_OK && text_line_next(&rows, &line))
        status = add_line(&list, &rows, &line, error);
    if (status == BAT_OK && list.arrays[0].count == 0)
        status = ERROR_FILE(error, 0, "the file has no times");
    if (status == BAT_OK && list.repeats > 0 && set != NULL && set->attributes != NULL &&
        !attributes_note(set->attributes,
                         "%zu row%s of rates with the time of the row before left out, the first on line %zu", list.repeats,
                         list.repeats > 1 ? "s" : "", list.first_repeat))
        status = error_memory(error, sizeof list);
    if (named.text.failed)
        status = error_memory(error, text.size);
    file_text_free(&text);
    text_free(&named.text);
    for (size_t k = 0; k < parts && status == BAT_OK; k++)
        *arrays[k] = list.arrays[k].values;
    for (size_t k = 0; k < parts && status != BAT_OK; k++)
        free(list.arrays[k].values);
    *count = status == BAT_OK ? list.arrays[0].count : *count;
    return status;
}

bat_status bat_motion_rates_read(const char *path, const bat_curve_set *set, double **times, double **rates, size_t *count,
                                 bat_error *error)
{
    return read_list(path, set, rates != NULL ? 2 : 1, (double **[]){times, rates}, count, error);
}

bat_status bat_motion_gyro_read(const char *path, const bat_curve_set *set, bat_motion_gyro *gyro, bat_error *error)
{
    double *times, *rates, *forces;
    bat_status status = read_list(path, set, 3, (double **[]){&times, &rates, &forces}, &gyro->count, error);
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
    return read_list(path, set, 1, &times, count, error);
}
