#include "io/curve/csv.h"

#include "io/common/time_text.h"
#include "linalg/vector.h"

#include <strings.h>

/// A place this near to a row is the row.
static const double ROUNDING = 1e-9;
/// Below both, a double has more digits between two numbers than nine decimals.
static const int64_t FINE_STEP = 1000000, DOUBLE_UNITS = 1000000000000000;

bool cells_add(cell_builder *cells, csv_field cell)
{
    size_t size = (size_t)(cell.end - cell.begin);
    if (cells->row_count > 0)
    {
        size_t above = cells->offsets[cells->offset_count - cells->columns];
        const char *text = cells->text.data + above;
        if (strncmp(text, cell.begin, size) == 0 && text[size] == '\0')
            return ARRAY_ADD(cells->offsets, cells->offset_capacity, cells->offset_count, above);
    }
    if (!ARRAY_ADD(cells->offsets, cells->offset_capacity, cells->offset_count, cells->text.size))
        return false;
    text_append(&cells->text, cell.begin, size);
    text_append(&cells->text, "", 1);
    return !cells->text.failed;
}

void cells_drop_row(cell_builder *cells)
{
    cells->row_count--;
    cells->offset_count -= cells->columns;
}

bool cells_end_curve(cell_builder *cells, bool closed)
{
    if (!ARRAY_GROW(cells->first_rows, cells->first_capacity, cells->curve_count + 2) ||
        !ARRAY_GROW(cells->closed, cells->closed_capacity, cells->curve_count + 1))
        return false;
    if (cells->curve_count == 0)
        cells->first_rows[0] = 0;
    cells->closed[cells->curve_count] = closed;
    cells->first_rows[++cells->curve_count] = cells->row_count;
    return true;
}

void cells_finish(cell_builder *cells, csv_cells *result)
{
    *result =
        (csv_cells){cells->columns, cells->curve_count, cells->first_rows, cells->closed, cells->offsets, cells->text.data};
    *cells = (cell_builder){0};
}

void cells_free(cell_builder *cells)
{
    text_free(&cells->text);
    free(cells->offsets);
    free(cells->first_rows);
    free(cells->closed);
    *cells = (cell_builder){0};
}

void cells_place(size_t k, size_t n, bool closed, double place[CSV_PLACE_CHANNELS])
{
    double angle = ANGLE_TURN * (double)k / (double)n;
    place[0] = closed ? cos(angle) : (double)k;
    place[1] = closed ? sin(angle) : 0;
}

/// The place that the channels of a point alone tell, without regard to its neighbours.
static double raw_place(const double *channels, size_t n, bool closed)
{
    double place = channels[0];
    if (closed)
    {
        place = atan2(channels[1], channels[0]) / ANGLE_TURN * (double)n;
        place += place < 0 ? (double)n : 0;
        // From the angle to the share of the edge, a chord of the circle.
        double row = floor(place), share = place - row, edge = ANGLE_TURN / (double)n;
        if (share > 0)
            place = row + sin(share * edge) / (sin(share * edge) + sin((1 - share) * edge));
    }
    if (fabs(place - nearbyint(place)) <= ROUNDING)
        place = closed && nearbyint(place) == (double)n ? 0 : nearbyint(place);
    double last = closed ? nextafter((double)n, 0) : (double)(n - 1);
    return place > 0 ? fmin(place, last) : 0;
}

/// The row whose place is exactly that of a point, or BAT_NO_INDEX.
static size_t row_of(const double *channels, size_t n, bool closed, double place)
{
    double expected[CSV_PLACE_CHANNELS];
    size_t row = (size_t)(place + 0.5);
    if (row == n)
        row = 0;
    cells_place(row, n, closed, expected);
    for (size_t i = 0; i < CSV_PLACE_CHANNELS; i++)
        if (expected[i] != channels[i])
            return BAT_NO_INDEX;
    return row;
}

/// Whether an edge has as many pieces as halving it again and again gives.
static bool is_power_of_two(size_t pieces)
{
    return (pieces & (pieces - 1)) == 0;
}

void cells_places(const csv_cells *cells, const bat_curve *curve, size_t curve_index, double *places)
{
    size_t rows = curve_index < cells->curves ? cells->first_rows[curve_index + 1] - cells->first_rows[curve_index] : 0;
    size_t before = BAT_NO_INDEX, row_before = BAT_NO_INDEX, first = BAT_NO_INDEX, first_row = 0;
    for (size_t i = 0; i < curve->count; i++)
    {
        if (rows == 0)
        {
            places[i] = NAN;
            continue;
        }
        bool closed = cells->closed[curve_index];
        const double *channels = curve->channels + (i + 1) * curve->channel_count - CSV_PLACE_CHANNELS;
        places[i] = raw_place(channels, rows, closed);
        size_t row = row_of(channels, rows, closed, places[i]);
        if (row == BAT_NO_INDEX)
            continue;
        places[i] = (double)row;
        size_t next = row_before + 1 == rows && closed ? 0 : row_before + 1;
        bool halved = before != BAT_NO_INDEX && row == next && is_power_of_two(i - before);
        for (size_t j = before; halved && j < i; j++)
            places[j] = (double)row_before + (double)(j - before) / (double)(i - before);
        before = i;
        row_before = row;
        if (first == BAT_NO_INDEX)
        {
            first = i;
            first_row = row;
        }
    }
    // The last edge of a closed curve.
    bool around = rows > 0 && first == 0 && curve->closed && cells->closed[curve_index] &&
                  row_before + 1 == (first_row == 0 ? rows : first_row) && is_power_of_two(curve->count - before);
    for (size_t j = before; around && j < curve->count; j++)
        places[j] = (double)row_before + (double)(j - before) / (double)(curve->count - before);
}

static bool is_quoted(const char *cell)
{
    size_t last = strlen(cell);
    if (last < 2 || *cell != '"' || cell[--last] != '"')
        return false;
    for (size_t i = 1; i < last; i++)
        if (cell[i] == '"' && (cell[++i] != '"' || i == last))
            return false;
    return true;
}

void cells_write_text(const char *cell, bool alone, text_buffer *text)
{
    if (is_quoted(cell) || strpbrk(cell, alone ? " ,;\t\"" : ",;\t\"") == NULL)
    {
        text_append_string(text, cell);
        return;
    }
    text_append(text, "\"", 1);
    for (; *cell != '\0'; cell++)
        text_append(text, *cell == '"' ? "\"\"" : cell, *cell == '"' ? 2 : 1);
    text_append(text, "\"", 1);
}

static void write_time(const char *from, const char *to, double share, text_buffer *text)
{
    iso_time a, b;
    csv_field first = csv_text(from), second = csv_text(to);
    if (!iso_time_read(first.begin, first.end, &a) || !iso_time_read(second.begin, second.end, &b))
        return;
    bool quoted = *from == '"';
    char *out = text_reserve(text, ISO_TIME_SIZE + 2);
    if (out == NULL)
        return;
    double step = (double)(b.nanoseconds - a.nanoseconds);
    if (quoted)
        *out++ = '"';
    out = iso_time_write(out, &a, a.nanoseconds + (int64_t)llrint(share * step));
    if (quoted)
        *out++ = '"';
    text_advance(text, out);
}

static void write_between(const char *from, const char *to, double share, text_buffer *text)
{
    double a, b;
    bool comma;
    int64_t first, last, step;
    csv_field start = csv_text(from), end = csv_text(to);
    for (int lost = 0; lost <= EXACT_TIME_DECIMALS; lost += 3) // of nine decimals, where the numbers are large
    {
        bool exact =
            exact_time_read(start.begin, start.end, lost, &first) && exact_time_read(end.begin, end.end, lost, &last);
        if (!exact || __builtin_sub_overflow(last, first, &step))
            continue;
        if (llabs(step) < FINE_STEP && llabs(first) < DOUBLE_UNITS)
            break;
        text_append_fixed(text, "", first + llrint(share * (double)step), EXACT_TIME_DECIMALS - lost);
        return;
    }
    if (csv_read_number(csv_text(from), ',', &a, &comma) != NULL || csv_read_number(csv_text(to), ',', &b, &comma) != NULL)
        return;
    text_append_real(text, "", (1 - share) * a + share * b);
}

static const char *cell_at(const csv_cells *cells, size_t row, size_t column)
{
    return cells->text + cells->offsets[row * cells->columns + column];
}

void cells_write(const csv_cells *cells, csv_kind kind, size_t column, size_t curve_index, double place, text_buffer *text)
{
    if (curve_index >= cells->curves || kind == CSV_EMPTY)
        return;
    size_t first = cells->first_rows[curve_index], rows = cells->first_rows[curve_index + 1] - first;
    size_t row = kind == CSV_GROUP || !(place >= 0) ? 0 : (size_t)place;
    double share = kind == CSV_GROUP || !(place >= 0) ? 0 : place - (double)row;
    const char *cell = cell_at(cells, first + row, column), *next = cell_at(cells, first + (row + 1) % rows, column);
    if (kind == CSV_TIME && share > 0)
        write_time(cell, next, share, text);
    else if ((kind == CSV_GAPS || kind == CSV_CLOCK) && share > 0)
        write_between(cell, next, share, text);
    else
        cells_write_text(cell, false, text);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

csv_field csv_trimmed(const char *begin, const char *end)
{
    while (begin < end && (is_blank(*begin) || *begin == '\r'))
        begin++;
    while (end > begin && (is_blank(end[-1]) || end[-1] == '\r'))
        end--;
    return (csv_field){begin, end};
}

/// Whether a separator is there outside quotes, and the fields that it makes have at most one comma each.
static bool separates(const text_line *line, char separator, bool *few_commas)
{
    bool quoted = false, found = false;
    size_t commas = 0;
    *few_commas = true;
    for (const char *at = line->begin; at < line->end; at++)
    {
        quoted = quoted != (*at == '"');
        if (quoted)
            continue;
        commas += *at == ',' ? 1 : 0;
        if (*at == separator)
        {
            found = true;
            commas = 0;
        }
        *few_commas = *few_commas && commas <= 1;
    }
    return found;
}

char csv_find_separator(const text_line *line)
{
    bool few, unused, comma = separates(line, ',', &unused);
    for (const char *candidate = ";\t"; *candidate != '\0'; candidate++)
        if (separates(line, *candidate, &few) && (!comma || few))
            return *candidate;
    return comma ? ',' : ' ';
}

/// The end of the field that begins at `at`; null for a quote that does not end.
static const char *field_end(const char *at, const char *end, char separator)
{
    const char *inner = at;
    while (inner < end && is_blank(*inner) && *inner != separator)
        inner++;
    if (inner < end && *inner == '"')
    {
        // A quote within quotes is doubled.
        do
        {
            inner = memchr(inner + 1, '"', (size_t)(end - inner - 1));
            if (inner == NULL)
                return NULL;
            inner++;
        } while (inner < end && *inner == '"');
        at = inner;
    }
    if (separator != ' ')
    {
        const char *found = memchr(at, separator, (size_t)(end - at));
        return found != NULL ? found : end;
    }
    while (at < end && !is_blank(*at))
        at++;
    return at;
}

const char *csv_split(const file_text *text, const text_line *line, char separator, csv_field *fields, size_t *count)
{
    const char *at = line->begin, *end = line->end;
    if (separator == '\t')
    {
        while (at > text->data && is_blank(at[-1]))
            at--;
        while (is_blank(*end)) // the text ends with a zero
            end++;
    }
    for (*count = 0;;)
    {
        const char *stop = field_end(at, end, separator);
        if (stop == NULL)
            return "a quote does not end on its line";
        if (*count == BAT_SPACE_MAX_DIM)
            return "more than 1024 columns";
        fields[(*count)++] = csv_trimmed(at, stop);
        if (stop == end)
            return NULL;
        at = stop + 1;
        while (separator == ' ' && is_blank(*at))
            at++;
    }
}

csv_field csv_unquoted(csv_field field)
{
    if (field.end - field.begin >= 2 && *field.begin == '"' && field.end[-1] == '"')
        return csv_trimmed(field.begin + 1, field.end - 1);
    return field;
}

csv_field csv_text(const char *text)
{
    return csv_unquoted((csv_field){text, text + strlen(text)});
}

const char *csv_field_fault(csv_field field)
{
    static const char mark[] = "\xEF\xBB\xBF";
    size_t size = (size_t)(field.end - field.begin);
    if (size > 0 && memchr(field.begin, '\0', size) != NULL)
        return "has a zero byte";
    bool marked = size >= sizeof mark - 1 && memcmp(field.begin, mark, sizeof mark - 1) == 0;
    return marked ? "has a byte order mark" : NULL;
}

#define LONGEST 64 ///< characters of a number

const char *csv_read_number(csv_field field, char separator, double *value, bool *comma)
{
    field = csv_unquoted(field);
    if (field.begin == field.end)
        return "is empty";
    const char *fault = number_read(field.begin, field.end, value);
    size_t size = (size_t)(field.end - field.begin);
    if (fault == NULL || separator == ',' || size > LONGEST)
        return fault;
    char text[LONGEST];
    memcpy(text, field.begin, size);
    char *point = memchr(text, ',', size);
    if (point == NULL || memchr(text, '.', size) != NULL)
        return fault;
    *point = '.';
    if (number_read(text, text + size, value) != NULL)
        return fault;
    *comma = true;
    return NULL;
}

bool csv_is_missing(csv_field field)
{
    static const char *const words[] = {"na", "n/a", "nan", "null", "none"};
    field = csv_unquoted(field);
    size_t size = (size_t)(field.end - field.begin);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strlen(words[i]) == size && strncasecmp(field.begin, words[i], size) == 0)
            return true;
    return size == 0;
}

bool csv_read_whole(csv_field field, int max_digits, int64_t *value)
{
    bool negative = field.begin < field.end && *field.begin == '-';
    uint64_t made = 0;
    field.begin += negative;
    if (field.begin == field.end || field.end - field.begin > max_digits)
        return false;
    for (const char *at = field.begin; at < field.end; at++)
    {
        if (*at < '0' || *at > '9')
            return false;
        made = 10 * made + (uint64_t)(*at - '0');
    }
    if (made > INT64_MAX)
        return false;
    *value = negative ? -(int64_t)made : (int64_t)made;
    return true;
}
