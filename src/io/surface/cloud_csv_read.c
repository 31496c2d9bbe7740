#include "io/mesh/mesh_scan.h"
#include "io/surface/cloud_formats.h"

#include <strings.h>

/// What the first row of a file settles.
typedef struct csv_layout
{
    char separator;   ///< a comma, semicolon, tab, or a blank for any run of blanks
    size_t columns;   ///< of every row
    size_t places[3]; ///< the columns of x, y, z
    bool has_names;   ///< the first row holds names
} csv_layout;

/// A field of a row, without blanks and quotes around it.
typedef struct field
{
    const char *begin, *end;
} field;

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/// The field that begins at *at; *at goes to the next one, or to null after the last.
static field next_field(const char **at, const char *end, char separator)
{
    const char *stop = *at;
    while (stop < end && (separator == ' ' ? !is_blank(*stop) : *stop != separator))
        stop++;
    field found = {*at, stop};
    while (separator == ' ' && stop + 1 < end && is_blank(stop[1]))
        stop++;
    *at = stop < end ? stop + 1 : NULL;
    while (found.begin < found.end && is_blank(*found.begin))
        found.begin++;
    while (found.end > found.begin && is_blank(found.end[-1]))
        found.end--;
    if (found.end - found.begin >= 2 && *found.begin == '"' && found.end[-1] == '"')
        found = (field){found.begin + 1, found.end - 1};
    return found;
}

static char find_separator(const text_line *line)
{
    for (const char *candidate = ",;\t"; *candidate != '\0'; candidate++)
        if (memchr(line->begin, *candidate, (size_t)(line->end - line->begin)) != NULL)
            return *candidate;
    return ' ';
}

/// Find the columns from the first row: those named x, y, z when all three are there, else the first three.
static csv_layout find_layout(const text_line *line)
{
    static const char *const names[] = {"x", "y", "z"};
    csv_layout layout = {.separator = find_separator(line), .places = {0, 1, 2}, .has_names = true};
    size_t places[3] = {SIZE_MAX, SIZE_MAX, SIZE_MAX};
    for (const char *at = line->begin; at != NULL; layout.columns++)
    {
        field name = next_field(&at, line->end, layout.separator);
        layout.has_names = layout.has_names && !number_resembles(name.begin, name.end);
        for (size_t k = 0; k < 3; k++)
            if (name.end - name.begin == 1 && strncasecmp(name.begin, names[k], 1) == 0 && places[k] == SIZE_MAX)
                places[k] = layout.columns;
    }
    if (layout.has_names && places[0] != SIZE_MAX && places[1] != SIZE_MAX && places[2] != SIZE_MAX)
        memcpy(layout.places, places, sizeof places);
    return layout;
}

/// Read one of the three coordinates, where the column holds one.
static bat_status read_field(const csv_layout *layout, size_t column, field value, size_t index, size_t line, double *point,
                             bat_error *error)
{
    for (size_t k = 0; k < 3; k++)
    {
        if (layout->places[k] != column)
            continue;
        if (value.begin == value.end)
            return error_set(error, BAT_BAD_FILE, index, line, "column %zu is empty", column + 1);
        if (number_scan(value.begin, value.end, &point[k]) != value.end)
            return cloud_number_fault(value.begin, value.end, index, line, error);
    }
    return BAT_OK;
}

static bat_status read_row(const csv_layout *layout, const text_line *line, point_listing *listing, bat_error *error)
{
    size_t index = listing->count, column = 0;
    double *point = listing_next(listing);
    if (point == NULL)
        return error_memory(error, listing->capacity * sizeof *point);
    for (const char *at = line->begin; at != NULL; column++)
    {
        field value = next_field(&at, line->end, layout->separator);
        bat_status status = read_field(layout, column, value, index, line->number, point, error);
        if (status != BAT_OK)
            return status;
    }
    if (column != layout->columns)
        return error_set(error, BAT_BAD_FILE, index, line->number, "%zu columns where the first row has %zu", column,
                         layout->columns);
    return BAT_OK;
}

/// Go to the next row.
static bool next_row(const file_text *text, text_line *line)
{
    while (text_line_next(text, line))
        if (line->begin < line->end && *line->begin != '#')
            return true;
    return false;
}

bat_status cloud_csv_read(const file_text *text, point_listing *listing, bat_error *error)
{
    text_line line = text_line_start(text);
    bool more = next_row(text, &line);
    if (!more)
        return BAT_OK;
    csv_layout layout = find_layout(&line);
    if (layout.columns < 3)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line.number, "%zu columns, but a point has 3 coordinates",
                         layout.columns);
    bat_status status = BAT_OK;
    for (more = layout.has_names ? next_row(text, &line) : more; more && status == BAT_OK; more = next_row(text, &line))
        status = read_row(&layout, &line, listing, error);
    return status;
}

size_t cloud_csv_line_of_point(const file_text *text, size_t point)
{
    text_line line = text_line_start(text);
    bool more = next_row(text, &line);
    if (more && find_layout(&line).has_names)
        point++;
    while (more && point-- > 0)
        more = next_row(text, &line);
    return line.number;
}
