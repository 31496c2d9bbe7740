#include "base/choice.h"

#include "base/error.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

const bat_choice *choice_at(const choice_table *table, size_t index)
{
    return index < table->count ? (const bat_choice *)(const void *)((const char *)table->rows + index * table->size) : NULL;
}

const bat_choice *choice_find(const choice_table *table, const char *name, size_t length)
{
    const bat_choice *row;
    for (size_t i = 0; (row = choice_at(table, i)) != NULL; i++)
        if (strlen(row->name) == length && memcmp(row->name, name, length) == 0)
            return row;
    return NULL;
}

const bat_choice *choice_of_value(const choice_table *table, int value)
{
    const bat_choice *row;
    for (size_t i = 0; (row = choice_at(table, i)) != NULL; i++)
        if (row->value == value)
            return row;
    return NULL;
}

/// Whether a list of endings, ".csv .txt", has one of them.
static bool has_ending(const char *endings, const char *ending)
{
    size_t length = strlen(ending);
    while (endings != NULL && *endings != '\0')
    {
        size_t here = strcspn(endings, " ");
        if (here == length && strncasecmp(endings, ending, length) == 0)
            return true;
        endings += here + (endings[here] == ' ');
    }
    return false;
}

const bat_choice *choice_of_path(const choice_table *table, const char *path)
{
    const char *dot = strrchr(path, '.');
    const bat_choice *row;
    for (size_t i = 0; dot != NULL && (row = choice_at(table, i)) != NULL; i++)
        if (has_ending(row->endings, dot))
            return row;
    return NULL;
}

bool choice_list(const choice_table *table, size_t index, bat_choice *choice)
{
    const bat_choice *row = choice_at(table, index);
    if (row == NULL)
        return false;
    *choice = *row;
    choice->settings = row->settings != NULL ? row->settings : "";
    choice->endings = row->endings != NULL ? row->endings : "";
    return true;
}

bat_status choice_by_name(const choice_table *table, const char *name, int *value, bat_error *error)
{
    const bat_choice *row = choice_find(table, name, strlen(name));
    if (row != NULL)
    {
        *value = row->value;
        return BAT_OK;
    }
    char names[BAT_ERROR_TEXT_SIZE / 2] = "";
    for (size_t i = 0, used = 0; (row = choice_at(table, i)) != NULL && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i > 0 ? ", " : "", row->name);
    return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there is no %s '%.80s'; there are %s", table->what, name,
                     names);
}

const char *choice_name(const choice_table *table, int value)
{
    const bat_choice *row = choice_of_value(table, value);
    return row != NULL ? row->name : "unknown";
}
