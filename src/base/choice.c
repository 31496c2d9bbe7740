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

/// Whether the program can do with a row what is wanted.
static bool row_serves(const bat_choice *row, bool writes)
{
    return row->endings != NULL && (writes ? row->writes : row->reads);
}

const char *choice_endings(const choice_table *table, bool writes, char *text, size_t size)
{
    const bat_choice *row;
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; (row = choice_at(table, i)) != NULL; i++)
        for (const char *at = row_serves(row, writes) ? row->endings : ""; *at != '\0' && used < size;)
        {
            int length = (int)strcspn(at, " ");
            used += (size_t)snprintf(text + used, size - used, "%s%.*s", used > 0 ? ", " : "", length, at);
            at += length + (at[length] == ' ');
        }
    return text;
}

/// The ending of a path from its dot on, or null: a name may have a dot that begins no ending, as "v1.2" has.
static const char *path_ending(const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash != NULL ? slash + 1 : path, *dot = strrchr(name, '.');
    bool letter = false;
    if (dot == NULL || dot == name)
        return NULL;
    for (const char *at = dot + 1; *at != '\0'; at++)
    {
        bool here = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z');
        if (!here && !(*at >= '0' && *at <= '9'))
            return NULL;
        letter = letter || here;
    }
    return letter ? dot : NULL;
}

/// What to say of endings of files that are not read.
static const struct
{
    const char *endings, *text;
} HINTS[] = {
    {".gz .bz2 .xz .zst .zip", ", of compressed files"},
    {".laz", ", of compressed LAS files, which laszip and PDAL expand"},
    {".e57", ", of E57 files, which PDAL and CloudCompare convert to LAS or PLY"},
};

bat_status choice_for_path(const choice_table *table, const char *path, bool writes, const char *option,
                           const bat_choice **row, bat_error *error)
{
    const char *ending = path_ending(path);
    *row = ending != NULL ? choice_of_path(table, path) : NULL;
    if (ending == NULL || (*row != NULL && row_serves(*row, writes)))
        return BAT_OK;
    char known[2 * BAT_ERROR_TEXT_SIZE / 3];
    const char *hint = "";
    for (size_t i = 0; i < sizeof HINTS / sizeof *HINTS; i++)
        if (has_ending(HINTS[i].endings, ending))
            hint = HINTS[i].text;
    return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                     "no %s that is %s has the ending '%.20s'%s; there are %s; --%s names one", table->what,
                     writes ? "written" : "read", ending, hint, choice_endings(table, writes, known, sizeof known), option);
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
