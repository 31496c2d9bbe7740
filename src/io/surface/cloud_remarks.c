#include "io/mesh/mesh_scan.h"
#include "io/surface/cloud_formats.h"

enum
{
    /// Larger counts than any file has.
    COUNT_BITS = 60
};

/// "N boundary points first", whatever follows.
static bool read_boundary(mesh_scan scan, uint64_t *count)
{
    return scan_count(&scan, (uint64_t)1 << COUNT_BITS, count) && scan_word(&scan, "boundary") &&
           scan_word(&scan, "points") && scan.end - scan.at >= 6 && memcmp(scan.at, " first", 6) == 0;
}

/// "corners A B C D".
static bool read_corners(mesh_scan scan, size_t corners[4])
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

/// Where the words of a remark begin; null when the line is none. PLY says "comment" for '#'.
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
        mesh_scan scan = mesh_scan_start(words, (size_t)(line.end - words));
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
