#include "io/curve/csv.h"
#include "io/mesh/formats.h"
#include "io/surface/cloud_formats.h"

#include <ctype.h>
#include <math.h>

/// @file
/// Readers of points as text: comments about the boundary, XYZ, CSV and PTX.

/// A bound above the counts of any file.
static const int COUNT_BITS = 60;

/// Read "N boundary points first"; more text may follow.
static bool read_boundary(word_scan scan, uint64_t *count)
{
    return scan_count(&scan, (uint64_t)1 << COUNT_BITS, count) && scan_word(&scan, "boundary") &&
           scan_word(&scan, "points") && scan.end - scan.at >= 6 && memcmp(scan.at, " first", 6) == 0;
}

/// Read "corners A B C D".
static bool read_corners(word_scan scan, size_t corners[4])
{
    bool read = scan_word(&scan, "corners");
    for (int k = 0; k < 4 && read; k++)
    {
        uint64_t corner;
        read = scan_count(&scan, (uint64_t)1 << COUNT_BITS, &corner);
        corners[k] = read ? size_clipped(corner) : 0;
    }
    return read && scan_line_done(&scan);
}

static bool is_word(const text_line *line, const char *word)
{
    size_t size = strlen(word);
    return (size_t)(line->end - line->begin) >= size && memcmp(line->begin, word, size) == 0;
}

/// The text of a comment line, or null. PLY writes "comment" for '#'.
static const char *remark_words(const text_line *line)
{
    static const char *const signs[] = {"#", "comment "};
    for (int k = 0; k < 2; k++)
        if (is_word(line, signs[k]))
            return line->begin + strlen(signs[k]);
    return NULL;
}

cloud_remarks cloud_remarks_read(const file_text *text)
{
    cloud_remarks remarks = {0};
    text_line line = text_line_start(text);
    while (text_line_next(text, &line))
    {
        const char *words = remark_words(&line);
        if (words == NULL && line.begin < line.end && !is_word(&line, "ply") && !is_word(&line, "format "))
            break;
        if (words == NULL)
            continue;
        word_scan scan = word_scan_start(words, (size_t)(line.end - words));
        uint64_t count;
        if (remarks.boundary == 0 && read_boundary(scan, &count))
        {
            remarks.boundary = size_clipped(count);
            remarks.boundary_line = line.number;
        }
        remarks.has_corners = remarks.has_corners || read_corners(scan, remarks.corners);
    }
    return remarks;
}

/// The failure for a coordinate that is not a number.
static bat_status cloud_number_fault(const char *begin, const char *end, size_t point, size_t line, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    double value;
    const char *fault = number_read(begin, end, &value), *letter = begin + (begin < end && (*begin == '-' || *begin == '+'));
    (void)text_excerpt(excerpt, begin, end);
    if (number_resembles(begin, end) && letter < end && isalpha((unsigned char)*letter))
        return error_set(error, BAT_INVALID_POINT, point, line, "point %zu is not finite: '%s'", point, excerpt);
    return error_set(error, BAT_BAD_FILE, point, line, "'%s' %s", excerpt, fault != NULL ? fault : "is not a number");
}

/// How the rows of a text hold points.
typedef struct row_layout
{
    char separator;   ///< a comma, semicolon or tab, or a blank for runs of blanks
    bool is_free;     ///< blanks separate, and rows may differ in what follows the coordinates
    size_t columns;   ///< of the first row; of all rows, unless they are free
    size_t places[3]; ///< the columns of x, y and z
} row_layout;

/// A text whose rows are read one after another.
typedef struct row_reader
{
    const file_text *text;
    text_line line;        ///< the next row
    bool more;             ///< there is one
    text_line names;       ///< `begin` is null without
    text_line remark;      ///< the last one before the first row, without its sign; `begin` is null without
    bool spelled, counted; ///< the names are others than x, y and z; the first column counts the rows
    row_layout layout;
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t told, told_line, begun; ///< rows of a block that a line before them tells, line 0 without; rows before it
    size_t rows, missing;          ///< rows read, and those without coordinates
    bool comma;                    ///< a number has a decimal comma
} row_reader;

static void next_row(row_reader *reader)
{
    text_line *line = &reader->line;
    while ((reader->more = text_line_next(reader->text, line)) && (line->begin == line->end || *line->begin == '#'))
        if (reader->rows == 0 && line->begin < line->end)
            reader->remark = (text_line){csv_trimmed(line->begin + 1, line->end).begin, line->end, line->number, NULL};
}

static bat_status split_row(row_reader *reader, const text_line *line, char separator, size_t *count, bat_error *error)
{
    const char *fault = csv_split(reader->text, line, separator, reader->fields, count);
    for (size_t i = 0; fault == NULL && i < *count; i++)
        reader->fields[i] = csv_unquoted(reader->fields[i]);
    return fault == NULL ? BAT_OK : ERROR_FILE(error, line->number, "%s", fault);
}

/// Find the columns of the coordinates by their names.
static bat_status find_names(row_reader *reader, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    csv_columns columns = {0};
    if (!csv_columns_name(&columns, reader->fields, reader->layout.columns))
        return error_memory(error, reader->layout.columns * sizeof(char *));
    const column_names names = {columns.names, columns.count};
    const named_coordinates named = names_find_coordinates(&names, true), globe = names_find_coordinates(&names, false);
    csv_columns_free(&columns);
    reader->spelled = named.spelled;
    if (named.count < 3)
        return ERROR_FILE(error, reader->names.number, "the columns \"%s\" do not name x, y and z: %s",
                          text_excerpt(excerpt, reader->names.begin, reader->names.end),
                          globe.geographic ? "project longitude and latitude to lengths" : "rename them");
    memcpy(reader->layout.places, named.columns, sizeof reader->layout.places);
    return BAT_OK;
}

/// Use the remark before the first row where it names as many columns as that row has.
static void take_remark(row_reader *reader)
{
    size_t count = 0;
    reader->names = reader->remark;
    if (split_row(reader, &reader->names, csv_find_separator(&reader->names), &count, NULL) != BAT_OK ||
        count != reader->layout.columns || find_names(reader, NULL) != BAT_OK)
        reader->names.begin = NULL;
}

/// Take a row of names, which CloudCompare begins with two slashes.
static bat_status take_names(row_reader *reader, bool *taken, bat_error *error)
{
    text_line line = reader->line;
    size_t count = 0;
    bool slashes = is_word(&line, "//");
    line.begin += slashes ? 2 : 0;
    bat_status status = split_row(reader, &line, csv_find_separator(&line), &count, error);
    *taken = status == BAT_OK && reader->names.begin == NULL;
    for (size_t i = 0; i < count && *taken && !slashes; i++)
        *taken = !number_resembles(reader->fields[i].begin, reader->fields[i].end);
    if (!*taken)
        return status;
    reader->names = line;
    next_row(reader);
    return status;
}

/// Check that a block has as many rows as were told.
static bat_status end_block(const row_reader *reader, bat_error *error)
{
    size_t made = reader->rows - reader->begun;
    if (reader->told_line == 0 || reader->told == made)
        return BAT_OK;
    return ERROR_FILE(error, reader->told_line, "%zu points are announced, but %zu follow", reader->told, made);
}

/// Take a row that is the number of points that follow, as in PTS files and CloudCompare's.
static bat_status take_count(row_reader *reader, bool *taken, bat_error *error)
{
    int64_t value;
    bat_status status = BAT_OK;
    *taken = (reader->rows == 0 || reader->told_line > 0) &&
             csv_read_whole(csv_trimmed(reader->line.begin, reader->line.end), EXACT_DIGITS, &value) && value >= 0;
    if (!*taken)
        return BAT_OK;
    status = end_block(reader, error);
    reader->told = size_clipped((uint64_t)value);
    reader->told_line = reader->line.number;
    reader->begun = reader->rows;
    next_row(reader);
    return status;
}

/// Whether a row begins with three numbers between blanks.
static bool is_free_row(const text_line *line)
{
    word_scan scan = word_scan_start(line->begin, (size_t)(line->end - line->begin));
    double value;
    size_t found = 0;
    while (found < 3 && scan_number(&scan, &value))
        found++;
    return found == 3;
}

/// Whether the first column counts all rows, from 0 or 1.
static bool counts_rows(row_reader reader)
{
    double first = 0, value;
    for (size_t rows = 0; reader.more; next_row(&reader), rows++)
    {
        const char *begin = reader.line.begin + (*reader.line.begin == '"'),
                   *end = number_scan(begin, reader.line.end, &value);
        bool ends =
            end != NULL && end < reader.line.end && (*end == '"' || text_is_blank(*end) || *end == reader.layout.separator);
        first = rows == 0 && ends ? value : first;
        if (!ends || (first != 0 && first != 1) || value != first + (double)rows)
            return false;
    }
    return true;
}

/// Read what stands before the points, and find their columns: by their names, else the first three after a count of rows.
static bat_status find_layout(row_reader *reader, bat_error *error)
{
    bat_status status = BAT_OK;
    row_layout *layout = &reader->layout;
    next_row(reader);
    for (bool taken = true; taken && reader->more && status == BAT_OK;)
    {
        status = take_count(reader, &taken, error);
        if (status == BAT_OK && !taken && reader->more)
            status = take_names(reader, &taken, error);
    }
    if (status != BAT_OK || !reader->more)
        return status;
    *layout = (row_layout){.places = {0, 1, 2}};
    const char *begin = reader->line.begin, separator = csv_find_separator(&reader->line);
    // Tabs alone may have empty cells between them.
    bool mixed = separator != '\t' || memchr(begin, ' ', (size_t)(reader->line.end - begin)) != NULL;
    layout->is_free = separator == ' ' || (mixed && reader->names.begin == NULL && is_free_row(&reader->line));
    layout->separator = layout->is_free ? ' ' : separator;
    const text_line *first = reader->names.begin != NULL ? &reader->names : &reader->line;
    status = split_row(reader, first, csv_find_separator(first), &layout->columns, error);
    if (status == BAT_OK && layout->columns < 3 && !layout->is_free)
        status = ERROR_FILE(error, first->number, "%zu columns, but a point has 3 coordinates", layout->columns);
    if (status == BAT_OK && reader->names.begin == NULL && reader->remark.begin != NULL)
        take_remark(reader);
    else if (status == BAT_OK && reader->names.begin != NULL)
        status = find_names(reader, error);
    reader->counted = status == BAT_OK && reader->names.begin == NULL && layout->columns > 3 && counts_rows(*reader);
    for (size_t k = 0; k < 3 && reader->counted; k++)
        layout->places[k]++;
    return status;
}

/// Read the words of a row.
static bat_status split_free(row_reader *reader, size_t index, size_t *columns, bat_error *error)
{
    static const char *const missing[] = {"x", "y", "z"};
    const size_t *places = reader->layout.places;
    word_scan scan = word_scan_start(reader->line.begin, (size_t)(reader->line.end - reader->line.begin));
    size_t wanted = places[0] > places[1] ? places[0] : places[1];
    wanted = (wanted > places[2] ? wanted : places[2]) + 1;
    for (*columns = 0; *columns < wanted && !scan_line_done(&scan); scan.at = reader->fields[(*columns)++].end)
        reader->fields[*columns] = (csv_field){scan.at, scan_word_end(&scan)};
    for (size_t k = 0; k < 3; k++)
        if (places[k] >= *columns)
            return error_set(error, BAT_BAD_FILE, index, reader->line.number, "point %zu has no %s", index, missing[k]);
    return BAT_OK;
}

/// Read the row into a point; `missing` receives whether all its coordinates are.
static bat_status read_row(row_reader *reader, size_t index, double *point, bool *missing, bat_error *error)
{
    const row_layout *layout = &reader->layout;
    size_t columns = 0;
    bat_status status = layout->is_free ? split_free(reader, index, &columns, error)
                                        : split_row(reader, &reader->line, layout->separator, &columns, error);
    *missing = status == BAT_OK;
    for (size_t k = 0; k < 3 && *missing; k++)
        *missing = layout->places[k] < columns && csv_is_missing(reader->fields[layout->places[k]]);
    for (size_t k = 0; k < 3 && status == BAT_OK && !*missing && layout->places[k] < columns; k++)
    {
        csv_field value = reader->fields[layout->places[k]];
        if (value.begin == value.end)
            status =
                error_set(error, BAT_BAD_FILE, index, reader->line.number, "column %zu is empty", layout->places[k] + 1);
        else if (csv_read_number(value, layout->separator, &point[k], &reader->comma) != NULL)
            status = cloud_number_fault(value.begin, value.end, index, reader->line.number, error);
    }
    if (status == BAT_OK && columns != layout->columns && !layout->is_free)
        status = error_set(error, BAT_BAD_FILE, index, reader->line.number, "%zu columns where the first row has %zu",
                           columns, layout->columns);
    return status;
}

/// Read points up to number `last`, whose line `reader->line` is then.
static bat_status read_rows(row_reader *reader, size_t last, point_listing *listing, bat_error *error)
{
    bat_status status = find_layout(reader, error);
    while (reader->more && status == BAT_OK)
    {
        bool taken = false, missing = false;
        status = take_count(reader, &taken, error);
        if (taken || status != BAT_OK)
            continue;
        double *point = listing_next(listing);
        if (point == NULL)
            return error_memory(error, listing->capacity * sizeof *point);
        status = read_row(reader, listing->count - 1, point, &missing, error);
        listing->count -= missing;
        reader->missing += missing;
        reader->rows++;
        if (listing->count == last + 1 && !missing)
            return status;
        if (status == BAT_OK)
            next_row(reader);
    }
    return status == BAT_OK ? end_block(reader, error) : status;
}

/// Tell what was guessed and what was left out.
static bat_status note_rows(const row_reader *reader, bat_mesh_notes *notes, bat_error *error)
{
    const text_line *names = &reader->names;
    const size_t *places = reader->layout.places, columns = reader->layout.columns;
    char excerpt[EXCERPT_SIZE];
    bat_status status = BAT_OK;
    if (names->begin != NULL && (reader->spelled || columns > 3))
        status = mesh_note(notes, error, "columns %zu, %zu and %zu of \"%s\" are x, y and z", places[0] + 1, places[1] + 1,
                           places[2] + 1, text_excerpt(excerpt, names->begin, names->end));
    else if (reader->counted)
        status = mesh_note(notes, error, "the first column counts the points; the next three are x, y and z");
    else if (names->begin == NULL && columns > 3)
        status = mesh_note(notes, error, "the first three columns are x, y and z; the %zu others are not used", columns - 3);
    if (status == BAT_OK && reader->comma)
        status = mesh_note(notes, error, "numbers have decimal commas");
    return status == BAT_OK && reader->missing > 0
               ? mesh_note(notes, error, "%zu rows without coordinates are left out", reader->missing)
               : status;
}

bat_status cloud_rows_read(const file_text *text, const bat_cloud_read_options *options, point_listing *listing,
                           bat_error *error)
{
    row_reader reader = {.text = text, .line = text_line_start(text)};
    bat_status status = read_rows(&reader, SIZE_MAX - 1, listing, error);
    return status == BAT_OK ? note_rows(&reader, options->notes, error) : status;
}

size_t cloud_rows_line_of_point(const file_text *text, size_t point)
{
    point_listing listing = {0};
    row_reader reader = {.text = text, .line = text_line_start(text)};
    (void)read_rows(&reader, point, &listing, NULL);
    free(listing.points);
    return reader.line.number;
}

// PTX: scans, each a grid of points with a transformation, one after another.

enum
{
    PTX_FRAME = 28, ///< numbers of a scanner's place and axes, then of a matrix of four rows, by which points are multiplied
    PTX_MATRIX = 12
};

/// Read a line that has one whole number alone.
static bool scan_count_line(word_scan *scan, uint64_t *count)
{
    return scan_next_content(scan) && scan_count(scan, (uint64_t)1 << (COUNT_BITS / 2), count) && scan_line_done(scan);
}

bool cloud_ptx_resembles(const file_text *text)
{
    word_scan scan = word_scan_start(text->data, text->size);
    uint64_t rows, columns;
    return scan_count_line(&scan, &rows) && scan_count_line(&scan, &columns);
}

/// Read the next numbers, which go over lines.
static bat_status scan_numbers(word_scan *scan, size_t count, size_t index, double *numbers, bat_error *error)
{
    for (size_t k = 0; k < count; k++)
    {
        if (!scan_next_content(scan))
            return error_set(error, BAT_BAD_FILE, index, scan->line, "the file ends within a scan");
        if (!scan_number(scan, &numbers[k]))
            return cloud_number_fault(scan->at, scan_word_end(scan), index, scan->line, error);
    }
    return BAT_OK;
}

/// Read the points of a scan. Those at its origin are missing.
static bat_status read_scan(word_scan *scan, const double *matrix, uint64_t rows, size_t *missing, point_listing *listing,
                            bat_error *error)
{
    for (uint64_t i = 0; i < rows; i++)
    {
        double at[3];
        bat_status status = scan_numbers(scan, 3, listing->count, at, error);
        if (status != BAT_OK)
            return status;
        bool none = at[0] == 0 && at[1] == 0 && at[2] == 0;
        double *point = none ? NULL : listing_next(listing);
        if (point == NULL && !none)
            return error_memory(error, listing->capacity * sizeof *point);
        *missing += none;
        for (size_t k = 0; k < 3 && !none; k++)
        {
            point[k] = at[0] * matrix[k] + at[1] * matrix[4 + k] + at[2] * matrix[8 + k] + matrix[12 + k];
            if (!isfinite(point[k]))
                return error_set(error, BAT_INVALID_POINT, listing->count - 1, scan->line, "the point is not finite");
        }
        (void)scan_next_line(scan);
    }
    return BAT_OK;
}

bat_status cloud_ptx_read(const file_text *text, const bat_cloud_read_options *options, point_listing *listing,
                          bat_error *error)
{
    word_scan scan = word_scan_start(text->data, text->size);
    bat_status status = BAT_OK;
    size_t missing = 0;
    while (status == BAT_OK && scan_next_content(&scan))
    {
        uint64_t sides[2];
        double frame[PTX_FRAME];
        if (!scan_count_line(&scan, &sides[0]) || !scan_count_line(&scan, &sides[1]))
            return ERROR_FILE(error, scan.line, "a scan begins with the numbers of its columns and rows, each on a line");
        status = scan_numbers(&scan, PTX_FRAME, BAT_NO_INDEX, frame, error);
        (void)scan_next_line(&scan);
        if (status == BAT_OK)
            status = read_scan(&scan, frame + PTX_MATRIX, sides[0] * sides[1], &missing, listing, error);
    }
    return status == BAT_OK && missing > 0
               ? mesh_note(options->notes, error, "%zu places of the scan without a point are left out", missing)
               : status;
}
