#include "io/common/bytes.h"
#include "io/mesh/formats.h"
#include "io/surface/cloud_formats.h"

#include <math.h>

/// @file
/// Reader of LAS files, versions 1.0 to 1.4, point formats 0 to 10 (ASPRS, "LAS specification 1.4 - R15", 2019). Coordinates
/// are x = scale X + offset. Points with the flag "withheld" are deleted, as the
/// specification says.

enum
{
    MIN_HEADER = 227,
    HEADER_14 = 375,
    POINT_FORMATS = 11,
    COMPRESSED = 0xC0 ///< bits of the point format that LASzip sets
};

/// Offsets in the header.
enum
{
    AT_MINOR = 25,
    AT_HEADER_SIZE = 94,
    AT_POINTS = 96,
    AT_FORMAT = 104,
    AT_RECORD = 105,
    AT_COUNT = 107,
    AT_SCALE = 131,
    AT_OFFSET = 155,
    AT_COUNT_14 = 247
};

typedef struct las_header
{
    size_t format, record, begin;
    uint64_t count;
    double scale[3], offset[3];
} las_header;

static bat_status read_header(const unsigned char *bytes, size_t size, las_header *header, bat_error *error)
{
    // Sizes of the records of formats 0 to 10.
    static const size_t RECORDS[POINT_FORMATS] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    if (size < MIN_HEADER || !cloud_las_resembles(&(file_text){.data = (char *)bytes, .size = size}))
        return ERROR_FILE(error, 0, "this is no LAS file: it does not begin with a header of LASF");
    size_t header_size = (size_t)bytes_whole(bytes + AT_HEADER_SIZE, 2, false), format = bytes[AT_FORMAT];
    if ((format & COMPRESSED) != 0)
        return ERROR_UNSUPPORTED(
            error, 0,
            "the points are compressed (LAZ), which Debian has no library for: batten.read_points in Python reads them, "
            "laszip and PDAL write LAS");
    if (bytes[AT_MINOR - 1] != 1 || bytes[AT_MINOR] > 4 || format >= POINT_FORMATS)
        return ERROR_UNSUPPORTED(error, 0,
                                 "version %d.%d with point format %zu is not supported, only 1.0 to 1.4 with 0 to 10",
                                 bytes[AT_MINOR - 1], bytes[AT_MINOR], format);
    *header = (las_header){.format = format,
                           .record = (size_t)bytes_whole(bytes + AT_RECORD, 2, false),
                           .begin = (size_t)bytes_whole(bytes + AT_POINTS, 4, false),
                           .count = bytes_whole(bytes + AT_COUNT, 4, false)};
    if (bytes[AT_MINOR] == 4 && header_size >= HEADER_14 && size >= HEADER_14)
        header->count = bytes_whole(bytes + AT_COUNT_14, 8, false);
    if (header->record < RECORDS[format])
        return ERROR_FILE(error, 0, "the records of points are shorter than their format");
    for (size_t d = 0; d < 3; d++)
    {
        header->scale[d] = bytes_real(bytes + AT_SCALE + 8 * d, 8, false);
        header->offset[d] = bytes_real(bytes + AT_OFFSET + 8 * d, 8, false);
        if (!isfinite(header->scale[d]) || !isfinite(header->offset[d]) || header->scale[d] == 0)
            return ERROR_FILE(error, 0, "a scale or an offset of the header is zero or not finite");
    }
    if (header->begin > size || header->count > (size - header->begin) / header->record)
        return ERROR_FILE(error, 0, "the file ends after %zu of %llu points",
                          header->begin > size ? 0 : (size - header->begin) / header->record,
                          (unsigned long long)header->count);
    return BAT_OK;
}

/// The class of a point, and whether it is deleted: bits of its classification, or from format 6 on of its flags.
static unsigned class_of(const unsigned char *point, size_t format, bool *withheld)
{
    enum
    {
        FLAGS = 15,
        CLASS = 0x1F,
        WITHHELD = 0x80,
        WITHHELD_14 = 0x04,
        FORMAT_14 = 6
    };
    *withheld = (point[FLAGS] & (format < FORMAT_14 ? WITHHELD : WITHHELD_14)) != 0;
    return format < FORMAT_14 ? point[FLAGS] & CLASS : point[FLAGS + 1];
}

bool las_classes_read(const char *list, bool wanted[LAS_CLASSES])
{
    word_scan scan = word_scan_start(list, strlen(list));
    uint64_t class = 0;
    memset(wanted, 0, LAS_CLASSES * sizeof *wanted);
    for (bool more = true; more; scan.at++)
    {
        if (!scan_digits_below(&scan, LAS_CLASSES, &class))
            return false;
        wanted[class] = true;
        more = *scan.at == ',';
        if (!more)
            break;
    }
    return scan.at == scan.end;
}

bool cloud_las_resembles(const file_text *text)
{
    return text->size >= 4 && memcmp(text->data, "LASF", 4) == 0;
}

bat_status cloud_las_read(const file_text *text, const bat_cloud_read_options *options, point_listing *listing,
                          bat_error *error)
{
    static const unsigned NOISE[] = {7, 18};
    const unsigned char *bytes = (const unsigned char *)text->data;
    bool wanted[LAS_CLASSES];
    size_t withheld_count = 0, others = 0;
    las_header header = {0};
    bat_status status = read_header(bytes, text->size, &header, error);
    memset(wanted, 1, sizeof wanted);
    wanted[NOISE[0]] = wanted[NOISE[1]] = false;
    if (options->classes != NULL)
        (void)las_classes_read(options->classes, wanted);
    for (size_t i = 0; status == BAT_OK && i < header.count; i++)
    {
        const unsigned char *record = bytes + header.begin + i * header.record;
        bool withheld;
        unsigned class = class_of(record, header.format, &withheld);
        withheld_count += withheld;
        others += !withheld && !wanted[class];
        if (withheld || !wanted[class])
            continue;
        double *point = listing_next(listing);
        if (point == NULL)
            return error_memory(error, listing->count * 3 * sizeof *point);
        for (size_t d = 0; d < 3; d++)
        {
            point[d] = (int32_t)bytes_whole(record + 4 * d, 4, false) * header.scale[d] + header.offset[d];
            if (!isfinite(point[d]))
                return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu is not finite", i);
        }
    }
    if (status == BAT_OK && listing->count == 0 && others > 0)
        return ERROR_FILE(error, 0, "none of the %zu points has a class that is read", others);
    if (status == BAT_OK && others > 0)
        status = mesh_note(options->notes, error, "%zu points of %s are left out", others,
                           options->classes != NULL ? "other classes" : "the classes 7 and 18, noise,");
    return status == BAT_OK && withheld_count > 0
               ? mesh_note(options->notes, error, "%zu points that are withheld are left out", withheld_count)
               : status;
}
