#include "io/mesh/mesh_scan.h"
#include "io/surface/cloud_formats.h"

#include <ctype.h>

bat_status cloud_number_fault(const char *begin, const char *end, size_t point, size_t line, bat_error *error)
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
    mesh_scan scan = mesh_scan_start(text->data, text->size);
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
    mesh_scan scan = mesh_scan_start(text->data, text->size);
    while (scan_next_content(&scan) && point-- > 0)
        (void)scan_next_line(&scan);
    return scan.line;
}
