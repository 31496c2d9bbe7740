#include "io/curve/csv.h"

#include "base/memory.h"

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

static csv_kind kind_of(const csv_columns *columns, size_t column)
{
    return columns->kinds != NULL ? (csv_kind)columns->kinds[column] : CSV_NUMBER;
}

/// Choose columns of numbers by their places, up to `most`. A column of times is none where two others are left.
static void choose_places(const csv_columns *columns, size_t most, csv_choice *choice)
{
    column_names names = names_of(columns);
    size_t numbers = 0, time = column_find_time(&names);
    for (size_t i = 0; i < columns->count; i++)
        numbers += kind_of(columns, i) == CSV_NUMBER ? 1 : 0;
    bool timed = time != BAT_NO_INDEX && kind_of(columns, time) == CSV_NUMBER && numbers > 2;
    choice->times = timed ? time : BAT_NO_INDEX;
    choice->count = 0;
    choice->by_place = true;
    for (size_t i = 0; i < columns->count && choice->count < most; i++)
        if (kind_of(columns, i) == CSV_NUMBER && !(timed && i == time))
            choice->columns[choice->count++] = i;
}

void csv_columns_choose(const csv_columns *columns, const char *space, csv_choice *choice)
{
    column_names names = names_of(columns);
    named_coordinates named = names_find_coordinates(&names);
    bool two = space != NULL && (strcmp(space, "plane") == 0 || strcmp(space, "disk") == 0);
    bool sphere = space != NULL && strcmp(space, "sphere") == 0;
    bool flat = space != NULL && strcmp(space, "euclidean") == 0;
    *choice = (csv_choice){.space = space, .altitude = BAT_NO_INDEX, .times = BAT_NO_INDEX, .spelled = named.spelled};
    memcpy(choice->columns, named.columns, sizeof named.columns);
    choice->count = named.count;
    if (named.geographic && (space == NULL || sphere))
    {
        choice->space = "sphere";
        choice->altitude = named.altitude;
        choice->degrees = true;
        choice->radians = named.radians;
    }
    else if (two && named.count >= 2)
        choice->count = 2;
    else if (named.geographic || named.count == 0 || (sphere && named.count < 3) || !(space == NULL || sphere || flat))
        choose_places(columns, two ? 2 : SIZE_MAX, choice);
    if (choice->space == NULL)
        choice->space = choice->count == 2 ? "plane" : "euclidean";
}

bool csv_columns_place(csv_columns *columns, const size_t *chosen, size_t count)
{
    size_t *places = memory_array(columns->count, sizeof *places);
    if (places == NULL)
        return false;
    for (size_t i = 0; i < columns->count; i++)
        places[i] = BAT_NO_INDEX;
    for (size_t i = 0; i < count; i++)
        places[chosen[i]] = i;
    for (size_t i = 0, next = count; i < columns->count; i++)
        if (places[i] == BAT_NO_INDEX && kind_of(columns, i) == CSV_NUMBER)
            places[i] = next++;
    free(columns->places);
    columns->places = places;
    return true;
}

bool csv_columns_fit(const csv_columns *columns, size_t coordinates, size_t channels)
{
    size_t hidden = columns->has_places ? CSV_PLACE_CHANNELS : 0;
    return coordinates + channels == columns->count - columns->other_count + hidden;
}

void csv_columns_free(csv_columns *columns)
{
    free(columns->names);
    free(columns->places);
    free(columns->kinds);
    free(columns->chosen);
    free(columns->cells.first_rows);
    free(columns->cells.closed);
    free(columns->cells.offsets);
    free(columns->cells.text);
    *columns = (csv_columns){.altitude = BAT_NO_INDEX, .corner = BAT_NO_INDEX};
}

bool csv_columns_use_degrees(csv_columns *columns, size_t longitude, size_t latitude)
{
    size_t pair[2] = {longitude, latitude};
    columns->degrees = true;
    return csv_columns_place(columns, pair, 2);
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
    free(columns->places);
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
        if (columns->places[i] == BAT_NO_INDEX && kind_of(columns, i) == CSV_NUMBER)
            columns->places[i] = next++;
    return true;
}

/// The channel of a column, or BAT_NO_INDEX.
static size_t channel_of(const csv_columns *columns, size_t coordinates, size_t column)
{
    if (column == BAT_NO_INDEX)
        return BAT_NO_INDEX;
    size_t place = columns->places != NULL ? columns->places[column] : column;
    return place < coordinates || place == BAT_NO_INDEX ? BAT_NO_INDEX : place - coordinates;
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

static void free_columns(csv_columns *columns)
{
    csv_columns_free(columns);
    free(columns);
}

bat_curve_attributes *csv_attributes_new(bat_curve_format format)
{
    bat_curve_attributes *attributes = attributes_new(format);
    csv_columns *columns = malloc(sizeof *columns);
    if (attributes == NULL || columns == NULL)
    {
        attributes_release(attributes);
        free(columns);
        return NULL;
    }
    *columns = (csv_columns){.altitude = BAT_NO_INDEX, .corner = BAT_NO_INDEX};
    attributes->csv = columns;
    attributes->free_csv = free_columns;
    return attributes;
}

void csv_attributes_describe(bat_curve_attributes *attributes, const bat_space *space)
{
    const csv_columns *columns = attributes->csv;
    const point_form *form = columns->form != NULL ? columns->form : point_form_first(space->name, space->point_dim);
    size_t coordinates = columns->degrees ? 2 : columns->form != NULL ? columns->form->count : space->point_dim;
    size_t numbers = columns->count - columns->other_count + (columns->has_places ? CSV_PLACE_CHANNELS : 0);
    attributes->degrees = columns->degrees;
    attributes->form = columns->form;
    if (columns->names == NULL || numbers < coordinates)
        return;
    attributes->channel_count = numbers - coordinates;
    csv_columns_channels(columns, coordinates, columns->degrees ? NULL : form, &attributes->channels);
}

bool csv_columns_of_motion(const bat_curve_attributes *attributes, csv_columns *columns)
{
    static const char *const degrees[] = {"lon", "lat", NULL};
    const point_form *form = attributes->form;
    const motion_channels *channels = &attributes->channels;
    const char *names[1 + MAX_FORM_COLUMNS + MAX_VELOCITIES];
    csv_field fields[1 + MAX_FORM_COLUMNS + MAX_VELOCITIES];
    size_t count = 0, first = channels->time != BAT_NO_INDEX;
    *columns = (csv_columns){.altitude = BAT_NO_INDEX, .corner = BAT_NO_INDEX};
    if (first > 0)
        names[count++] = "time";
    for (const char *const *point = attributes->degrees ? degrees : form->names; *point != NULL; point++)
        names[count++] = *point;
    for (size_t i = 0; i < channels->velocity_count; i++)
        names[count++] = form->velocities[i];
    for (size_t i = 0; i < count; i++)
        fields[i] = (csv_field){names[i], names[i] + strlen(names[i])};
    return csv_columns_name(columns, fields, count) &&
           (attributes->degrees ? csv_columns_use_degrees(columns, first, first + 1) : csv_columns_use_form(columns, form));
}
