#include "base/choice.h"

#include "base/error.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

const bat_choice *choice_at(const bat_family *family, size_t index)
{
    return index < family->count ? (const bat_choice *)(const void *)((const char *)family->rows + index * family->size)
                                 : NULL;
}

const bat_choice *choice_find(const bat_family *family, const char *name, size_t length)
{
    const bat_choice *row;
    for (size_t i = 0; (row = choice_at(family, i)) != NULL; i++)
        if (row->use <= BAT_CHOICE_USE_UNLISTED && strlen(row->name) == length && memcmp(row->name, name, length) == 0)
            return row;
    return NULL;
}

const bat_choice *choice_of_value(const bat_family *family, int value)
{
    const bat_choice *row;
    for (size_t i = 0; (row = choice_at(family, i)) != NULL; i++)
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

const bat_choice *choice_of_ending(const bat_family *family, const char *path)
{
    const char *dot = strrchr(path, '.');
    const bat_choice *row;
    for (size_t i = 0; dot != NULL && (row = choice_at(family, i)) != NULL; i++)
        if (has_ending(row->endings, dot))
            return row;
    return NULL;
}

/// Whether the program can do with a row what is wanted.
static bool row_serves(const bat_choice *row, bool writes)
{
    return row->endings != NULL && (writes ? row->writes : row->reads);
}

/// The endings of the rows that are read, or of those that are written, as ".csv, .txt, .obj". Returns `text`.
static const char *choice_endings(const bat_family *family, bool writes, char *text, size_t size)
{
    const bat_choice *row;
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; (row = choice_at(family, i)) != NULL; i++)
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
    {".e57", ", of E57 files, which batten.read_points in Python reads and CloudCompare converts to PLY"},
};

bat_status bat_choice_of_path(const bat_family *family, const char *path, bool writes, const bat_choice **choice,
                              bat_error *error)
{
    *choice = family->of_path != NULL ? family->of_path(path) : NULL;
    const char *ending = path_ending(path);
    if (*choice != NULL || ending == NULL)
        return BAT_OK;
    const bat_choice *row = choice_of_ending(family, path);
    if (row != NULL && row_serves(row, writes))
    {
        *choice = row;
        return BAT_OK;
    }
    char known[2 * BAT_ERROR_TEXT_SIZE / 3];
    const char *hint = "";
    for (size_t i = 0; i < sizeof HINTS / sizeof *HINTS; i++)
        if (has_ending(HINTS[i].endings, ending))
            hint = HINTS[i].text;
    (void)ERROR_ARGUMENT(error, "no %s that is %s has the ending '%.20s'%s; there are %s", family->what,
                         writes ? "written" : "read", ending, hint, choice_endings(family, writes, known, sizeof known));
    return error_remedy(error, BAT_INVALID_ARGUMENT, writes ? "write.format" : "read.format", "names one");
}

bat_status choice_unnamed_output(const bat_family *family, bat_error *error)
{
    char known[2 * BAT_ERROR_TEXT_SIZE / 3];
    (void)ERROR_ARGUMENT(error, "cannot tell what format to write; the endings are %s",
                         choice_endings(family, true, known, sizeof known));
    return error_remedy(error, BAT_INVALID_ARGUMENT, "write.format", "names one");
}

const bat_choice *bat_choices(const bat_family *family, size_t index)
{
    const bat_choice *row;
    for (size_t i = 0; (row = choice_at(family, i)) != NULL; i++)
        if (row->use == BAT_CHOICE_USE_LISTED && index-- == 0)
            return row;
    return NULL;
}

bat_status bat_choice_find(const bat_family *family, const char *name, const bat_choice **choice, bat_error *error)
{
    const bat_choice *row = choice_find(family, name, strlen(name));
    if (row != NULL)
    {
        *choice = row;
        return BAT_OK;
    }
    char names[BAT_ERROR_TEXT_SIZE / 2] = "";
    for (size_t i = 0, used = 0; (row = choice_at(family, i)) != NULL && used < sizeof names; i++)
        if (row->use <= BAT_CHOICE_USE_UNLISTED)
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "", row->name);
    return ERROR_ARGUMENT(error, "there is no %s '%.80s'; there are %s", family->what, name, names);
}

const char *bat_choice_name(const bat_family *family, int value)
{
    const bat_choice *row = choice_of_value(family, value);
    return row != NULL ? row->name : "unknown";
}

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
    if (to->kind == SETTING_NUMBER)
        return settings_number(&end, field) && end == value + length;
    if (to->kind == SETTING_FLAG)
    {
        *(bool *)field = *value == '1';
        return length == 1 && (*value == '0' || *value == '1');
    }
    const bat_choice *row = choice_find(to->family, value, length);
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
            return ERROR_ARGUMENT(error, "the scheme %s has no setting '%.*s'; it takes: %s", row->name, (int)key_length,
                                  key, row->settings != NULL ? row->settings : "none");
        const char *value = text + key_length + 1;
        size_t length = strcspn(value, ",");
        const setting *to = NULL;
        for (size_t i = 0; i < count; i++)
            if (strlen(settings[i].key) == key_length && memcmp(settings[i].key, key, key_length) == 0)
                to = &settings[i];
        if (to == NULL || !store(to, value, length, values))
            return ERROR_ARGUMENT(error, "'%.*s' of the scheme %s has no such value: '%.*s'", (int)key_length, key,
                                  row->name, (int)length, value);
        more = value[length] == ',';
        text = value + length + more;
    }
    return BAT_OK;
}
