#include "io/common/file_text.h"
#include "io/surface/cloud_formats.h"

#include <ctype.h>
#include <strings.h>

/// @file
/// Readers of points as text: comments about the boundary, XYZ and CSV.

enum
{
    /// A bound above the counts of any file.
    COUNT_BITS = 60
};

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

/// The layout of a file, from its first row.
typedef struct csv_layout
{
    char separator;   ///< a comma, semicolon or tab, or a blank for runs of blanks
    size_t columns;   ///< columns of every row
    size_t places[3]; ///< the columns of x, y and z
    bool has_names;   ///< the first row contains names
} csv_layout;

/// A field of a row, without surrounding blanks and quotes.
typedef struct field
{
    const char *begin, *end;
} field;

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/// The field that begins at *at. *at advances to the next field, or becomes null after the last.
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

/// Find the columns from the first row: those named x, y and z if all exist, else the first three.
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

/// Read a field if it is a coordinate.
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

/// Advance to the next row.
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
