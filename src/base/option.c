#include "base/option.h"

#include "base/choice.h"
#include "base/error.h"

#include <stdio.h>

#define RANGE_SIZE 80

static double value_of(const void *options, const option_field *field)
{
    const char *at = (const char *)options + field->offset;
    if (field->kind == OPTION_CHOICE || field->kind == OPTION_INT)
        return (double)*(const int *)(const void *)at;
    return field->kind == OPTION_SIZE ? (double)*(const size_t *)(const void *)at : *(const double *)(const void *)at;
}

/// Whether options may have the enumerator of a row.
static bool is_for_options(const bat_choice *row)
{
    return row != NULL && row->use != BAT_CHOICE_USE_RESULT;
}

static bool is_in_range(const option_field *field, double value)
{
    if (field->kind == OPTION_CHOICE)
        return is_for_options(choice_of_value(field->family, (int)value));
    if (field->kind == OPTION_ANGLE && isnan(value))
        return true;
    if (field->kind == OPTION_ZERO && value == 0)
        return true;
    if (field->kind == OPTION_ABOVE && !(value > field->low))
        return false;
    bool bounded = field->kind == OPTION_SIZE || isfinite(value);
    return bounded && value >= field->low && value <= field->high;
}

/// The field of an enumeration with the bounds of its rows; others as they are.
static option_field with_bounds(const option_field *field)
{
    option_field made = *field;
    const bat_choice *row;
    made.low = field->kind == OPTION_CHOICE ? INFINITY : field->low;
    made.high = field->kind == OPTION_CHOICE ? -INFINITY : field->high;
    for (size_t i = 0; field->family != NULL && (row = choice_at(field->family, i)) != NULL; i++)
    {
        made.low = is_for_options(row) ? fmin(made.low, row->value) : made.low;
        made.high = is_for_options(row) ? fmax(made.high, row->value) : made.high;
    }
    return made;
}

static void describe_range(const option_field *given, char range[RANGE_SIZE])
{
    const option_field bounded = with_bounds(given), *field = &bounded;
    bool number = field->kind == OPTION_NUMBER || field->kind == OPTION_ABOVE;
    const char *finite = number && isinf(field->high) ? "finite and " : "";
    if (isinf(field->low))
        (void)snprintf(range, RANGE_SIZE, "finite");
    else if (field->kind == OPTION_ABOVE && isinf(field->high))
        (void)snprintf(range, RANGE_SIZE, "%sabove %.10g", finite, field->low);
    else if (field->kind == OPTION_ABOVE)
        (void)snprintf(range, RANGE_SIZE, "above %.10g and at most %.10g", field->low, field->high);
    else if (isinf(field->high))
        (void)snprintf(range, RANGE_SIZE, "%sat least %.10g", finite, field->low);
    else
        (void)snprintf(range, RANGE_SIZE, "%sfrom %.10g to %.10g%s", field->kind == OPTION_ZERO ? "0 or " : "", field->low,
                       field->high, field->kind == OPTION_ANGLE ? ", or NaN" : "");
}

bat_status options_check(const void *options, const option_field *fields, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        if (fields[i].kind == OPTION_TABLE)
        {
            bat_status status = bat_options_check(fields[i].table, (const char *)options + fields[i].offset, error);
            if (status != BAT_OK)
                return status;
            continue;
        }
        double value = value_of(options, &fields[i]);
        if (is_in_range(&fields[i], value))
            continue;
        char range[RANGE_SIZE];
        describe_range(&fields[i], range);
        return error_option(error, fields[i].name, "is %.10g, but must be %s", value, range);
    }
    return BAT_OK;
}

bat_status bat_options_check(const bat_options_table *table, const void *options, bat_error *error)
{
    if (options == NULL)
        return BAT_OK;
    bat_status status = options_check(options, table->fields, table->count, error);
    return status == BAT_OK && table->check != NULL ? table->check(options, error) : status;
}
