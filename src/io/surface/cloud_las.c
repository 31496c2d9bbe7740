#include "io/surface/cloud_formats.h"

#include <math.h>

/// @file
/// Reader of LAS files, versions 1.0 to 1.4, point formats 0 to 10 (ASPRS, "LAS specification 1.4 - R15", 2019). Coordinates
/// are x = scale X + offset. Points with the flag "withheld" are deleted, as the specification says.

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

static uint64_t whole(const unsigned char *bytes, size_t size)
{
    uint64_t value = 0;
    for (size_t k = size; k-- > 0;)
        value = value << 8 | bytes[k];
    return value;
}

static double real(const unsigned char *bytes)
{
    const uint64_t bits = whole(bytes, sizeof bits);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int32_t coordinate(const unsigned char *bytes)
{
    const uint32_t bits = (uint32_t)whole(bytes, sizeof bits);
    int32_t value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

typedef struct las_header
{
    size_t format, record, begin;
    uint64_t count;
    double scale[3], offset[3];
} las_header;

static bat_status bad(bat_error *error, const char *what)
{
    return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "%s", what);
}

static bat_status read_header(const unsigned char *bytes, size_t size, las_header *header, bat_error *error)
{
    // Sizes of the records of formats 0 to 10.
    static const size_t RECORDS[POINT_FORMATS] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    if (size < MIN_HEADER || !cloud_las_resembles(&(file_text){.data = (char *)bytes, .size = size}))
        return bad(error, "this is no LAS file: it does not begin with a header of LASF");
    size_t header_size = (size_t)whole(bytes + AT_HEADER_SIZE, 2), format = bytes[AT_FORMAT];
    if ((format & COMPRESSED) != 0)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "the points are compressed (LAZ), which is not supported; laszip or PDAL write LAS");
    if (bytes[AT_MINOR - 1] != 1 || bytes[AT_MINOR] > 4 || format >= POINT_FORMATS)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "version %d.%d with point format %zu is not supported, only 1.0 to 1.4 with 0 to 10",
                         bytes[AT_MINOR - 1], bytes[AT_MINOR], format);
    *header = (las_header){.format = format,
                           .record = (size_t)whole(bytes + AT_RECORD, 2),
                           .begin = (size_t)whole(bytes + AT_POINTS, 4),
                           .count = whole(bytes + AT_COUNT, 4)};
    if (bytes[AT_MINOR] == 4 && header_size >= HEADER_14 && size >= HEADER_14)
        header->count = whole(bytes + AT_COUNT_14, 8);
    if (header->record < RECORDS[format])
        return bad(error, "the records of points are shorter than their format");
    for (size_t d = 0; d < 3; d++)
    {
        header->scale[d] = real(bytes + AT_SCALE + 8 * d);
        header->offset[d] = real(bytes + AT_OFFSET + 8 * d);
        if (!isfinite(header->scale[d]) || !isfinite(header->offset[d]) || header->scale[d] == 0)
            return bad(error, "a scale or an offset of the header is zero or not finite");
    }
    if (header->begin > size || header->count > (size - header->begin) / header->record)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "the file ends after %zu of %llu points",
                         header->begin > size ? 0 : (size - header->begin) / header->record,
                         (unsigned long long)header->count);
    return BAT_OK;
}

/// Whether a point is deleted: a bit of its classification, or from format 6 on of its flags.
static bool is_withheld(const unsigned char *point, size_t format)
{
    enum
    {
        FLAGS = 15,
        WITHHELD = 0x80,
        WITHHELD_14 = 0x04,
        FORMAT_14 = 6
    };
    return (point[FLAGS] & (format < FORMAT_14 ? WITHHELD : WITHHELD_14)) != 0;
}

bool cloud_las_resembles(const file_text *text)
{
    return text->size >= 4 && memcmp(text->data, "LASF", 4) == 0;
}

bat_status cloud_las_read(const file_text *text, point_listing *listing, bat_error *error)
{
    const unsigned char *bytes = (const unsigned char *)text->data;
    las_header header = {0};
    bat_status status = read_header(bytes, text->size, &header, error);
    for (size_t i = 0; status == BAT_OK && i < header.count; i++)
    {
        const unsigned char *record = bytes + header.begin + i * header.record;
        if (is_withheld(record, header.format))
            continue;
        double *point = listing_next(listing);
        if (point == NULL)
            return error_memory(error, listing->count * 3 * sizeof *point);
        for (size_t d = 0; d < 3; d++)
        {
            point[d] = coordinate(record + 4 * d) * header.scale[d] + header.offset[d];
            if (!isfinite(point[d]))
                return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu is not finite", i);
        }
    }
    return status;
}
