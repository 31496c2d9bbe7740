#include "base/error.h"
#include "curve/csv_columns.h"
#include "io/common/number_text.h"
#include "io/curve/builder.h"
#include "io/curve/formats.h"
#include "space/degrees.h"

#include <string.h>
#include <strings.h>

/// @file
/// Reader of CSV and of trajectories in the TUM format: rows of numbers, an optional header, and directives in comments.

enum
{
    /// timestamp tx ty tz qx qy qz qw
    TUM_COLUMNS = 8
};

typedef struct csv_reader
{
    const bat_curve_read_options *options;
    bat_curve_attributes *attributes;
    curve_builder builder;
    csv_field fields[BAT_SPACE_MAX_DIM];
    double numbers[BAT_SPACE_MAX_DIM]; ///< of a row, coordinates first
    size_t column_count;               ///< 0 before the first row
    size_t coordinate_count;
    char separator;                ///< a comma, semicolon or tab, or a blank for runs of blanks
    char space_name[EXCERPT_SIZE]; ///< from a directive; empty without one
    bool closed;                   ///< from a directive for the current curve
    size_t header_line;            ///< 0 without a header
    size_t time_channel;           ///< BAT_NO_INDEX without times
    bool motion;                   ///< has times or velocities: repeated points stay
    bool begun;                    ///< a row of numbers was read
    bool unnamed_tum;              ///< a CSV file contains rows of a trajectory without a header
    bool tum;                      ///< the TUM format: blank lines, headers and directives have no meaning
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

/// The end of the field that begins at `at`.
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

/// Null for a valid name of a column, else an error text.
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

/// Find the column of corners in a header, and take it out of the fields. Returns the number of those that are left.
static size_t take_corner_column(csv_reader *reader, size_t count)
{
    static const char name[] = "corner";
    const size_t length = sizeof name - 1;
    for (size_t i = 0; i < count; i++)
    {
        csv_field *field = &reader->fields[i];
        size_t quotes = field->end > field->begin && *field->begin == '"';
        if ((size_t)(field->end - field->begin) != length + 2 * quotes ||
            strncasecmp(field->begin + quotes, name, length) != 0)
            continue;
        memmove(field, field + 1, (count - i - 1) * sizeof *field);
        reader->attributes->csv.corner = i;
        return count - 1;
    }
    return count;
}

static bat_status read_header(csv_reader *reader, const text_line *line, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        const char *fault = name_fault(&reader->fields[i]);
        if (fault != NULL)
            return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "column %zu of the header %s", i + 1, fault);
    }
    count = take_corner_column(reader, count);
    if (count == 0)
        return bad_row(error, line, "there are no columns beside that of the corners");
    if (!csv_columns_name(&reader->attributes->csv, reader->fields, count))
        return error_memory(error, count);
    reader->column_count = count;
    reader->header_line = line->number;
    return BAT_OK;
}

/// Name the columns of the TUM format as a CSV header would.
static bool name_tum_columns(csv_reader *reader)
{
    static const char *const names[TUM_COLUMNS] = {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"};
    csv_field fields[TUM_COLUMNS];
    for (size_t i = 0; i < TUM_COLUMNS; i++)
        fields[i] = (csv_field){names[i], names[i] + strlen(names[i])};
    reader->column_count = TUM_COLUMNS;
    return csv_columns_name(&reader->attributes->csv, fields, TUM_COLUMNS);
}

/// Whether the names of columns imply a form. Without a named space, names of quaternions and matrices do; those of flat
/// spaces only matter with times or velocities.
static bool is_implied(const csv_reader *reader, const point_form *form, bool named)
{
    motion_channels channels;
    if (form->strict)
        return named || form->rotation == ROTATION_QUATERNION || form->rotation == ROTATION_MATRIX;
    csv_columns_channels(&reader->attributes->csv, 0, form, &channels);
    return channels.time != BAT_NO_INDEX || channels.velocity_count > 0;
}

/// The form of the points in a space, which may be null; null for plain coordinates.
static const point_form *find_form(const csv_reader *reader, const char *space, const column_names *names)
{
    static const char *const unnamed[] = {"rigid", "rotation", "euclidean", "plane"};
    const char *const *candidates = space != NULL ? &space : unnamed;
    size_t count = space != NULL ? 1 : names->names != NULL ? sizeof unnamed / sizeof *unnamed : 0;
    for (size_t i = 0; i < count; i++)
    {
        const point_form *form = point_form_find(candidates[i], names);
        bool by_name = form != NULL && column_find(names, form->names[0]) != BAT_NO_INDEX;
        if (form != NULL && (space != NULL || by_name) && is_implied(reader, form, space != NULL))
            return form;
    }
    return NULL;
}

static bat_status use_form(csv_reader *reader, const point_form *form, bat_error *error)
{
    if (!csv_columns_use_form(&reader->attributes->csv, form))
        return error_memory(error, reader->column_count * sizeof(size_t));
    size_t dim = form->rotation == ROTATION_NONE ? form->count : form->rotation_at + 4;
    reader->coordinate_count = form->count;
    return bat_space_by_name(form->space, dim, &reader->builder.space, error);
}

static bat_status use_degrees(csv_reader *reader, size_t longitude, size_t latitude, bat_error *error)
{
    if (!csv_columns_use_degrees(&reader->attributes->csv, longitude, latitude))
        return error_memory(error, reader->column_count * sizeof(size_t));
    reader->coordinate_count = 2;
    reader->builder.check = false;
    reader->builder.space = bat_sphere(2);
    return BAT_OK;
}

/// Use the first two columns or all columns as coordinates.
static bat_status use_coordinates(csv_reader *reader, const text_line *line, const char *name, bat_error *error)
{
    size_t count = reader->column_count;
    if (strcmp(name, "sphere") == 0 && count < 3)
        return bad_row(error, line, "a point of the sphere needs 3 or more columns, or a header with lon and lat");
    bool two = strcmp(name, "plane") == 0 || strcmp(name, "disk") == 0;
    if (two && count < 2)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "a point of the %s needs 2 columns", name);
    bat_space any;
    reader->coordinate_count = two ? 2 : count;
    bat_status status = bat_space_by_name(name, 0, &any, error);
    if (status != BAT_OK)
        return status;
    status = bat_space_by_name(name, reader->coordinate_count, &reader->builder.space, error);
    return status == BAT_OK ? status
                            : error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number,
                                        "%zu columns are not a point of the space %s", count, name);
}

/// Find the times among the channels.
static void find_times(csv_reader *reader)
{
    motion_channels channels;
    csv_columns_channels(&reader->attributes->csv, reader->coordinate_count, NULL, &channels);
    reader->time_channel = channels.time;
    csv_columns_channels(&reader->attributes->csv, reader->coordinate_count, reader->attributes->csv.form, &channels);
    reader->motion = channels.time != BAT_NO_INDEX || channels.velocity_count > 0;
}

/// Choose the space from the options, the directives and the columns.
static bat_status choose_space(csv_reader *reader, const text_line *line, bat_error *error)
{
    const csv_columns *columns = &reader->attributes->csv;
    const char *name = reader->options->space;
    if (name == NULL && reader->space_name[0] != '\0')
        name = reader->space_name;
    size_t longitude, latitude;
    if ((name == NULL || strcmp(name, "sphere") == 0) && csv_columns_geographic(columns, &longitude, &latitude))
        return use_degrees(reader, longitude, latitude, error);
    bool trajectory = name != NULL && strcmp(name, "rigid") == 0 && reader->column_count == TUM_COLUMNS;
    if (trajectory && columns->names == NULL)
    {
        reader->unnamed_tum = true;
        if (!name_tum_columns(reader))
            return error_memory(error, TUM_COLUMNS * sizeof(char *));
    }
    column_names names = {columns->names, reader->column_count};
    const point_form *form = find_form(reader, name, &names);
    char fault[BAT_ERROR_TEXT_SIZE];
    if (name == NULL && point_form_incomplete(form, &names, fault, sizeof fault))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, reader->header_line, "%s", fault);
    if (name == NULL && form != NULL)
        name = form->space;
    if (name != NULL && point_form_fault(name, form, &names, fault, sizeof fault))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, reader->header_line, "%s", fault);
    if (form != NULL)
        return use_form(reader, form, error);
    return use_coordinates(reader, line, name != NULL ? name : names.count == 2 ? "plane" : "euclidean", error);
}

/// Whether a row is of a corner: 0 or 1 in the column of the corners, which is taken out of the fields.
static bat_status read_corner(csv_reader *reader, const text_line *line, bool *corner, bat_error *error)
{
    size_t column = reader->attributes->csv.corner;
    csv_field *field = &reader->fields[column], given = *field;
    char excerpt[EXCERPT_SIZE];
    double value = 0;
    const char *fault = given.begin == given.end ? "is empty" : number_read(given.begin, given.end, &value);
    if (fault != NULL || (value != 0 && value != 1))
        return error_set(error, BAT_BAD_FILE, reader->builder.point_count, line->number, "column %zu: '%s' %s", column + 1,
                         text_excerpt(excerpt, given.begin, given.end),
                         fault != NULL ? fault : "is not 0 or 1, as a corner must be");
    memmove(field, field + 1, (reader->column_count - column) * sizeof *field);
    *corner = value != 0;
    return BAT_OK;
}

static bat_status read_numbers(csv_reader *reader, const text_line *line, bat_error *error)
{
    const size_t *places = reader->attributes->csv.places;
    size_t corner = reader->attributes->csv.corner;
    for (size_t i = 0; i < reader->column_count; i++)
    {
        const csv_field *field = &reader->fields[i];
        char excerpt[EXCERPT_SIZE];
        const char *fault = field->begin == field->end
                                ? "is empty"
                                : number_read(field->begin, field->end, &reader->numbers[places != NULL ? places[i] : i]);
        if (fault != NULL)
            return error_set(error, BAT_BAD_FILE, reader->builder.point_count, line->number, "column %zu: '%s' %s",
                             i + 1 + (i >= corner), text_excerpt(excerpt, field->begin, field->end), fault);
    }
    return BAT_OK;
}

static bat_status read_row(csv_reader *reader, const text_line *line, size_t count, bat_error *error)
{
    curve_builder *builder = &reader->builder;
    bool has_corner = reader->attributes->csv.corner != BAT_NO_INDEX, corner = false;
    size_t column_count = reader->column_count + has_corner;
    if (count != column_count && reader->tum)
        return error_set(error, BAT_BAD_FILE, builder->point_count, line->number, "%zu columns where a trajectory has %d",
                         count, TUM_COLUMNS);
    if (count != column_count)
        return error_set(error, BAT_BAD_FILE, builder->point_count, line->number, "%zu columns where the first row has %zu",
                         count, column_count);
    count = reader->column_count;
    bat_status status = has_corner ? read_corner(reader, line, &corner, error) : BAT_OK;
    if (status == BAT_OK)
        status = read_numbers(reader, line, error);
    if (status != BAT_OK)
        return status;
    size_t coordinates = reader->coordinate_count;
    double *channels;
    double *point = builder_next(builder, count - coordinates, &channels);
    if (point == NULL || !builder_line(builder, line->number) || (has_corner && !builder_corner(builder, corner)))
        return error_memory(error, builder->point_capacity * sizeof(double));
    bool degrees = reader->attributes->csv.degrees;
    const point_form *form = reader->attributes->csv.form;
    const char *fault = degrees ? degrees_fault(reader->numbers[0], reader->numbers[1]) : NULL;
    if (fault != NULL)
        return error_set(error, BAT_BAD_FILE, builder->point_count, line->number, "%s", fault);
    if (degrees)
        degrees_to_point(reader->numbers[0], reader->numbers[1], point);
    else if (form != NULL)
        fault = point_form_read(form, reader->numbers, builder->project, point);
    else
        memcpy(point, reader->numbers, coordinates * sizeof *point);
    if (fault != NULL)
        return error_set(error, BAT_BAD_FILE, builder->point_count, line->number, "%s", fault);
    if (count > coordinates)
        memcpy(channels, reader->numbers + coordinates, (count - coordinates) * sizeof *channels);
    size_t index = builder->point_count;
    fault = builder_admit(builder);
    if (fault != NULL)
        return error_set(error, BAT_BAD_FILE, index, line->number, "the point is %s", fault);
    bool dropped;
    fault = reader->motion ? NULL : builder_drop_repeat(builder, false, &dropped);
    if (fault != NULL)
        return error_set(error, BAT_BAD_FILE, index, line->number, "curve %zu, point %zu: %s", builder->curve_count, index,
                         fault);
    return BAT_OK;
}

/// Apply a comment that begins with "space". Without a colon it counts only if it names a space and nothing else.
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
        return bad_row(error, line, "the space must be named before the first row");
    memcpy(reader->space_name, name, sizeof name);
    return BAT_OK;
}

/// Apply a comment "closed", "open" or "space: NAME", in upper or lower case.
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

/// Times increase strictly along a curve. Those of a closed one may fall again at its end, where refinement puts points
/// between the last time and the first.
static bat_status check_times(const csv_reader *reader, bool closed, bat_error *error)
{
    const curve_builder *builder = &reader->builder;
    const size_t *lines = builder->lines + (builder->line_count - builder->point_count);
    bool falls = false;
    for (size_t i = 1; i < builder->point_count && reader->time_channel != BAT_NO_INDEX; i++)
    {
        const double *row = builder->channels + i * builder->channel_count + reader->time_channel;
        double time = row[0], before = *(row - builder->channel_count);
        falls = falls || (closed && i > 1 && time < before);
        if (!(falls ? time < before : time > before))
            return error_set(error, BAT_BAD_FILE, i, lines[i], "the time %.15g does not come after %.15g", time, before);
    }
    return BAT_OK;
}

static bat_status end_curve(csv_reader *reader, bat_error *error)
{
    curve_builder *builder = &reader->builder;
    if (builder->point_count == 0)
        return BAT_OK;
    int wanted = reader->options->closed;
    bool closed = wanted < 0 ? reader->closed : wanted > 0;
    builder_continue_signs(builder);
    while (closed && builder_returns(builder))
        builder_drop_last(builder);
    bool dropped = closed && !reader->motion;
    while (dropped)
    {
        size_t index = builder->point_count - 1, last_line = builder->lines[builder->line_count - 1];
        const char *fault = builder_drop_repeat(builder, true, &dropped);
        if (fault != NULL)
            return error_set(error, BAT_BAD_FILE, index, last_line, "curve %zu, point %zu: %s", builder->curve_count, index,
                             fault);
    }
    reader->closed = false;
    bat_status status = check_times(reader, closed, error);
    if (status != BAT_OK)
        return status;
    return builder_end_curve(builder, closed) ? BAT_OK : error_memory(error, builder->point_count * sizeof(double));
}

static bat_status read_line(csv_reader *reader, const text_line *line, bat_error *error)
{
    if (line->begin == line->end)
        return reader->tum ? BAT_OK : end_curve(reader, error);
    if (*line->begin == '#')
        return reader->tum ? BAT_OK : read_comment(reader, line, error);
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
        find_times(reader);
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

static bat_status read_as(bat_curve_format format, const file_text *text, const bat_curve_read_options *options,
                          bat_curve_set *set, bat_error *error)
{
    csv_reader *reader = calloc(1, sizeof *reader);
    if (reader == NULL)
        return error_memory(error, sizeof *reader);
    reader->options = options;
    reader->builder.project = options->project;
    reader->builder.strict = options->strict;
    reader->builder.check = true;
    reader->attributes = attributes_new(format);
    reader->tum = format == BAT_CURVE_FORMAT_TUM;
    bool ready = reader->attributes != NULL && (!reader->tum || name_tum_columns(reader));
    bat_status status = ready ? read_text(reader, text, error) : error_memory(error, sizeof *reader);
    const curve_builder *builder = &reader->builder;
    if (status == BAT_OK && !builder_note_repeats(builder, reader->attributes))
        status = error_memory(error, sizeof *reader);
    if (status == BAT_OK && reader->unnamed_tum && builder->curve_count == 1 && !builder->curves[0].closed)
        reader->attributes->format = BAT_CURVE_FORMAT_TUM;
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

bat_status csv_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    return read_as(BAT_CURVE_FORMAT_CSV, text, options, set, error);
}

bat_status tum_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_curve_read_options rigid = *options;
    if (options->space != NULL && strcmp(options->space, "rigid") != 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a TUM trajectory is in the space rigid, not %.60s",
                         options->space);
    rigid.space = "rigid";
    return read_as(BAT_CURVE_FORMAT_TUM, text, &rigid, set, error);
}
