#include "io/common/time_text.h"
#include "io/curve/csv.h"

#include <math.h>
#include <strings.h>

/// @file
/// The meaning of CSV columns: what they hold, which ones are coordinates, and what is told about that.

size_t csv_column_number(const csv_reader *reader, size_t column)
{
    return column + 1 + (column >= reader->attributes->csv->corner ? 1 : 0);
}

/// The name of a column as messages show it, or its number.
static const char *csv_column_label(const csv_reader *reader, size_t column, char label[EXCERPT_SIZE + 16])
{
    const csv_columns *columns = reader->attributes->csv;
    csv_field inner = csv_text(columns->names != NULL ? columns->names[column] : "");
    if (inner.begin == inner.end)
        (void)snprintf(label, EXCERPT_SIZE + 16, "%zu", csv_column_number(reader, column));
    else
        (void)snprintf(label, EXCERPT_SIZE + 16, "'%.*s'",
                       (int)(inner.end - inner.begin > EXCERPT_SIZE ? EXCERPT_SIZE : inner.end - inner.begin), inner.begin);
    return label;
}

static bool is_iso_time(csv_field field)
{
    iso_time time;
    field = csv_unquoted(field);
    return iso_time_read(field.begin, field.end, &time);
}

static bool reads_as_number(const csv_reader *reader, csv_field field)
{
    double value;
    bool comma;
    return csv_read_number(field, reader->separator, &value, &comma) == NULL;
}

/// The column whose name, or whose name without its unit, is a text; or BAT_NO_INDEX.
static size_t find_by_name(const csv_reader *reader, const char *name, size_t length)
{
    const csv_columns *columns = reader->attributes->csv;
    char wanted[EXCERPT_SIZE * 4];
    if (columns->names == NULL || length >= sizeof wanted)
        return BAT_NO_INDEX;
    memcpy(wanted, name, length);
    wanted[length] = '\0';
    for (size_t i = 0; i < columns->count; i++)
    {
        csv_field inner = csv_text(columns->names[i]);
        if ((size_t)(inner.end - inner.begin) == length && strncasecmp(inner.begin, name, length) == 0)
            return i;
    }
    name_parts parts = name_parse(wanted);
    for (size_t i = 0; i < columns->count && parts.base[0] != '\0'; i++)
        if (strcmp(name_parse(columns->names[i]).base, parts.base) == 0)
            return i;
    return BAT_NO_INDEX;
}

bat_status csv_find_column(const csv_reader *reader, const char *option, const char *name, size_t length, bool numbered,
                           size_t *column, bat_error *error)
{
    size_t corner = reader->attributes->csv->corner;
    *column = numbered ? BAT_NO_INDEX : find_by_name(reader, name, length);
    int64_t number;
    if (*column == BAT_NO_INDEX && csv_read_whole(csv_unquoted((csv_field){name, name + length}), EXACT_DIGITS, &number) &&
        number >= 1 && (uint64_t)number <= reader->column_count + (corner != BAT_NO_INDEX ? 1 : 0) &&
        (size_t)number - 1 != corner)
        *column = (size_t)number - 1 - ((size_t)number > corner ? 1 : 0);
    if (*column != BAT_NO_INDEX)
        return BAT_OK;
    return ERROR_FILE(error, reader->header_line, "%s: there is no column '%.*s' among %zu", option,
                      (int)(length > 60 ? 60 : length), name, reader->column_count);
}

/// The columns that the caller or a directive names for the coordinates, separated by commas.
static bat_status find_chosen(csv_reader *reader, const char *list, size_t *chosen, size_t *count, bat_error *error)
{
    *count = 0;
    for (const char *at = list; at != NULL;)
    {
        const char *comma = strchr(at, ',');
        csv_field name = csv_trimmed(at, comma != NULL ? comma : at + strlen(at));
        size_t length = (size_t)(name.end - name.begin);
        if (*count == BAT_SPACE_MAX_DIM)
            return ERROR_ARGUMENT(error, "columns: more than %d columns", BAT_SPACE_MAX_DIM);
        bat_status status =
            csv_find_column(reader, "columns", name.begin, length, list == reader->column_list, &chosen[*count], error);
        if (status != BAT_OK)
            return status;
        for (size_t i = 0; i < *count; i++)
            if (chosen[i] == chosen[*count])
                return ERROR_ARGUMENT(error, "columns: '%.*s' is there twice", (int)length, name.begin);
        ++*count;
        at = comma != NULL ? comma + 1 : NULL;
    }
    return BAT_OK;
}

static bool is_nameless(const csv_reader *reader, size_t column)
{
    csv_field inner = csv_text(reader->attributes->csv->names[column]);
    return inner.begin == inner.end;
}

bool csv_takes_dates(const csv_reader *reader, size_t column)
{
    return reader->options->motion && reader->attributes->csv->time == column;
}

/// The kind of a column by its first cell. A file without a header may have texts and times, but no misspelled numbers.
static csv_kind first_kind(const csv_reader *reader, size_t column)
{
    csv_field field = reader->fields[column];
    bool named = reader->attributes->csv->names != NULL;
    if (named && column > 0 && is_nameless(reader, column))
        return CSV_EMPTY;
    double value;
    bool comma;
    if (csv_read_number(field, reader->separator, &value, &comma) == NULL)
    {
        char **name = named ? &reader->attributes->csv->names[column] : NULL;
        int decimals;
        bool code = named && name_is_code(*name) && value == floor(value);
        if (!named || code || reader->options->motion)
            return code ? CSV_TEXT : CSV_NUMBER;
        if (name_is_angle(*name))
            return CSV_TEXT;
        return column_find_time(&(column_names){name, 1}, &decimals) == 0 ? CSV_CLOCK : CSV_NUMBER;
    }
    if (is_iso_time(field))
        return csv_takes_dates(reader, column) ? CSV_NUMBER : CSV_TIME;
    if (!named)
        return number_resembles(field.begin, field.end) || field.begin == field.end || csv_field_fault(field) != NULL
                   ? CSV_NUMBER
                   : CSV_TEXT;
    return csv_is_missing(field) ? CSV_GAPS : CSV_TEXT;
}

/// Whether the first column numbers the rows, as far as the first row tells.
static bool begins_as_index(const csv_reader *reader)
{
    const csv_columns *columns = reader->attributes->csv;
    int64_t value;
    size_t numbers = 0;
    for (size_t i = 1; i < reader->column_count; i++)
        numbers += reader->columns[i].kind == CSV_NUMBER ? 1 : 0;
    return columns->names != NULL && name_is_index(columns->names[0]) && numbers >= 2 &&
           csv_read_whole(csv_unquoted(reader->fields[0]), EXACT_DIGITS, &value);
}

static void choose_first_kinds(csv_reader *reader)
{
    size_t numbers = 0;
    for (size_t i = 0; i < reader->column_count; i++)
    {
        reader->columns[i].kind = i == reader->group ? CSV_GROUP : first_kind(reader, i);
        numbers += reader->columns[i].kind == CSV_NUMBER ? 1 : 0;
    }
    char **names = reader->attributes->csv->names;
    for (size_t i = 0; i < reader->column_count && names != NULL && numbers < 2; i++) // they may be coordinates
        if (reader->columns[i].kind == CSV_CLOCK ||
            (reader->columns[i].kind == CSV_TEXT && name_is_angle(names[i]) && reads_as_number(reader, reader->fields[i])))
            reader->columns[i].kind = CSV_NUMBER;
    if (reader->group != 0 && begins_as_index(reader))
        reader->columns[0].kind = CSV_ID;
}

bool csv_change_kind(csv_reader *reader, size_t column)
{
    column_state *state = &reader->columns[column];
    csv_field field = reader->fields[column];
    csv_kind kind = state->kind;
    if (reader->strict || state->is_coordinate || kind == CSV_EMPTY || csv_field_fault(field) != NULL)
        return false;
    bool time = is_iso_time(field) && !state->has_number;
    if (csv_is_missing(field))
        kind = kind == CSV_NUMBER || kind == CSV_CLOCK ? CSV_GAPS : kind == CSV_ID ? CSV_TEXT : kind;
    else if (kind == CSV_GAPS && time)
        kind = CSV_TIME;
    else
        kind = CSV_TEXT;
    reader->again = reader->again || kind != state->kind;
    state->kind = kind;
    return true;
}

/// Whether a running number is the next one. Numbers may begin anew with each curve.
static bool is_next_id(csv_reader *reader, csv_field field)
{
    csv_columns *columns = reader->attributes->csv;
    int64_t value;
    if (!csv_read_whole(csv_unquoted(field), EXACT_DIGITS, &value))
        return false;
    if (reader->row_count == 0)
        columns->first_id = reader->next_id = value;
    bool begins = reader->builder.point_count == 0 && reader->row_count > 0 && value == columns->first_id;
    columns->ids_begin_anew = columns->ids_begin_anew || (begins && value != reader->next_id);
    bool next = columns->ids_begin_anew && reader->builder.point_count == 0 ? begins : value == reader->next_id;
    reader->next_id = value + 1;
    return next;
}

/// Whether a cell fits its column, which is none of numbers.
static bool cell_fits(csv_reader *reader, size_t column)
{
    column_state *state = &reader->columns[column];
    csv_field field = reader->fields[column];
    if (state->kind == CSV_ID)
        return is_next_id(reader, field);
    if (state->kind == CSV_TIME)
        return csv_is_missing(field) || is_iso_time(field);
    if (state->kind == CSV_GAPS)
        return csv_is_missing(field) || reads_as_number(reader, field);
    return state->kind == CSV_EMPTY ? csv_is_missing(field) : csv_field_fault(field) == NULL;
}

void csv_watch_cell(csv_reader *reader, const text_line *line, size_t column)
{
    column_state *state = &reader->columns[column];
    csv_field field = reader->fields[column];
    double value;
    if (csv_is_missing(field))
    {
        if (state->gaps++ == 0)
            state->first_gap = line->number;
    }
    else if (state->kind == CSV_GAPS)
    {
        state->has_number = true;
        (void)csv_read_number(field, reader->separator, &value, &reader->comma);
    }
    size_t size = (size_t)(field.end - field.begin);
    if (state->begin != NULL &&
        ((size_t)(state->end - state->begin) != size || memcmp(state->begin, field.begin, size) != 0))
        state->changes++;
    state->begin = field.begin;
    state->end = field.end;
}

#define LONGEST 64 ///< characters of a number

static bool store_cell(csv_reader *reader, size_t column)
{
    csv_field field = reader->fields[column];
    char text[LONGEST];
    size_t size = (size_t)(field.end - field.begin);
    char *comma = NULL;
    csv_kind kind = reader->columns[column].kind;
    if ((kind == CSV_GAPS || kind == CSV_CLOCK) && reader->separator != ',' && size < LONGEST)
    {
        memcpy(text, field.begin, size);
        comma = memchr(text, ',', size);
    }
    if (comma == NULL)
        return cells_add(&reader->cells, field);
    *comma = '.';
    return cells_add(&reader->cells, (csv_field){text, text + size});
}

bat_status csv_take_cells(csv_reader *reader, const text_line *line, bat_error *error)
{
    if (reader->attributes->csv->kinds == NULL)
        return BAT_OK;
    for (size_t i = 0; i < reader->column_count; i++)
    {
        csv_kind kind = reader->columns[i].kind;
        if (kind == CSV_NUMBER)
            continue;
        char excerpt[EXCERPT_SIZE];
        csv_field field = reader->fields[i];
        if (kind == CSV_EMPTY && !cell_fits(reader, i))
            return ERROR_FILE(error, reader->header_line, "column %zu of the header has no name",
                              csv_column_number(reader, i));
        if (!cell_fits(reader, i) && !csv_change_kind(reader, i))
            return error_set(error, BAT_BAD_FILE, reader->builder.point_count, line->number,
                             "column %zu: '%s' has no meaning", csv_column_number(reader, i),
                             text_excerpt(excerpt, field.begin, field.end));
        if (reader->again)
            continue; // the other columns' kinds may change with this row, too
        csv_watch_cell(reader, line, i);
        if (kind != CSV_ID && !store_cell(reader, i))
            return error_memory(error, reader->cells.text.size);
    }
    reader->cells.row_count++;
    return BAT_OK;
}

bool csv_name_tum_columns(csv_reader *reader)
{
    static const char *const names[] = {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw", "vx", "vy", "vz"};
    csv_field fields[sizeof names / sizeof *names];
    size_t count = reader->options->format == BAT_CURVE_FORMAT_EUROC ? sizeof names / sizeof *names : TUM_COLUMNS;
    for (size_t i = 0; i < count; i++)
        fields[i] = (csv_field){names[i], names[i] + strlen(names[i])};
    reader->column_count = count;
    return csv_columns_name(reader->attributes->csv, fields, count);
}

/// The form of a rotation, pose or tensor, in a space that may be null; null for plain coordinates. Without a named space,
/// names of quaternions and matrices imply a form.
static const point_form *find_form(const char *space, bool motion, const column_names *names)
{
    static const char *const unnamed[] = {"rigid", "rotation"};
    if (space == NULL && motion)
        return point_form_of_motion(names);
    const char *const *candidates = space != NULL ? &space : unnamed;
    size_t count = space != NULL ? 1 : names->names != NULL ? sizeof unnamed / sizeof *unnamed : 0;
    for (size_t i = 0; i < count; i++)
    {
        const point_form *form = point_form_find(candidates[i], names);
        if (form == NULL || !form->strict)
            continue;
        if (space != NULL || (column_find(names, form->names[0]) != BAT_NO_INDEX &&
                              (form->rotation == ROTATION_QUATERNION || form->rotation == ROTATION_MATRIX)))
            return form;
    }
    return NULL;
}

static bat_status use_form(csv_reader *reader, const point_form *form, bat_error *error)
{
    csv_columns *columns = reader->attributes->csv;
    free(columns->kinds);
    columns->kinds = NULL;
    reader->strict = true;
    if (!csv_columns_use_form(columns, form))
        return error_memory(error, reader->column_count * sizeof(size_t));
    size_t dim = form->rotation == ROTATION_NONE ? form->count : form->rotation_at + 4;
    reader->coordinate_count = form->count;
    return bat_space_by_name(form->space, dim, &reader->builder.space, error);
}

/// Keep the columns of the coordinates and velocities: by a form, by names, else all columns of numbers.
static void keep_columns(const csv_reader *reader, const column_names *names, bool *kept)
{
    const point_form *form = point_form_of_motion(names);
    named_coordinates named = names_find_coordinates(names, false);
    for (size_t i = 0; form == NULL && i < named.count; i++)
        kept[named.columns[i]] = true;
    if (form == NULL && !named.geographic)
        form = point_form_first(named.count == 2 ? "plane" : "euclidean", named.count);
    for (size_t i = 0; form != NULL && form->strict && i < form->count; i++)
        kept[column_find(names, form->names[i])] = true;
    size_t found[MAX_VELOCITIES], speeds = form != NULL ? point_form_find_velocities(form, names, found) : 0;
    for (size_t i = 0; speeds > 0 && i < form->velocity_count; i++)
        if (found[i] != BAT_NO_INDEX)
            kept[found[i]] = true;
    for (size_t i = 0; i < names->count && form == NULL && named.count == 0; i++)
        kept[i] = reads_as_number(reader, reader->fields[i]);
}

/// Decimals of seconds that times in logs of PX4 have, which have a column ref_timestamp.
static const int MICROSECONDS = 6;

bool csv_leave_columns(csv_reader *reader)
{
    csv_columns *columns = reader->attributes->csv;
    column_names names = {columns->names, reader->column_count};
    csv_field kept_names[BAT_SPACE_MAX_DIM];
    bool kept[BAT_SPACE_MAX_DIM] = {false};
    size_t count = 0, time;
    if (columns->names == NULL || reader->tum)
        return true;
    columns->time = time = column_find_time(&names, &reader->time_decimals);
    bool px4 = time != BAT_NO_INDEX && reader->time_decimals < 0 && column_find(&names, "ref_timestamp") != BAT_NO_INDEX;
    reader->time_decimals = px4 ? MICROSECONDS : reader->time_decimals;
    bool named = reader->options->columns != NULL || reader->options->group != NULL || reader->options->space != NULL;
    if (time == BAT_NO_INDEX || named || reader->space_name[0] != '\0' || reader->column_list[0] != '\0')
        return true;
    keep_columns(reader, &names, kept);
    kept[time] = true;
    for (size_t i = 0; i < names.count; i++)
    {
        csv_field name = {names.names[i], names.names[i] + strlen(names.names[i])};
        if (kept[i])
            kept_names[count++] = name;
        else if (reader->left_count++ == 0)
            (void)text_excerpt(reader->left_name, csv_unquoted(name).begin, csv_unquoted(name).end);
        reader->left[i] = !kept[i];
    }
    if (reader->left_count == 0)
        return true;
    reader->column_count = count;
    bool good = csv_columns_name(columns, kept_names, count);
    names = (column_names){columns->names, count};
    columns->time = column_find_time(&names, &reader->time_decimals);
    reader->time_decimals = px4 ? MICROSECONDS : reader->time_decimals;
    return good;
}

void csv_drop_left(csv_reader *reader)
{
    size_t next = 0, total = reader->column_count + reader->left_count;
    for (size_t i = 0; i < total && reader->left_count > 0; i++)
        if (!reader->left[i])
            reader->fields[next++] = reader->fields[i];
}

/// The coordinates that the caller or a directive chooses.
static bat_status use_chosen(csv_reader *reader, const char *list, const char *space, bat_error *error)
{
    csv_choice *choice = &reader->choice;
    char *names[BAT_SPACE_MAX_DIM];
    size_t chosen[BAT_SPACE_MAX_DIM], count;
    bat_status status = find_chosen(reader, list, chosen, &count, error);
    if (status != BAT_OK)
        return status;
    column_names sub = {reader->attributes->csv->names != NULL ? names : NULL, count};
    for (size_t i = 0; i < count && sub.names != NULL; i++)
        names[i] = reader->attributes->csv->names[chosen[i]];
    named_coordinates named = names_find_coordinates(&sub, false);
    bool sphere = space != NULL && strcmp(space, "sphere") == 0;
    *choice = (csv_choice){.space = space, .count = count, .altitude = BAT_NO_INDEX, .times = BAT_NO_INDEX};
    memcpy(choice->columns, chosen, count * sizeof *chosen);
    reader->chosen = true;
    if ((named.geographic && (space == NULL || sphere)) || (sphere && count == 2))
    {
        choice->degrees = true;
        choice->radians = named.geographic && named.radians;
        choice->space = "sphere";
        choice->count = 2;
        for (size_t i = 0; i < 2 && named.geographic; i++)
            choice->columns[i] = chosen[named.columns[i]];
        for (size_t i = 0; i < count && count > 2; i++)
            if (chosen[i] != choice->columns[0] && chosen[i] != choice->columns[1])
                choice->altitude = chosen[i];
    }
    if (choice->space == NULL)
        choice->space = count == 2 ? "plane" : "euclidean";
    return BAT_OK;
}

/// The list of the chosen columns by their numbers, for a directive in what is written.
static bool keep_choice(csv_reader *reader)
{
    csv_columns *columns = reader->attributes->csv;
    text_buffer text = {0};
    size_t altitude = reader->choice.altitude;
    for (size_t i = 0; i < reader->choice.count + (altitude != BAT_NO_INDEX ? 1 : 0); i++)
    {
        size_t column = i < reader->choice.count ? reader->choice.columns[i] : altitude;
        text_append_format(&text, "%s%zu", i > 0 ? "," : "", csv_column_number(reader, column));
    }
    text_append(&text, "", 1);
    if (!text.failed)
        columns->chosen = text.data;
    else
        text_free(&text);
    return columns->chosen != NULL;
}

bool csv_is_guess(const csv_columns *columns, size_t count, const csv_choice *choice, bool others, bool named_space)
{
    static const int MAX_GUESSED = 3;
    for (size_t i = 0; i < count && columns->kinds != NULL; i++)
        others = others || (columns->kinds[i] != CSV_NUMBER && columns->kinds[i] != CSV_EMPTY);
    return choice->by_place && others && (choice->count < 2 || (choice->count > MAX_GUESSED && !named_space));
}

/// Refuse to guess coordinates by their places where that would be a game of chance.
static bat_status check_guess(const csv_reader *reader, const text_line *line, bool named_space, bat_error *error)
{
    const csv_choice *choice = &reader->choice;
    bool others = choice->times != BAT_NO_INDEX && !reader->options->motion;
    if (!csv_is_guess(reader->attributes->csv, reader->column_count, choice, others, named_space))
        return BAT_OK;
    (void)ERROR_FILE(error, reader->header_line > 0 ? reader->header_line : line->number,
                     "cannot tell which of %zu columns hold the coordinates", reader->column_count);
    return error_remedy(error, BAT_BAD_FILE, "columns", "names them");
}

static bat_status check_counts(const csv_reader *reader, const text_line *line, bat_error *error)
{
    const csv_choice *choice = &reader->choice;
    const char *name = choice->space;
    bool two = strcmp(name, "plane") == 0 || strcmp(name, "disk") == 0;
    if (strcmp(name, "sphere") == 0 && !choice->degrees && choice->count < 3)
        return error_remedy(
            error,
            ERROR_FILE(error, line->number, "a point of the sphere needs 3 or more columns, or a header with lon and lat"),
            "columns", "names columns of longitude and latitude");
    return two && choice->count != 2 ? ERROR_FILE(error, line->number, "a point of the %s needs 2 columns", name) : BAT_OK;
}

static bat_status use_choice(csv_reader *reader, const text_line *line, bool named_space, bat_error *error)
{
    csv_columns *columns = reader->attributes->csv;
    const csv_choice *choice = &reader->choice;
    bat_space any;
    bat_status status = check_guess(reader, line, named_space, error);
    if (status == BAT_OK)
        status = check_counts(reader, line, error);
    if (status == BAT_OK)
        status = bat_space_by_name(choice->space, 0, &any, error);
    if (status != BAT_OK)
        return status;
    reader->coordinate_count = choice->count;
    for (size_t i = 0; i < choice->count; i++)
    {
        if (choice->columns[i] == reader->group)
            return ERROR_ARGUMENT(error, "group: the column '%.60s' holds a coordinate", reader->options->group);
        column_state *state = &reader->columns[choice->columns[i]];
        state->is_coordinate = true;
        state->kind = CSV_NUMBER;
        if (columns->kinds != NULL)
            columns->kinds[choice->columns[i]] = CSV_NUMBER;
    }
    if ((columns->names != NULL || columns->kinds != NULL || reader->chosen) &&
        !csv_columns_place(columns, choice->columns, choice->count))
        return error_memory(error, reader->column_count * sizeof(size_t));
    columns->degrees = choice->degrees;
    columns->radians = choice->radians;
    if (choice->degrees)
    {
        if (choice->altitude != BAT_NO_INDEX && reader->columns[choice->altitude].kind == CSV_NUMBER)
            columns->altitude = columns->places[choice->altitude] - choice->count;
        reader->builder.check = false;
        reader->builder.space = bat_sphere(2);
        return reader->chosen && !keep_choice(reader) ? error_memory(error, BAT_SPACE_MAX_DIM) : BAT_OK;
    }
    if (reader->chosen && !keep_choice(reader))
        return error_memory(error, BAT_SPACE_MAX_DIM);
    status = bat_space_by_name(choice->space, choice->count, &reader->builder.space, error);
    return status == BAT_OK ? status
                            : ERROR_FILE(error, line->number, "%zu columns are not a point of the space %s", choice->count,
                                         choice->space);
}

/// Set the kinds of the columns, where not all are numbers.
static bat_status set_kinds(csv_reader *reader, bat_error *error)
{
    csv_columns *columns = reader->attributes->csv;
    columns->count = reader->column_count;
    columns->other_count = 0;
    for (size_t i = 0; i < reader->column_count; i++)
        columns->other_count += reader->columns[i].kind != CSV_NUMBER ? 1 : 0;
    if (columns->other_count == 0)
        return BAT_OK;
    if (array_make(&columns->kinds, reader->column_count, 1, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < reader->column_count; i++)
        columns->kinds[i] = (unsigned char)reader->columns[i].kind;
    return BAT_OK;
}

/// Count the columns that are left after the choice, and those that have cells.
static void count_columns(csv_reader *reader)
{
    csv_columns *columns = reader->attributes->csv;
    columns->other_count = 0;
    reader->cells.columns = 0;
    for (size_t i = 0; i < reader->column_count && columns->kinds != NULL; i++)
    {
        csv_kind kind = (csv_kind)columns->kinds[i];
        columns->other_count += kind != CSV_NUMBER && kind != CSV_CLOCK ? 1 : 0;
        reader->cells.columns += kind != CSV_NUMBER && kind != CSV_ID ? 1 : 0;
        columns->has_places = columns->has_places || kind == CSV_TEXT || kind == CSV_TIME || kind == CSV_GAPS;
    }
    for (size_t i = 0; i < reader->column_count && !reader->strict; i++)
        reader->columns[i].is_watched = columns->names != NULL && !reader->columns[i].is_coordinate &&
                                        reader->columns[i].kind == CSV_NUMBER && name_is_group(columns->names[i]);
    reader->number_count = reader->column_count - columns->other_count;
}

bat_status csv_choose(csv_reader *reader, const text_line *line, bat_error *error)
{
    csv_columns *columns = reader->attributes->csv;
    const char *space = reader->options->space;
    if (space == NULL && reader->space_name[0] != '\0')
        space = reader->space_name;
    const char *list = reader->options->columns;
    if (list == NULL && reader->column_list[0] != '\0')
        list = reader->column_list;
    reader->group = BAT_NO_INDEX;
    bat_status status = BAT_OK;
    for (size_t i = 1; i < reader->column_count && columns->names != NULL && !reader->tum; i++)
        if (is_nameless(reader, i) && !csv_is_missing(reader->fields[i]))
            return ERROR_FILE(error, reader->header_line, "column %zu of the header has no name",
                              csv_column_number(reader, i));
    if (reader->options->group != NULL)
        status = csv_find_column(reader, "group", reader->options->group, strlen(reader->options->group), false,
                                 &reader->group, error);
    bool trajectory = space != NULL && strcmp(space, "rigid") == 0 && reader->column_count == TUM_COLUMNS;
    if (status == BAT_OK && trajectory && columns->names == NULL)
    {
        reader->unnamed_tum = true;
        if (!csv_name_tum_columns(reader))
            return error_memory(error, TUM_COLUMNS * sizeof(char *));
    }
    column_names names = {columns->names, reader->column_count};
    const point_form *form =
        list == NULL ? find_form(space, reader->options->motion && columns->time != BAT_NO_INDEX, &names) : NULL;
    char fault[BAT_ERROR_TEXT_SIZE];
    if (status == BAT_OK && space == NULL && list == NULL && point_form_incomplete(form, &names, fault, sizeof fault))
        status = ERROR_FILE(error, reader->header_line, "%s", fault);
    const char *implied = space == NULL && form != NULL ? form->space : space;
    if (status == BAT_OK && implied != NULL && list == NULL && point_form_fault(implied, form, &names, fault, sizeof fault))
        status = ERROR_FILE(error, reader->header_line, "%s", fault);
    if (status != BAT_OK)
        return status;
    if (form == NULL && !reader->kinds_known)
        choose_first_kinds(reader);
    reader->kinds_known = true;
    if (form == NULL)
        status = set_kinds(reader, error);
    if (status == BAT_OK && form != NULL)
        status = use_form(reader, form, error);
    else if (status == BAT_OK)
    {
        if (list != NULL)
            status = use_chosen(reader, list, space, error);
        else
            csv_columns_choose(columns, space, reader->options->motion, &reader->choice);
        if (status == BAT_OK)
            status = use_choice(reader, line, space != NULL, error);
    }
    count_columns(reader);
    return status;
}

/// Append the labels of the columns of a kind. False when there is none.
static bool list_columns(const csv_reader *reader, csv_kind kind, char *text, size_t size)
{
    size_t used = 0, more = 0;
    for (size_t i = 0; i < reader->column_count; i++)
    {
        char label[EXCERPT_SIZE + 16];
        if (reader->columns[i].kind != kind || reader->strict)
            continue;
        if (used > size / 2)
            more++;
        else
            used +=
                (size_t)snprintf(text + used, size - used, "%s%s", used > 0 ? ", " : "", csv_column_label(reader, i, label));
    }
    if (more > 0)
        (void)snprintf(text + used, size - used, " and %zu more", more);
    return used > 0;
}

/// Name the columns of coordinates where that was a guess.
static bool note_coordinates(csv_reader *reader)
{
    const csv_columns *columns = reader->attributes->csv;
    const csv_choice *choice = &reader->choice;
    motion_channels known;
    csv_columns_channels(columns, reader->coordinate_count,
                         point_form_first(reader->builder.space.name, reader->builder.space.point_dim), &known);
    size_t channels = reader->number_count - reader->coordinate_count - motion_channels_count(&known);
    bool named = columns->names != NULL && !choice->by_place;
    bool guessed =
        named ? choice->spelled || (channels > 0 && !choice->degrees) : columns->names != NULL || columns->other_count > 0;
    static const int PLAIN_DIMENSION = 3;
    bool bare = columns->names == NULL && columns->other_count == 0 && reader->options->space == NULL &&
                reader->space_name[0] == '\0' && reader->coordinate_count > PLAIN_DIMENSION;
    if (bare && !reader->strict && !reader->chosen && !reader->tum)
        return attributes_note(reader->attributes,
                               "nothing names the columns: rows of %zu numbers are taken as points of R^%zu; a header, "
                               "named columns or a named format tell otherwise",
                               reader->coordinate_count, reader->coordinate_count);
    if (reader->strict || reader->chosen || reader->tum || !guessed)
        return true;
    static const char *const flat[] = {"x", "y", "z", "w"}, *const globe[] = {"longitude", "latitude", "altitude", "w"};
    char text[200] = "", label[EXCERPT_SIZE + 16];
    size_t used = 0;
    for (size_t i = 0; i < choice->count && i < MAX_NAMED_COORDINATES && used < sizeof text; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s = %s", used > 0 ? ", " : "",
                                 choice->degrees ? globe[i] : flat[i], csv_column_label(reader, choice->columns[i], label));
    if (choice->count > MAX_NAMED_COORDINATES && used < sizeof text)
        (void)snprintf(text + used, sizeof text - used, " and %zu more", choice->count - MAX_NAMED_COORDINATES);
    return attributes_note(reader->attributes, "columns: %s%s", text, choice->radians ? ", in radians" : "");
}

/// Name a column that may tell curves apart.
static bool note_group(csv_reader *reader)
{
    const csv_columns *columns = reader->attributes->csv;
    if (reader->group != BAT_NO_INDEX || columns->names == NULL || reader->strict || reader->builder.curve_count != 1)
        return true;
    for (size_t i = 0; i < reader->column_count; i++)
    {
        const column_state *state = &reader->columns[i];
        char label[EXCERPT_SIZE + 16];
        bool kind = state->kind == CSV_TEXT || (state->kind == CSV_NUMBER && !state->is_coordinate && !state->not_whole);
        if (!kind || !name_is_group(columns->names[i]) || state->changes == 0 ||
            2 * (state->changes + 1) > reader->row_count)
            continue;
        return attributes_note(reader->attributes, "column %s could group the rows into curves",
                               csv_column_label(reader, i, label));
    }
    return true;
}

/// Count tensors whose determinant is rounding beside that of a ball of their trace.
static bool note_flat_tensors(csv_reader *reader)
{
    static const double MIN_ROUND = 1e-12;
    const curve_builder *made = &reader->builder;
    size_t flat = 0, first = 0, dim = made->space.point_dim;
    for (size_t c = 0; c < made->curve_count && strcmp(made->space.name, "spd") == 0; c++)
        for (size_t i = 0; i < made->curves[c].count && (dim == 3 || dim == 6); i++)
        {
            const double *t = made->curves[c].points + i * dim; // xx, xy, yy or xx, xy, xz, yy, yz, zz
            double mean = dim == 3 ? (t[0] + t[2]) / 2 : (t[0] + t[3] + t[5]) / 3;
            double plane = dim == 3 ? t[0] * t[2] - t[1] * t[1]
                                    : t[0] * (t[3] * t[5] - t[4] * t[4]) - t[1] * (t[1] * t[5] - t[4] * t[2]) +
                                          t[2] * (t[1] * t[4] - t[3] * t[2]);
            if (plane < MIN_ROUND * pow(mean, dim == 3 ? 2 : 3) && flat++ == 0)
                first = i;
        }
    return flat == 0 ||
           attributes_note(reader->attributes,
                           "%zu tensor%s nearly singular, the first at point %zu: motions beside %s are uncertain", flat,
                           flat > 1 ? "s are" : " is", first, flat > 1 ? "them" : "it");
}

bool csv_note_columns(csv_reader *reader)
{
    char text[160];
    int decimals = reader->attributes->time_decimals;
    bool good = note_coordinates(reader);
    if (good && reader->left_count > 0)
        good = attributes_note(reader->attributes, "left out %zu column%s no part of a motion, the first '%s'",
                               reader->left_count, reader->left_count > 1 ? "s that are" : " that is", reader->left_name);
    if (good && reader->drop_short)
        good = attributes_note(reader->attributes,
                               "left out %zu curve%s with too few different points, the first ends on line %zu",
                               reader->short_count, reader->short_count > 1 ? "s" : "", reader->first_short);
    if (good && reader->left_rows > 0)
        good =
            attributes_note(reader->attributes, "left out %zu row%s the time of the row before, the first on line %zu",
                            reader->left_rows, reader->left_rows > 1 ? "s that have" : " that has", reader->first_left_row);
    if (good && decimals > 0)
        good = attributes_note(reader->attributes, "times in %s%s; rates and velocities count seconds",
                               exact_time_unit(decimals), reader->time_by_size ? ", by their size" : "");
    if (good && list_columns(reader, CSV_ID, text, sizeof text))
        good = attributes_note(
            reader->attributes,
            "column %s holds running numbers and is no coordinate; it is numbered anew where it is written", text);
    if (good && list_columns(reader, CSV_TEXT, text, sizeof text))
        good = attributes_note(reader->attributes,
                               "text in column %s: where it is written, new points take that of the point before", text);
    for (const csv_kind *kind = (const csv_kind[]){CSV_TIME, CSV_CLOCK, CSV_EMPTY}; good && *kind != CSV_EMPTY; kind++)
        if (list_columns(reader, *kind, text, sizeof text))
            good = attributes_note(reader->attributes,
                                   "times in column %s: where they are written, new points get times between", text);
    for (size_t i = 0; good && i < reader->column_count && !reader->strict; i++)
    {
        const column_state *state = &reader->columns[i];
        char label[EXCERPT_SIZE + 16];
        if (state->kind == CSV_GAPS)
            good = attributes_note(reader->attributes, "column %s has %zu empty cells, the first on line %zu",
                                   csv_column_label(reader, i, label), state->gaps, state->first_gap);
    }
    good = good && note_flat_tensors(reader);
    if (good && reader->comma)
        good = attributes_note(reader->attributes, "decimal commas were read as points");
    return good && note_group(reader);
}
