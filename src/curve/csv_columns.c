#include "curve/csv_columns.h"

#include "base/memory.h"
#include "curve/point_form.h"

#include <stdlib.h>
#include <string.h>

/// @file
/// The meaning of CSV columns: coordinates, times, velocities and other channels.

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

static column_names names_of(const csv_columns *columns)
{
    return (column_names){columns->names, columns->count};
}

static bool find_name(const csv_columns *columns, const char *const *wanted, size_t *column)
{
    column_names names = names_of(columns);
    for (size_t i = 0; wanted[i] != NULL; i++)
    {
        *column = column_find(&names, wanted[i]);
        if (*column != BAT_NO_INDEX)
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

/// Assign the next coordinate to a column, if the column exists and has no meaning yet.
static void place_column(csv_columns *columns, const char *name, size_t *next)
{
    column_names names = names_of(columns);
    size_t column = column_find(&names, name);
    if (column != BAT_NO_INDEX && columns->places[column] == BAT_NO_INDEX)
        columns->places[column] = (*next)++;
}

bool csv_columns_use_form(csv_columns *columns, const point_form *form)
{
    columns->form = form;
    if (columns->names == NULL)
        return true;
    columns->places = memory_array(columns->count, sizeof *columns->places);
    if (columns->places == NULL)
        return false;
    size_t next = 0;
    for (size_t i = 0; i < columns->count; i++)
        columns->places[i] = BAT_NO_INDEX;
    for (const char *const *name = form->names; *name != NULL; name++)
        place_column(columns, *name, &next);
    if (next < form->count) // no name is in the header: the columns are in the form's order
        next = 0;
    for (size_t i = 0; i < columns->count; i++)
        if (columns->places[i] == BAT_NO_INDEX)
            columns->places[i] = next++;
    return true;
}

/// The channel of a column, or BAT_NO_INDEX.
static size_t channel_of(const csv_columns *columns, size_t coordinates, size_t column)
{
    if (column == BAT_NO_INDEX)
        return BAT_NO_INDEX;
    size_t place = columns->places != NULL ? columns->places[column] : column;
    return place < coordinates ? BAT_NO_INDEX : place - coordinates;
}

void csv_columns_channels(const csv_columns *columns, size_t coordinates, const point_form *form, motion_channels *channels)
{
    column_names names = names_of(columns);
    *channels = (motion_channels){.time = channel_of(columns, coordinates, column_find_time(&names))};
    for (size_t i = 0; form != NULL && i < form->velocity_count; i++)
    {
        channels->velocity[i] = channel_of(columns, coordinates, column_find(&names, form->velocities[i]));
        if (channels->velocity[i] == BAT_NO_INDEX)
            return;
    }
    channels->velocity_count = form != NULL ? form->velocity_count : 0;
}
