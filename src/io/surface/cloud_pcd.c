#include "io/common/bytes.h"
#include "io/surface/cloud_formats.h"

#include <math.h>

/// @file
/// Reader of PCD files, version .7 (Point Cloud Library, "The PCD (Point Cloud Data) file format"): text, binary, and binary
/// compressed by LZF. Points with a coordinate that is not a number mark missing measurements.

enum
{
    MAX_FIELDS = 64,
    MAX_FIELD_COUNT = 1 << 20,
    COUNT_BITS = 40
};

typedef enum pcd_encoding
{
    PCD_TEXT,
    PCD_BINARY,
    PCD_COMPRESSED
} pcd_encoding;

/// A field of a point: `count` numbers of `size` bytes.
typedef struct pcd_field
{
    size_t size, count, offset; ///< offset in the record, in bytes; in text in words
    char type;
} pcd_field;

typedef struct pcd_header
{
    pcd_field fields[MAX_FIELDS];
    size_t field_count, sizes, types, counts; ///< the lengths of the lists
    size_t axes[3];                           ///< fields; SIZE_MAX for none
    size_t width, height, points;
    bool has_points, has_data;
    pcd_encoding encoding;
    size_t record; ///< bytes, or words of text, of a point
} pcd_header;

static void read_fields(word_scan *scan, pcd_header *header)
{
    static const char *const AXES[] = {"x", "y", "z"};
    header->field_count = 0;
    for (int d = 0; d < 3; d++)
        header->axes[d] = SIZE_MAX;
    while (!scan_line_done(scan) && header->field_count < MAX_FIELDS)
    {
        const char *end = scan_word_end(scan);
        for (int d = 0; d < 3; d++)
            if (end - scan->at == 1 && *scan->at == *AXES[d])
                header->axes[d] = header->field_count;
        header->fields[header->field_count++] = (pcd_field){.size = 4, .count = 1, .type = 'F'};
        scan->at = end;
    }
}

static size_t read_list(word_scan *scan, pcd_header *header, bool sizes)
{
    size_t made = 0;
    uint64_t value;
    for (; made < header->field_count && scan_count(scan, MAX_FIELD_COUNT, &value); made++)
        *(sizes ? &header->fields[made].size : &header->fields[made].count) = (size_t)value;
    return made;
}

static size_t read_types(word_scan *scan, pcd_header *header)
{
    size_t made = 0;
    for (; made < header->field_count && !scan_line_done(scan); made++)
    {
        header->fields[made].type = *scan->at;
        scan->at = scan_word_end(scan);
    }
    return made;
}

static bat_status read_encoding(word_scan *scan, pcd_header *header, bat_error *error)
{
    header->has_data = true;
    if (scan_word(scan, "ascii"))
        header->encoding = PCD_TEXT;
    else if (scan_word(scan, "binary"))
        header->encoding = PCD_BINARY;
    else if (scan_word(scan, "binary_compressed"))
        header->encoding = PCD_COMPRESSED;
    else
        return ERROR_FILE(error, scan->line, "DATA is none of ascii, binary and binary_compressed");
    return BAT_OK;
}

static bat_status read_size(word_scan *scan, size_t *size, bat_error *error)
{
    uint64_t value;
    if (!scan_count(scan, (uint64_t)1 << COUNT_BITS, &value))
        return scan_number_fault(scan, BAT_NO_INDEX, "a whole number", error);
    *size = size_clipped(value);
    return BAT_OK;
}

/// Read an entry of the header. Others, such as VERSION and VIEWPOINT, are skipped.
static bat_status read_entry(word_scan *scan, pcd_header *header, bat_error *error)
{
    if (scan_word(scan, "FIELDS") || scan_word(scan, "COLUMNS"))
        read_fields(scan, header);
    else if (scan_word(scan, "SIZE"))
        header->sizes = read_list(scan, header, true);
    else if (scan_word(scan, "TYPE"))
        header->types = read_types(scan, header);
    else if (scan_word(scan, "COUNT"))
        header->counts = read_list(scan, header, false);
    else if (scan_word(scan, "WIDTH"))
        return read_size(scan, &header->width, error);
    else if (scan_word(scan, "HEIGHT"))
        return read_size(scan, &header->height, error);
    else if (scan_word(scan, "POINTS"))
    {
        header->has_points = true;
        return read_size(scan, &header->points, error);
    }
    else if (scan_word(scan, "DATA"))
        return read_encoding(scan, header, error);
    return BAT_OK;
}

/// Check the header, and set offsets and the number of points.
static bat_status finish_header(size_t line, pcd_header *header, bat_error *error)
{
    if (header->axes[0] == SIZE_MAX || header->axes[1] == SIZE_MAX || header->axes[2] == SIZE_MAX)
        return ERROR_FILE(error, line, "FIELDS does not name x, y and z");
    if (header->sizes != header->field_count || header->types != header->field_count ||
        (header->counts != 0 && header->counts != header->field_count))
        return ERROR_FILE(error, line, "SIZE, TYPE or COUNT has not one entry for each field");
    for (size_t f = 0; f < header->field_count; f++)
    {
        pcd_field *field = &header->fields[f];
        field->offset = header->record;
        header->record += header->encoding == PCD_TEXT ? field->count : field->size * field->count;
    }
    for (int d = 0; d < 3; d++)
    {
        const pcd_field *field = &header->fields[header->axes[d]];
        if (field->type != 'F' || field->count != 1 || (field->size != 4 && field->size != 8))
            return ERROR_UNSUPPORTED(error, line, "x, y or z is not one floating-point number of 4 or 8 bytes");
    }
    if (!header->has_points && size_multiply_overflows(header->width, header->height, &header->points))
        return ERROR_FILE(error, line, "WIDTH times HEIGHT is too large");
    return BAT_OK;
}

static bat_status read_header(word_scan *scan, pcd_header *header, bat_error *error)
{
    *header = (pcd_header){.axes = {SIZE_MAX, SIZE_MAX, SIZE_MAX}, .height = 1};
    while (!header->has_data)
    {
        if (!scan_next_content(scan))
            return ERROR_FILE(error, scan->line, "the header has no line DATA");
        bat_status status = read_entry(scan, header, error);
        if (status != BAT_OK)
            return status;
        if (header->has_data)
        {
            status = finish_header(scan->line, header, error);
            (void)scan_next_line(scan);
            return status;
        }
        if (!scan_next_line(scan))
            return ERROR_FILE(error, scan->line, "the header has no line DATA");
    }
    return BAT_OK;
}

/// Keep a point that was read, unless a coordinate is not a number.
static void keep_point(point_listing *listing)
{
    const double *point = listing->points + 3 * (listing->count - 1);
    if (isnan(point[0]) || isnan(point[1]) || isnan(point[2]))
        listing->count--;
}

static bat_status read_text(word_scan *scan, const pcd_header *header, point_listing *listing, bat_error *error)
{
    for (size_t i = 0; i < header->points; i++, (void)scan_next_line(scan))
    {
        if (!scan_next_content(scan))
            return error_set(error, BAT_BAD_FILE, i, scan->line, "the file ends after %zu of %zu points", i, header->points);
        double *point = listing_next(listing);
        if (point == NULL)
            return error_memory(error, listing->count * 3 * sizeof *point);
        for (size_t word = 0; word < header->record; word++)
        {
            double value;
            if (scan_word(scan, "nan") || scan_word(scan, "NaN") || scan_word(scan, "-nan"))
                value = NAN;
            else if (!scan_number(scan, &value))
                return scan_number_fault(scan, i, "a number for each field", error);
            for (int d = 0; d < 3; d++)
                if (header->fields[header->axes[d]].offset == word)
                    point[d] = value;
        }
        keep_point(listing);
    }
    return BAT_OK;
}

/// Read points from bytes. The records follow each other; of compressed data, the fields do.
static bat_status decode_points(const unsigned char *bytes, const pcd_header *header, point_listing *listing,
                                bat_error *error)
{
    for (size_t i = 0; i < header->points; i++)
    {
        double *point = listing_next(listing);
        if (point == NULL)
            return error_memory(error, listing->count * 3 * sizeof *point);
        for (int d = 0; d < 3; d++)
        {
            const pcd_field *field = &header->fields[header->axes[d]];
            size_t at = header->encoding == PCD_COMPRESSED ? field->offset * header->points + i * field->size
                                                           : i * header->record + field->offset;
            point[d] = bytes_real(bytes + at, field->size, false);
        }
        for (int d = 0; d < 3; d++)
            if (isinf(point[d]))
                return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu is not finite", i);
        keep_point(listing);
    }
    return BAT_OK;
}

/// Decompress LZF (Lehmann, LibLZF, 2000): literal bytes and copies of earlier output. False unless `size` bytes come out.
static bool decompress(const unsigned char *in, size_t in_size, unsigned char *out, size_t size)
{
    size_t at = 0, made = 0;
    while (at < in_size)
    {
        size_t control = in[at++];
        if (control < 32)
        {
            size_t run = control + 1;
            if (run > in_size - at || run > size - made)
                return false;
            memcpy(out + made, in + at, run);
            at += run;
            made += run;
            continue;
        }
        size_t length = control >> 5;
        if (length == 7)
        {
            if (at == in_size)
                return false;
            length += in[at++];
        }
        if (at == in_size)
            return false;
        size_t back = ((control & 31) << 8 | in[at++]) + 1;
        length += 2;
        if (back > made || length > size - made)
            return false;
        for (size_t k = 0; k < length; k++, made++)
            out[made] = out[made - back];
    }
    return made == size;
}

static bat_status read_compressed(const unsigned char *bytes, size_t left, const pcd_header *header, size_t wanted,
                                  point_listing *listing, bat_error *error)
{
    static const size_t SIZES = 8;
    uint64_t size = left >= SIZES ? bytes_whole(bytes, 4, false) : 0;
    if (left < SIZES || size > left - SIZES || bytes_whole(bytes + 4, 4, false) != wanted)
        return ERROR_FILE(error, 0, "the compressed data is not that of %zu points", header->points);
    unsigned char *data = memory_array(wanted, 1);
    if (data == NULL)
        return error_memory(error, wanted);
    bat_status status = decompress(bytes + SIZES, (size_t)size, data, wanted)
                            ? decode_points(data, header, listing, error)
                            : ERROR_FILE(error, 0, "the compressed data is damaged");
    free(data);
    return status;
}

bool cloud_pcd_resembles(const file_text *text)
{
    word_scan scan = word_scan_start(text->data, text->size);
    return scan_next_content(&scan) && (scan_word(&scan, "VERSION") || scan_word(&scan, "FIELDS"));
}

bat_status cloud_pcd_read(const file_text *text, const bat_cloud_read_options *options, point_listing *listing,
                          bat_error *error)
{
    (void)options;
    word_scan scan = word_scan_start(text->data, text->size);
    pcd_header header;
    bat_status status = read_header(&scan, &header, error);
    if (status != BAT_OK)
        return status;
    if (header.encoding == PCD_TEXT)
        return read_text(&scan, &header, listing, error);
    size_t left = (size_t)(scan.end - scan.at), wanted;
    const unsigned char *bytes = (const unsigned char *)scan.at;
    if (size_multiply_overflows(header.points, header.record, &wanted))
        return ERROR_FILE(error, 0, "the points are too many");
    status = header.encoding == PCD_COMPRESSED ? file_text_points(text, text->size, header.points, error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    if (header.encoding == PCD_COMPRESSED)
        return read_compressed(bytes, left, &header, wanted, listing, error);
    if (left < wanted)
        return ERROR_FILE(error, 0, "the file ends after %zu of %zu points", left / header.record, header.points);
    return decode_points(bytes, &header, listing, error);
}
