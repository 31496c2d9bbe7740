#include "io/csv_columns.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool csv_columns_name(csv_columns *columns, const csv_field *fields, size_t count)
{
    size_t size = count * sizeof(char *);
    for (size_t i = 0; i < count; i++)
        size += (size_t)(fields[i].end - fields[i].begin) + 1;
    char **names = malloc(size);
    if (names == NULL)
        return false;
    char *text = (char *)(names + count);
    for (size_t i = 0; i < count; i++)
    {
        size_t length = (size_t)(fields[i].end - fields[i].begin);
        names[i] = memcpy(text, fields[i].begin, length);
        text[length] = '\0';
        text += length + 1;
    }
    columns->names = names;
    columns->count = count;
    return true;
}

/// Whether a column has this name, in either case, with or without quotes around it.
static bool name_is(const char *column, const char *name)
{
    size_t length = strlen(name);
    bool quoted = column[0] == '"';
    return strncasecmp(column + quoted, name, length) == 0 && strcmp(column + quoted + length, quoted ? "\"" : "") == 0;
}

static bool find_name(const csv_columns *columns, const char *const *wanted, size_t *column)
{
    if (columns->names == NULL)
        return false;
    for (size_t i = 0; i < columns->count; i++)
        for (const char *const *name = wanted; *name != NULL; name++)
            if (name_is(columns->names[i], *name))
            {
                *column = i;
                return true;
            }
    return false;
}

bool csv_columns_geographic(const csv_columns *columns, size_t *longitude, size_t *latitude)
{
    static const char *const longitudes[] = {"lon", "lng", "long", "longitude", NULL};
    static const char *const latitudes[] = {"lat", "latitude", NULL};
    return find_name(columns, longitudes, longitude) && find_name(columns, latitudes, latitude);
}

bool csv_columns_use_degrees(csv_columns *columns, size_t longitude, size_t latitude)
{
    static const char *const altitudes[] = {"alt", "altitude", "ele", "elevation", "height", NULL};
    size_t *places = memory_array(columns->count, sizeof *places);
    if (places == NULL)
        return false;
    size_t channel = 0, altitude;
    bool has_altitude = find_name(columns, altitudes, &altitude);
    for (size_t i = 0; i < columns->count; i++)
    {
        if (has_altitude && i == altitude)
            columns->altitude = channel;
        places[i] = i == longitude ? 0 : i == latitude ? 1 : 2 + channel++;
    }
    columns->places = places;
    columns->degrees = true;
    return true;
}
