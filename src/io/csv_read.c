#include "base/error.h"
#include "io/csv_columns.h"
#include "io/curve_builder.h"
#include "io/curve_formats.h"
#include "io/degrees.h"

#include <string.h>
#include <strings.h>

typedef struct csv_reader
{
    const bat_read_options *options;
    bat_file_attributes *attributes;
    curve_builder builder;
    csv_field fields[BAT_SPACE_MAX_DIM];
    double numbers[BAT_SPACE_MAX_DIM]; ///< of a row, coordinates first
    size_t column_count;               ///< 0 before the first row
    size_t coordinate_count;
    char separator;                ///< a comma, semicolon, tab, or a blank for any run of blanks
    char space_name[EXCERPT_SIZE]; ///< what a directive says; empty without one
    bool closed;                   ///< what a directive says of the current curve
    bool begun;                    ///< a row of numbers was read
} csv_reader;

static bat_status bad_row(bat_error *error, const text_line *line, const char *what)
{
    return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "%s", what);
}

static csv_field trim(const char *begin, const char *end)
{
    while (begin < end && (*begin == ' ' || *begin == '\t'))
        begin++;
    while (end > begin && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    return (csv_field){begin, end};
}

static char find_separator(const text_line *line)
{
    size_t length = (size_t)(line->end - line->begin);
    for (const char *candidate = ",;\t"; *candidate != '\0'; candidate++)
        if (memchr(line->begin, *candidate, length) != NULL)
            return *candidate;
    return ' ';
}

/// Where the field that begins at `at` ends.
static const char *field_end(const char *at, const char *end, char separator)
{
    if (separator != ' ')
    {
        const char *found = memchr(at, separator, (size_t)(end - at));
        return found != NULL ? found : end;
    }
    while (at < end && *at != ' ' && *at != '\t')
        at++;
    return at;
}

static bat_status split(csv_reader *reader, const text_line *line, size_t *count, bat_error *error)
{
    const char *at = line->begin;
    for (*count = 0;;)
    {
        const char *end = field_end(at, line->end, reader->separator);
        if (*count == BAT_SPACE_MAX_DIM)
            return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "more than %d columns", BAT_SPACE_MAX_DIM);
        reader->fields[(*count)++] = trim(at, end);
        if (end == line->end)
            return BAT_OK;
        at = end + 1;
        while (reader->separator == ' ' && (*at == ' ' || *at == '\t'))
            at++;
    }
}

static bool is_header(const csv_reader *reader, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (number_resembles(reader->fields[i].begin, reader->fields[i].end))
            return false;
    return true;
}

/// Null when a field can be the name of a column.
static const char *name_fault(const csv_field *field)
{
    static const char mark[] = "\xEF\xBB\xBF";
    size_t length = (size_t)(field->end - field->begin);
    if (length == 0)
        return "has no name";
    if (memchr(field->begin, '\0', length) != NULL)
        return "has a zero byte";
    if (length >= sizeof mark - 1 && memcmp(field->begin, mark, sizeof mark - 1) == 0)
        return "has a byte order mark";
    return NULL;
}

static bat_status read_header(csv_reader *reader, const text_line *line, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        const char *fault = name_fault(&reader->fields[i]);
        if (fault != NULL)
            return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "column %zu of the header %s", i + 1, fault);
    }
    if (!csv_columns_name(&reader->attributes->csv, reader->fields, count))
        return error_memory(error, count);
    reader->column_count = count;
    return BAT_OK;
}

/// Decide on the space, now that the columns are known.
static bat_status choose_space(csv_reader *reader, const text_line *line, bat_error *error)
{
    csv_columns *columns = &reader->attributes->csv;
    const char *name = reader->options->space;
    if (name == NULL && reader->space_name[0] != '\0')
        name = reader->space_name;
    size_t count = reader->column_count;
    size_t longitude, latitude;
    bool sphere = name != NULL && strcmp(name, "sphere") == 0;
    if ((name == NULL || sphere) && csv_columns_geographic(columns, &longitude, &latitude))
    {
        if (!csv_columns_use_degrees(columns, longitude, latitude))
            return error_memory(error, count * sizeof(size_t));
        reader->coordinate_count = 2;
        reader->builder.check = false;
        reader->builder.space = bat_sphere(2);
        return BAT_OK;
    }
    if (sphere && count < 3)
        return bad_row(error, line, "a point of the sphere needs 3 or more columns, or a header with lon and lat");
    if (name == NULL)
        name = count == 2 ? "plane" : "euclidean";
    bool two = strcmp(name, "plane") == 0 || strcmp(name, "disk") == 0;
    if (two && count < 2)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "a point of the %s needs 2 columns", name);
    reader->coordinate_count = two ? 2 : count;
    return bat_space_by_name(name, reader->coordinate_count, &reader->builder.space, error);
}

static bat_status read_numbers(csv_reader *reader, const text_line *line, bat_error *error)
{
    const size_t *places = reader->attributes->csv.places;
    for (size_t i = 0; i < reader->column_count; i++)
    {
        const csv_field *field = &reader->fields[i];
        char excerpt[EXCERPT_SIZE];
        const char *fault = field->begin == field->end
                                ? "is empty"
                                : number_read(field->begin, field->end, &reader->numbers[places != NULL ? places[i] : i]);
        if (fault != NULL)
            return error_set(error, BAT_BAD_FILE, reader->builder.point_count, line->number, "column %zu: '%s' %s", i + 1,
                             text_excerpt(excerpt, field->begin, field->end), fault);
    }
    return BAT_OK;
}

static bat_status read_row(csv_reader *reader, const text_line *line, size_t count, bat_error *error)
{
    curve_builder *builder = &reader->builder;
    if (count != reader->column_count)
        return error_set(error, BAT_BAD_FILE, builder->point_count, line->number, "%zu columns where the first row has %zu",
                         count, reader->column_count);
    bat_status status = read_numbers(reader, line, error);
    if (status != BAT_OK)
        return status;
    size_t coordinates = reader->coordinate_count;
    double *channels;
    double *point = builder_next(builder, count - coordinates, &channels);
    if (point == NULL || !builder_line(builder, line->number))
        return error_memory(error, builder->point_capacity * sizeof(double));
    bool degrees = reader->attributes->csv.degrees;
    const char *fault = degrees ? degrees_fault(reader->numbers[0], reader->numbers[1]) : NULL;
    if (fault != NULL)
        return error_set(error, BAT_BAD_FILE, builder->point_count, line->number, "%s", fault);
    if (degrees)
        degrees_to_point(reader->numbers[0], reader->numbers[1], point);
    else
        memcpy(point, reader->numbers, coordinates * sizeof *point);
    if (count > coordinates)
        memcpy(channels, reader->numbers + coordinates, (count - coordinates) * sizeof *channels);
    size_t index = builder->point_count;
    fault = builder_admit(builder);
    if (fault != NULL)
        return error_set(error, BAT_BAD_FILE, index, line->number, "the point is %s", fault);
    return BAT_OK;
}

/// Obey a comment that begins with "space". Without a colon it is one only when it names a space and says nothing else.
static bat_status read_space(csv_reader *reader, const text_line *line, const char *rest, const char *end, bat_error *error)
{
    char name[EXCERPT_SIZE];
    bat_space unused;
    bool colon = *rest == ':';
    csv_field words = trim(rest + colon, end);
    (void)text_excerpt(name, words.begin, words.end);
    if (bat_space_by_name(name, 0, &unused, NULL) != BAT_OK)
        return colon ? error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "there is no space '%s'", name) : BAT_OK;
    if (reader->begun && strcmp(name, reader->space_name) != 0)
        return bad_row(error, line, "the space is named after the first row");
    memcpy(reader->space_name, name, sizeof name);
    return BAT_OK;
}

/// Obey a comment that is "closed", "open" or "space: NAME", in either case.
static bat_status read_comment(csv_reader *reader, const text_line *line, bat_error *error)
{
    static const char space[] = "space";
    const size_t space_length = sizeof space - 1;
    csv_field words = trim(line->begin + 1, line->end);
    size_t length = (size_t)(words.end - words.begin);
    if (length == 6 && strncasecmp(words.begin, "closed", length) == 0)
        reader->closed = true;
    else if (length == 4 && strncasecmp(words.begin, "open", length) == 0)
        reader->closed = false;
    else if (length > space_length && strncasecmp(words.begin, space, space_length) == 0 &&
             strchr(": \t", words.begin[space_length]) != NULL)
        return read_space(reader, line, words.begin + space_length, words.end, error);
    return BAT_OK;
}

static bat_status end_curve(csv_reader *reader, bat_error *error)
{
    curve_builder *builder = &reader->builder;
    if (builder->point_count == 0)
        return BAT_OK;
    int wanted = reader->options->closed;
    bool closed = wanted < 0 ? reader->closed : wanted > 0;
    while (closed && builder_returns(builder))
        builder_drop_last(builder);
    reader->closed = false;
    return builder_end_curve(builder, closed) ? BAT_OK : error_memory(error, builder->point_count * sizeof(double));
}

static bat_status read_line(csv_reader *reader, const text_line *line, bat_error *error)
{
    if (line->begin == line->end)
        return end_curve(reader, error);
    if (*line->begin == '#')
        return read_comment(reader, line, error);
    if (reader->separator == '\0')
        reader->separator = find_separator(line);
    size_t count;
    bat_status status = split(reader, line, &count, error);
    if (status != BAT_OK)
        return status;
    if (reader->column_count == 0 && is_header(reader, count))
        return read_header(reader, line, count, error);
    if (!reader->begun)
    {
        reader->begun = true;
        if (reader->column_count == 0)
            reader->column_count = count;
        status = choose_space(reader, line, error);
    }
    return status == BAT_OK ? read_row(reader, line, count, error) : status;
}

static bat_status read_text(csv_reader *reader, const file_text *text, bat_error *error)
{
    text_line line = text_line_start(text);
    while (text_line_next(text, &line))
    {
        bat_status status = read_line(reader, &line, error);
        if (status != BAT_OK)
            return status;
    }
    bat_status status = end_curve(reader, error);
    if (status == BAT_OK && reader->builder.curve_count == 0)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line.number, "there are no points");
    return status;
}

bat_status csv_read(const file_text *text, const bat_read_options *options, bat_curve_set *set, bat_error *error)
{
    csv_reader *reader = calloc(1, sizeof *reader);
    if (reader == NULL)
        return error_memory(error, sizeof *reader);
    reader->options = options;
    reader->builder.project = options->project;
    reader->builder.check = true;
    reader->attributes = attributes_new(BAT_FORMAT_CSV);
    bat_status status = reader->attributes != NULL ? read_text(reader, text, error) : error_memory(error, sizeof *reader);
    if (status == BAT_OK)
        status = builder_finish(&reader->builder, reader->attributes, set, error);
    else
    {
        builder_free(&reader->builder);
        attributes_release(reader->attributes);
    }
    free(reader);
    return status;
}
