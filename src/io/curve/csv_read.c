#include "io/curve/csv.h"

#include "io/common/time_text.h"
#include "space/degrees.h"

#include <strings.h>

/// @file
/// Reader of CSV and of trajectories in the TUM format: rows of numbers, an optional header, and directives in comments.

static bat_status split(csv_reader *reader, const text_line *line, size_t *count, bat_error *error)
{
    const char *fault = csv_split(reader->text, line, reader->separator, reader->fields, count);
    return fault == NULL ? BAT_OK : ERROR_FILE(error, line->number, "%s", fault);
}

static bool is_header(const csv_reader *reader, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (number_resembles(reader->fields[i].begin, reader->fields[i].end))
            return false;
    return true;
}

/// Whether all fields of a row are empty, as those of a blank row in a spreadsheet.
static bool is_empty_row(const csv_reader *reader, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (reader->fields[i].begin != reader->fields[i].end)
            return false;
    return true;
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
        reader->attributes->csv->corner = i;
        return count - 1;
    }
    return count;
}

static bat_status read_header(csv_reader *reader, const text_line *line, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        const char *fault = csv_field_fault(reader->fields[i]);
        if (fault != NULL)
            return ERROR_FILE(error, line->number, "column %zu of the header %s", i + 1, fault);
    }
    count = take_corner_column(reader, count);
    if (count == 0)
        return ERROR_FILE(error, line->number, "there are no columns beside that of the corners");
    if (!csv_columns_name(reader->attributes->csv, reader->fields, count))
        return error_memory(error, count);
    reader->column_count = count;
    reader->header_line = line->number;
    return BAT_OK;
}

/// Whether a row is of a corner: 0 or 1 in the column of the corners, which is taken out of the fields.
static bat_status read_corner(csv_reader *reader, const text_line *line, bool *corner, bat_error *error)
{
    size_t column = reader->attributes->csv->corner;
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

/// The unit of the times of a motion: that of the option, of the name, or by the size of the first time.
static int choose_time_decimals(csv_reader *reader, csv_field first)
{
    const bat_time_unit unit = reader->options->time_unit;
    if (!reader->options->motion)
        return 0;
    if (unit != BAT_TIME_UNIT_AUTO)
        return 3 * ((int)unit - (int)BAT_TIME_UNIT_SECONDS);
    reader->time_by_size = reader->time_decimals < 0;
    return reader->time_by_size ? exact_time_decimals(first.begin, first.end) : reader->time_decimals;
}

/// Read a time that is a date, that has more digits than a double, or that counts parts of seconds. The first one sets the
/// origin and the form of all. False for other times.
static bool read_time(csv_reader *reader, size_t column, double *seconds)
{
    static const int PLAIN = 9; // characters of a time that a double holds far below a nanosecond
    iso_time date;
    int64_t nanoseconds;
    bat_curve_attributes *attributes = reader->attributes;
    csv_field field = csv_unquoted(reader->fields[column]);
    bool first = reader->row_count == 0;
    bool dated = csv_takes_dates(reader, column) && iso_time_read(field.begin, field.end, &date);
    if (first && !dated)
        attributes->time_decimals = choose_time_decimals(reader, field);
    int decimals = attributes->time_decimals;
    if (dated)
    {
        nanoseconds = date.nanoseconds;
        if (first)
            (void)snprintf(attributes->time_text, sizeof attributes->time_text, "%.*s", (int)(field.end - field.begin),
                           field.begin);
    }
    else if (((!first && attributes->time_origin == 0) || field.end - field.begin <= (first ? PLAIN : 0)) && decimals == 0)
        return false;
    else if (!exact_time_read(field.begin, field.end, decimals, &nanoseconds))
    {
        if (decimals == 0 || number_read(field.begin, field.end, seconds) != NULL)
            return false;
        *seconds = *seconds / (double)number_power_of_ten(decimals) - (double)attributes->time_origin;
        return true;
    }
    if (first)
        attributes->time_origin = exact_time_origin(nanoseconds);
    *seconds = exact_time_since(nanoseconds, attributes->time_origin);
    return true;
}

/// Whether a field is a whole number beyond those that doubles hold exactly.
static bool is_long(csv_field field)
{
    static const double EXACT = 9007199254740992;
    double value;
    field = csv_unquoted(field);
    const char *digits = field.begin + (field.begin < field.end && strchr("+-", *field.begin) != NULL);
    return digits + strspn(digits, "0123456789") >= field.end && number_read(field.begin, field.end, &value) == NULL &&
           fabs(value) >= EXACT;
}

static bat_status read_numbers(csv_reader *reader, const text_line *line, bat_error *error)
{
    const csv_columns *columns = reader->attributes->csv;
    for (size_t i = 0; i < reader->column_count; i++)
    {
        const csv_field *field = &reader->fields[i];
        column_state *state = &reader->columns[i];
        size_t place = columns->places != NULL ? columns->places[i] : i;
        if (place == BAT_NO_INDEX)
            continue;
        bool timed = reader->time_channel != BAT_NO_INDEX && place == reader->coordinate_count + reader->time_channel;
        const char *fault = NULL;
        if (field->begin == field->end)
            fault = "is empty";
        else if (!timed || !read_time(reader, i, &reader->numbers[place]))
            fault = number_read(field->begin, field->end, &reader->numbers[place]);
        if (fault != NULL)
            fault = csv_read_number(*field, reader->separator, &reader->numbers[place], &reader->comma);
        if (fault != NULL && !csv_change_kind(reader, i))
        {
            char excerpt[EXCERPT_SIZE];
            bool others = reader->attributes->csv->names != NULL && !reader->strict && !reader->tum;
            (void)error_set(error, BAT_BAD_FILE, reader->builder.point_count, line->number, "column %zu: '%s' %s",
                            csv_column_number(reader, i), text_excerpt(excerpt, field->begin, field->end), fault);
            return others ? error_remedy(error, BAT_BAD_FILE, "columns", "chooses the columns of the coordinates")
                          : BAT_BAD_FILE;
        }
        if (fault == NULL && state->kind == CSV_NUMBER && !state->is_coordinate && is_long(*field) &&
            !reader->options->motion)
            (void)csv_change_kind(reader, i);
        state->has_number = state->has_number || fault == NULL;
        if (state->is_watched && fault == NULL)
        {
            csv_watch_cell(reader, line, i);
            state->not_whole = state->not_whole || reader->numbers[place] != floor(reader->numbers[place]);
        }
    }
    return BAT_OK;
}

/// Check the number of fields in a row. Empty fields at its end do not count.
static bat_status check_width(const csv_reader *reader, const text_line *line, size_t count, bat_error *error)
{
    size_t wanted = reader->column_count + reader->left_count + (reader->attributes->csv->corner != BAT_NO_INDEX ? 1 : 0);
    while (count > wanted && reader->fields[count - 1].begin == reader->fields[count - 1].end)
        count--;
    if (count == wanted)
        return BAT_OK;
    if (reader->tum)
        return error_set(error, BAT_BAD_FILE, reader->builder.point_count, line->number,
                         "%zu columns where a trajectory has %zu", count, wanted);
    return error_set(error, BAT_BAD_FILE, reader->builder.point_count, line->number,
                     "%zu columns where the first row has %zu", count, wanted);
}

/// Set the point of a row. Returns null or an error text.
static const char *make_point(csv_reader *reader, double *point)
{
    static const double DEGREES = 57.295779513082320876798154814105;
    const csv_columns *columns = reader->attributes->csv;
    double *numbers = reader->numbers;
    if (!columns->degrees)
    {
        if (columns->form != NULL)
            return point_form_read(columns->form, numbers, reader->builder.project, point);
        memcpy(point, numbers, reader->coordinate_count * sizeof *point);
        return NULL;
    }
    for (size_t i = 0; i < 2 && columns->radians; i++)
        numbers[i] *= DEGREES;
    const char *fault = degrees_fault(numbers[0], numbers[1]);
    if (fault == NULL)
        degrees_to_point(numbers[0], numbers[1], point);
    return fault;
}

/// Fail for a point that make_point() does not make.
static bat_status refuse_point(csv_reader *reader, const char *fault, const text_line *line, double *point, bat_error *error)
{
    const csv_columns *columns = reader->attributes->csv;
    bat_status status = error_set(error, BAT_BAD_FILE, reader->builder.point_count, line->number, "%s", fault);
    if (columns->degrees)
        return error_remedy(error, status, "space", "plane takes plane coordinates");
    bool helps = !reader->builder.project && point_form_read(columns->form, reader->numbers, true, point) == NULL;
    return helps ? error_remedy(error, status, "project", "moves points onto the space") : status;
}

/// Whether the last point has the time of the one before it.
static bool repeats_time(const csv_reader *reader)
{
    const curve_builder *builder = &reader->builder;
    if (reader->time_channel == BAT_NO_INDEX || builder->point_count < 2)
        return false;
    const double *row = builder->channels + (builder->point_count - 1) * builder->channel_count + reader->time_channel;
    return row[0] == *(row - builder->channel_count);
}

static bat_status read_row(csv_reader *reader, const text_line *line, size_t count, bat_error *error)
{
    curve_builder *builder = &reader->builder;
    bool has_corner = reader->attributes->csv->corner != BAT_NO_INDEX, corner = false;
    bat_status status = check_width(reader, line, count, error);
    if (status == BAT_OK && has_corner)
        status = read_corner(reader, line, &corner, error);
    bool leaves = reader->options->motion && !reader->options->strict;
    if (status == BAT_OK && !reader->begun && leaves && !csv_leave_columns(reader))
        status = error_memory(error, reader->column_count);
    csv_drop_left(reader);
    if (status == BAT_OK && !reader->begun)
    {
        reader->begun = true;
        status = csv_choose(reader, line, error);
        motion_channels channels;
        csv_columns_channels(reader->attributes->csv, reader->coordinate_count, NULL, &channels);
        reader->time_channel = channels.time;
        csv_columns_channels(reader->attributes->csv, reader->coordinate_count, reader->attributes->csv->form, &channels);
        reader->motion = channels.time != BAT_NO_INDEX || channels.velocity_count > 0;
    }
    if (status == BAT_OK)
        status = read_numbers(reader, line, error);
    if (status == BAT_OK)
        status = csv_take_cells(reader, line, error);
    if (status != BAT_OK || reader->again)
        return status;
    bool has_places = reader->attributes->csv->has_places;
    size_t coordinates = reader->coordinate_count, channel_count = reader->number_count - coordinates;
    double *channels;
    double *point = builder_next(builder, channel_count + (has_places ? CSV_PLACE_CHANNELS : 0), &channels);
    if (point == NULL || !builder_line(builder, line->number) || (has_corner && !builder_corner(builder, corner)))
        return error_memory(error, builder->point_capacity * sizeof(double));
    const char *fault = make_point(reader, point);
    if (fault != NULL)
        return refuse_point(reader, fault, line, point, error);
    if (channel_count > 0)
        memcpy(channels, reader->numbers + coordinates, channel_count * sizeof *channels);
    for (size_t i = 0; i < CSV_PLACE_CHANNELS && has_places; i++)
        channels[channel_count + i] = 0; // until the curve's length is known
    size_t index = builder->point_count;
    reader->row_count++;
    fault = builder_admit(builder);
    if (fault != NULL)
        return builder_refuse(builder, error_set(error, BAT_BAD_FILE, index, line->number, "the point is %s", fault), error);
    bool dropped = false;
    if (leaves && repeats_time(reader))
    {
        reader->left_rows++;
        reader->first_left_row = reader->left_rows == 1 ? line->number : reader->first_left_row;
        builder_drop_last(builder);
        dropped = true;
    }
    fault = reader->motion ? NULL : builder_drop_repeat(builder, false, &dropped);
    if (dropped && reader->cells.columns > 0)
        cells_drop_row(&reader->cells);
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
    csv_field words = csv_trimmed(rest + colon, end);
    (void)text_excerpt(name, words.begin, words.end);
    if (bat_space_by_name(name, 0, &unused, NULL) != BAT_OK)
        return colon ? ERROR_FILE(error, line->number, "there is no space '%s'", name) : BAT_OK;
    if (reader->begun && strcmp(name, reader->space_name) != 0)
        return ERROR_FILE(error, line->number, "the space must be named before the first row");
    memcpy(reader->space_name, name, sizeof name);
    return BAT_OK;
}

/// Apply the comment "columns: LIST" for a list of numbers. Other programs' comments have names there.
static bat_status read_column_list(csv_reader *reader, const text_line *line, csv_field list, bat_error *error)
{
    size_t length = (size_t)(list.end - list.begin);
    for (const char *at = list.begin; at < list.end; at++)
        if (strchr("0123456789, ", *at) == NULL)
            return BAT_OK;
    if (length == 0 || length >= sizeof reader->column_list)
        return BAT_OK;
    if (reader->begun)
        return ERROR_FILE(error, line->number, "the columns must be named before the first row");
    memcpy(reader->column_list, list.begin, length);
    reader->column_list[length] = '\0';
    return BAT_OK;
}

/// Apply a comment "closed", "open", "space: NAME" or "columns: LIST", in upper or lower case.
static bat_status read_comment(csv_reader *reader, const text_line *line, bat_error *error)
{
    static const char space[] = "space";
    static const char columns[] = "columns:";
    const size_t space_length = sizeof space - 1, columns_length = sizeof columns - 1;
    csv_field words = csv_trimmed(line->begin + 1, line->end);
    size_t length = (size_t)(words.end - words.begin);
    if (length == 6 && strncasecmp(words.begin, "closed", length) == 0)
        reader->closed = true;
    else if (length == 4 && strncasecmp(words.begin, "open", length) == 0)
        reader->closed = false;
    else if (length > space_length && strncasecmp(words.begin, space, space_length) == 0 &&
             strchr(": \t", words.begin[space_length]) != NULL)
        return read_space(reader, line, words.begin + space_length, words.end, error);
    else if (length > columns_length && strncasecmp(words.begin, columns, columns_length) == 0)
        return read_column_list(reader, line, csv_trimmed(words.begin + columns_length, words.end), error);
    return BAT_OK;
}

/// Times increase strictly along a curve. Those of a closed one may fall at its end, where refinement puts points.
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
        if (falls ? time < before : time > before)
            continue;
        char texts[2][EXACT_TIME_SIZE + 1];
        for (size_t k = 0; k < 2; k++)
            *exact_time_write(texts[k], reader->attributes->time_origin, reader->attributes->time_decimals,
                              k == 0 ? time : before) = '\0';
        return error_set(error, BAT_BAD_FILE, i, lines[i], "the time %s does not come after %s", texts[0], texts[1]);
    }
    return BAT_OK;
}

/// Whether the cells of the last row are those of the current curve's first row. Times need not be.
static bool cells_return(const csv_reader *reader)
{
    const cell_builder *cells = &reader->cells;
    size_t begin = (cells->row_count - reader->builder.point_count) * cells->columns;
    for (size_t i = 0, cell = 0; i < reader->column_count && cells->columns > 0; i++)
    {
        csv_kind kind = (csv_kind)reader->attributes->csv->kinds[i];
        if (kind == CSV_NUMBER || kind == CSV_ID)
            continue;
        size_t first = cells->offsets[begin + cell], last = cells->offsets[cells->offset_count - cells->columns + cell];
        if (kind != CSV_TIME && kind != CSV_CLOCK && strcmp(cells->text.data + first, cells->text.data + last) != 0)
            return false;
        cell++;
    }
    return true;
}

static bat_status end_curve(csv_reader *reader, bat_error *error)
{
    curve_builder *builder = &reader->builder;
    if (builder->point_count == 0)
        return BAT_OK;
    int wanted = reader->options->closed;
    bool closed = wanted < 0 ? reader->closed : wanted > 0;
    const point_form *form = reader->attributes->csv->form;
    reader->attributes->turned = reader->options->euler != NULL || (form != NULL && form->rotation == ROTATION_VECTOR);
    builder_continue_signs(builder, reader->attributes->turned);
    while (closed && builder_returns(builder) && cells_return(reader))
    {
        builder_drop_last(builder);
        if (reader->cells.columns > 0)
            cells_drop_row(&reader->cells);
    }
    bool dropped = closed && !reader->motion;
    while (dropped)
    {
        size_t index = builder->point_count - 1, last_line = builder->lines[builder->line_count - 1];
        const char *fault = builder_drop_repeat(builder, true, &dropped);
        if (fault != NULL)
            return error_set(error, BAT_BAD_FILE, index, last_line, "curve %zu, point %zu: %s", builder->curve_count, index,
                             fault);
        if (dropped && reader->cells.columns > 0)
            cells_drop_row(&reader->cells);
    }
    reader->closed = false;
    bool few = builder->point_count < (closed ? 3 : 2);
    if (few && reader->short_count++ == 0)
        reader->first_short = builder->lines[builder->line_count - 1];
    if (few && reader->drop_short)
    {
        for (; builder->point_count > 0; builder_drop_last(builder))
            if (reader->cells.columns > 0)
                cells_drop_row(&reader->cells);
        return BAT_OK;
    }
    bat_status status = check_times(reader, closed, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < builder->point_count && reader->attributes->csv->has_places; i++)
        cells_place(i, builder->point_count, closed,
                    builder->channels + (i + 1) * builder->channel_count - CSV_PLACE_CHANNELS);
    if (reader->cells.columns > 0 && !cells_end_curve(&reader->cells, closed))
        return error_memory(error, builder->point_count);
    return builder_end_curve(builder, closed) ? BAT_OK : error_memory(error, builder->point_count * sizeof(double));
}

/// A comment, or a header whose first column is called '#'.
static bool is_comment(const csv_reader *reader, const text_line *line)
{
    bool first = reader->column_count == 0 && line->end - line->begin > 1 && strchr(",;\t", line->begin[1]) != NULL;
    return *line->begin == '#' && (reader->tum || !first);
}

/// Read a line that is neither blank nor a comment up to its fields. `*count` is 0 for a header and for an empty row.
static bat_status read_fields(csv_reader *reader, const text_line *line, size_t *count, bat_error *error)
{
    if (reader->separator == '\0')
        reader->separator = csv_find_separator(line);
    bat_status status = split(reader, line, count, error);
    if (status != BAT_OK)
        return status;
    if (is_empty_row(reader, *count))
        *count = 0;
    else if (reader->column_count == 0 && is_header(reader, *count))
    {
        status = read_header(reader, line, *count, error);
        *count = 0;
    }
    else if (reader->column_count == 0) // a first row without a header: empty fields at its end do not count
    {
        size_t filled = *count;
        while (filled > 1 && reader->fields[filled - 1].begin == reader->fields[filled - 1].end)
            filled--;
        reader->column_count = filled;
    }
    return status;
}

static bat_status read_line(csv_reader *reader, const text_line *line, bat_error *error)
{
    if (line->begin == line->end)
        return reader->tum ? BAT_OK : end_curve(reader, error);
    if (is_comment(reader, line))
        return reader->tum ? BAT_OK : read_comment(reader, line, error);
    size_t count, header = reader->header_line;
    bat_status status = read_fields(reader, line, &count, error);
    if (status != BAT_OK)
        return status;
    if (count == 0)
        return reader->header_line != header ? BAT_OK : end_curve(reader, error);
    return read_row(reader, line, count, error);
}

static bat_status read_lines(csv_reader *reader, bat_error *error)
{
    text_line line = text_line_start(reader->text);
    bat_status status = BAT_OK;
    while (status == BAT_OK && !reader->again && text_line_next(reader->text, &line))
        status = read_line(reader, &line, error);
    if (status == BAT_OK && !reader->again)
        status = end_curve(reader, error);
    if (status == BAT_OK && !reader->again && reader->builder.curve_count == 0)
        return ERROR_FILE(error, line.number, "there are no points");
    return status;
}

/// A row with its value in the column that groups rows.
typedef struct grouped_row
{
    text_line line;
    csv_field value;
    size_t index, first; ///< of the row; of the first row with its value
    bool closed;         ///< a directive before the row closes its curve
} grouped_row;

typedef struct row_groups
{
    grouped_row *rows;
    size_t count, capacity;
} row_groups;

static int compare_values(const csv_field *p, const csv_field *q)
{
    size_t p_size = (size_t)(p->end - p->begin), q_size = (size_t)(q->end - q->begin);
    int order = memcmp(p->begin, q->begin, p_size < q_size ? p_size : q_size);
    return order != 0 ? order : (p_size > q_size) - (p_size < q_size);
}

/// By value, then in the order of the file.
static int compare_rows(const void *a, const void *b)
{
    const grouped_row *p = a, *q = b;
    int order = compare_values(&p->value, &q->value);
    return order != 0 ? order : (p->index > q->index) - (p->index < q->index);
}

/// By the first rows of their groups, then in the order of the file.
DEFINE_ORDER(compare_groups, grouped_row, first, index)

/// Order rows by groups, and these by their first rows.
static void order_groups(row_groups *all)
{
    qsort(all->rows, all->count, sizeof *all->rows, compare_rows);
    for (size_t i = 0; i < all->count; i++)
    {
        bool begins = i == 0 || compare_values(&all->rows[i - 1].value, &all->rows[i].value) != 0;
        all->rows[i].first = begins ? all->rows[i].index : all->rows[i - 1].first;
    }
    qsort(all->rows, all->count, sizeof *all->rows, compare_groups);
}

/// Collect the rows with their values of a column. Blank lines have no meaning.
static bat_status collect_groups(csv_reader *reader, row_groups *all, bat_error *error)
{
    text_line line = text_line_start(reader->text);
    bat_status status = BAT_OK;
    size_t column = BAT_NO_INDEX, count;
    while (status == BAT_OK && text_line_next(reader->text, &line))
    {
        if (line.begin == line.end)
            continue;
        if (is_comment(reader, &line))
        {
            status = read_comment(reader, &line, error);
            continue;
        }
        status = read_fields(reader, &line, &count, error);
        if (status != BAT_OK || count == 0)
            continue;
        const char *name = reader->options->group;
        if (column == BAT_NO_INDEX)
            status = csv_find_column(reader, "group", name, strlen(name), false, &column, error);
        if (status == BAT_OK)
            status = check_width(reader, &line, count, error);
        if (status != BAT_OK)
            break;
        csv_field value = csv_unquoted(reader->fields[csv_column_number(reader, column) - 1]);
        const grouped_row row = {line, value, all->count, 0, reader->closed};
        if (!ARRAY_ADD(all->rows, all->capacity, all->count, row))
            status = error_memory(error, all->count * sizeof row);
        reader->closed = false;
    }
    return status == BAT_OK && all->count == 0 ? ERROR_FILE(error, line.number, "there are no points") : status;
}

/// A curve for each value of a column, in the order of their first rows.
static bat_status read_groups(csv_reader *reader, bat_error *error)
{
    row_groups all = {.rows = NULL};
    bat_status status = collect_groups(reader, &all, error);
    if (status == BAT_OK)
        order_groups(&all);
    bool closed = false;
    for (size_t i = 0; i < all.count && status == BAT_OK && !reader->again; i++)
    {
        const grouped_row *row = &all.rows[i];
        bool ends = i + 1 == all.count || row[1].first != row->first;
        closed = closed || row->closed;
        size_t count;
        status = split(reader, &row->line, &count, error);
        if (status == BAT_OK)
            status = read_row(reader, &row->line, count, error);
        if (status != BAT_OK || reader->again || !ends)
            continue;
        reader->closed = closed;
        closed = false;
        status = end_curve(reader, error);
    }
    free(all.rows);
    return status;
}

static void reader_release(csv_reader *reader)
{
    builder_free(&reader->builder);
    cells_free(&reader->cells);
    attributes_release(reader->attributes);
    reader->attributes = NULL;
}

/// Begin at the start of the file, with the kinds of columns that are known.
static bool reader_begin(csv_reader *reader, bat_curve_format format)
{
    csv_reader before = *reader;
    *reader = (csv_reader){.text = before.text,
                           .options = before.options,
                           .builder = {.project = before.options->project, .strict = before.options->strict, .check = true},
                           .attributes = csv_attributes_new(format),
                           .group = BAT_NO_INDEX,
                           .time_decimals = -1,
                           .kinds_known = before.kinds_known,
                           .drop_short = before.drop_short,
                           .tum = format == BAT_CURVE_FORMAT_TUM || format == BAT_CURVE_FORMAT_EUROC};
    for (size_t i = 0; i < BAT_SPACE_MAX_DIM && before.kinds_known; i++)
        reader->columns[i] = (column_state){.kind = before.columns[i].kind, .has_number = before.columns[i].has_number};
    return reader->attributes != NULL && (!reader->tum || csv_name_tum_columns(reader));
}

/// Read the file, and again where a column holds other things than it began with, or a curve among others has too few
/// points. Kinds change one way, so that this ends.
static bat_status read_text(csv_reader *reader, bat_curve_format format, bat_error *error)
{
    bat_status status = BAT_OK;
    bool few = false;
    do
    {
        reader_release(reader);
        if (!reader_begin(reader, format))
            return error_memory(error, sizeof *reader);
        status = reader->options->group != NULL && !reader->tum ? read_groups(reader, error) : read_lines(reader, error);
        few = !reader->again && !reader->drop_short && !reader->options->strict && reader->short_count > 0 &&
              reader->builder.curve_count > reader->short_count;
        reader->drop_short = reader->drop_short || few;
    } while (status == BAT_OK && (reader->again || few));
    return status == BAT_OK && !csv_note_columns(reader) ? error_memory(error, BAT_ERROR_TEXT_SIZE) : status;
}

bat_status csv_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_curve_read_options chosen = *options;
    if (options->format == BAT_CURVE_FORMAT_TUM || options->format == BAT_CURVE_FORMAT_EUROC)
    {
        if (options->space != NULL && strcmp(options->space, "rigid") != 0)
            return ERROR_ARGUMENT(error, "a TUM trajectory is in the space rigid, not %.60s", options->space);
        chosen.space = "rigid";
        chosen.columns = chosen.group = NULL;
        chosen.motion = true;
    }
    csv_reader *reader = calloc(1, sizeof *reader);
    if (reader == NULL)
        return error_memory(error, sizeof *reader);
    reader->options = &chosen;
    reader->text = text;
    bat_status status = read_text(reader, options->format, error);
    const curve_builder *builder = &reader->builder;
    if (status == BAT_OK && !builder_note_repeats(builder, reader->attributes))
        status = error_memory(error, sizeof *reader);
    if (status == BAT_OK && reader->unnamed_tum && builder->curve_count == 1 && !builder->curves[0].closed)
        reader->attributes->format = BAT_CURVE_FORMAT_TUM;
    if (status == BAT_OK)
    {
        if (reader->cells.columns > 0)
            cells_finish(&reader->cells, &reader->attributes->csv->cells);
        status = builder_finish(&reader->builder, reader->attributes, set, error);
        if (status == BAT_OK)
            csv_attributes_describe(set->attributes, set->space);
    }
    else
        reader_release(reader);
    free(reader);
    return status;
}
