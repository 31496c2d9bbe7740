#include "io/curve/csv.h"
#include "io/surface/cloud_formats.h"

#include <ctype.h>
#include <strings.h>

/// @file
/// Readers of points as text: comments about the boundary, XYZ and CSV.

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
        corners[k] = read ? (size_t)corner : 0;
    }
    return read && scan_line_done(&scan);
}

/// The text of a comment line, or null. PLY writes "comment" for '#'.
static const char *remark_words(const text_line *line)
{
    static const char comment[] = "comment ";
    size_t size = (size_t)(line->end - line->begin);
    if (size > 0 && *line->begin == '#')
        return line->begin + 1;
    return size >= sizeof comment - 1 && memcmp(line->begin, comment, sizeof comment - 1) == 0
               ? line->begin + sizeof comment - 1
               : NULL;
}

static bool is_word(const text_line *line, const char *word)
{
    size_t size = strlen(word);
    return (size_t)(line->end - line->begin) >= size && memcmp(line->begin, word, size) == 0;
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
            remarks.boundary = (size_t)count;
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

bat_status cloud_xyz_read(const file_text *text, point_listing *listing, bat_error *error)
{
    static const char *const missing[] = {"x", "y", "z"};
    word_scan scan = word_scan_start(text->data, text->size);
    while (scan_next_content(&scan))
    {
        size_t index = listing->count;
        double *point = listing_next(listing);
        if (point == NULL)
            return error_memory(error, listing->capacity * sizeof *point);
        for (size_t k = 0; k < 3; k++)
        {
            if (scan_line_done(&scan))
                return error_set(error, BAT_BAD_FILE, index, scan.line, "point %zu has no %s", index, missing[k]);
            if (!scan_number(&scan, &point[k]))
                return cloud_number_fault(scan.at, scan_word_end(&scan), index, scan.line, error);
        }
        if (!scan_next_line(&scan))
            break;
    }
    return BAT_OK;
}

size_t cloud_xyz_line_of_point(const file_text *text, size_t point)
{
    word_scan scan = word_scan_start(text->data, text->size);
    while (scan_next_content(&scan) && point-- > 0)
        (void)scan_next_line(&scan);
    return scan.line;
}

typedef struct csv_layout
{
    char separator;   ///< a comma, semicolon or tab, or a blank for runs of blanks
    size_t columns;   ///< columns of every row
    size_t places[3]; ///< the columns of x, y and z
    bool has_names;   ///< the first row contains names
} csv_layout;

static bat_status split_row(const file_text *text, const text_line *line, char separator, csv_field *fields, size_t *count,
                            bat_error *error)
{
    const char *fault = csv_split(text, line, separator, fields, count);
    for (size_t i = 0; fault == NULL && i < *count; i++)
        fields[i] = csv_unquoted(fields[i]);
    return fault == NULL ? BAT_OK : error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line->number, "%s", fault);
}

/// Find the columns from the first row: those named x, y and z if all exist, else the first three.
static bat_status find_layout(const file_text *text, const text_line *line, csv_layout *layout, bat_error *error)
{
    static const char *const names[] = {"x", "y", "z"};
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t places[3] = {SIZE_MAX, SIZE_MAX, SIZE_MAX};
    *layout = (csv_layout){.separator = csv_find_separator(line), .places = {0, 1, 2}, .has_names = true};
    bat_status status = split_row(text, line, layout->separator, fields, &layout->columns, error);
    for (size_t i = 0; i < layout->columns && status == BAT_OK; i++)
    {
        layout->has_names = layout->has_names && !number_resembles(fields[i].begin, fields[i].end);
        for (size_t k = 0; k < 3; k++)
            if (fields[i].end - fields[i].begin == 1 && strncasecmp(fields[i].begin, names[k], 1) == 0 &&
                places[k] == SIZE_MAX)
                places[k] = i;
    }
    if (layout->has_names && places[0] != SIZE_MAX && places[1] != SIZE_MAX && places[2] != SIZE_MAX)
        memcpy(layout->places, places, sizeof places);
    return status;
}

static bat_status read_row(const file_text *text, const csv_layout *layout, const text_line *line, point_listing *listing,
                           bat_error *error)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t index = listing->count, columns = 0;
    double *point = listing_next(listing);
    if (point == NULL)
        return error_memory(error, listing->capacity * sizeof *point);
    bat_status status = split_row(text, line, layout->separator, fields, &columns, error);
    for (size_t k = 0; k < 3 && status == BAT_OK && layout->places[k] < columns; k++)
    {
        csv_field value = fields[layout->places[k]];
        if (value.begin == value.end)
            status = error_set(error, BAT_BAD_FILE, index, line->number, "column %zu is empty", layout->places[k] + 1);
        else if (number_scan(value.begin, value.end, &point[k]) != value.end)
            status = cloud_number_fault(value.begin, value.end, index, line->number, error);
    }
    if (status == BAT_OK && columns != layout->columns)
        status = error_set(error, BAT_BAD_FILE, index, line->number, "%zu columns where the first row has %zu", columns,
                           layout->columns);
    return status;
}

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
    csv_layout layout;
    bat_status status = find_layout(text, &line, &layout, error);
    if (status == BAT_OK && layout.columns < 3)
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line.number, "%zu columns, but a point has 3 coordinates",
                           layout.columns);
    for (more = layout.has_names ? next_row(text, &line) : more; more && status == BAT_OK; more = next_row(text, &line))
        status = read_row(text, &layout, &line, listing, error);
    return status;
}

size_t cloud_csv_line_of_point(const file_text *text, size_t point)
{
    text_line line = text_line_start(text);
    bool more = next_row(text, &line);
    csv_layout layout;
    if (more && find_layout(text, &line, &layout, NULL) == BAT_OK && layout.has_names)
        point++;
    while (more && point-- > 0)
        more = next_row(text, &line);
    return line.number;
}
