#include "base/choice.h"

#include "base/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool settings_number(const char **text, double *value)
{
    char *end;
    double numerator = strtod(*text, &end);
    if (end == *text || !isfinite(numerator))
        return false;
    double denominator = 1;
    if (*end == '/')
    {
        const char *start = end + 1;
        denominator = strtod(start, &end);
        if (end == start || !isfinite(denominator) || denominator == 0)
            return false;
    }
    *text = end;
    *value = numerator / denominator;
    return isfinite(*value);
}

/// Whether the settings of a row have an item that begins with `key=`.
static bool takes(const bat_choice *row, const char *key, size_t length)
{
    for (const char *item = row->settings; item != NULL; item = strchr(item, ','))
    {
        item += *item == ',';
        if (strncmp(item, key, length) == 0 && item[length] == '=')
            return true;
    }
    return false;
}

/// Store the value of one item, `length` characters long.
static bool store(const setting *to, const char *value, size_t length, void *values)
{
    void *field = (char *)values + to->offset;
    const char *end = value;
    const bat_choice *row;
    switch (to->kind)
    {
    case SETTING_NUMBER:
        return settings_number(&end, field) && end == value + length;
    case SETTING_FLAG:
        *(bool *)field = *value == '1';
        return length == 1 && (*value == '0' || *value == '1');
    case SETTING_CHOICE:
        break;
    }
    row = choice_find(to->family, value, length);
    if (row != NULL)
        *(int *)field = row->value;
    return row != NULL;
}

bat_status settings_read(const bat_choice *row, const char *text, const setting *settings, size_t count, void *values,
                         bat_error *error)
{
    bool more = *text != '\0';
    while (more)
    {
        size_t key_length = strcspn(text, "=,");
        const char *key = text;
        if (text[key_length] != '=' || !takes(row, key, key_length))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "the scheme %s has no setting '%.*s'; it takes: %s", row->name, (int)key_length, key,
                             row->settings != NULL ? row->settings : "none");
        const char *value = text + key_length + 1;
        size_t length = strcspn(value, ",");
        const setting *to = NULL;
        for (size_t i = 0; i < count; i++)
            if (strlen(settings[i].key) == key_length && memcmp(settings[i].key, key, key_length) == 0)
                to = &settings[i];
        if (to == NULL || !store(to, value, length, values))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "'%.*s' of the scheme %s has no such value: '%.*s'", (int)key_length, key, row->name,
                             (int)length, value);
        more = value[length] == ',';
        text = value + length + more;
    }
    return BAT_OK;
}
