#include "io/common/zip.h"

#include "io/common/bytes.h"

#include <strings.h>
#include <zlib.h>

/// The signatures and the sizes of the records, without the texts that follow them.
enum
{
    LOCAL = 0x04034b50,
    LOCAL_SIZE = 30,
    ENTRY = 0x02014b50,
    ENTRY_SIZE = 46,
    END = 0x06054b50,
    END_SIZE = 22,
    END64 = 0x06064b50,
    END64_SIZE = 56,
    LOCATOR64 = 0x07064b50,
    LOCATOR64_SIZE = 20,
    EXTRA64 = 1, ///< the extra field of ZIP64
    DEFLATED = 8,
    ENCRYPTED = 1,
    UTF8_NAMES = 1 << 11,
    VERSION = 20,
    DATE = (1 << 5) + 1 ///< 1980-01-01
};

static size_t u16_at(const unsigned char *bytes)
{
    return (size_t)bytes_whole(bytes, 2, false);
}

typedef struct zip_reader
{
    const unsigned char *bytes;
    size_t size;
    uint64_t at, end; ///< the next entry; the end of the directory
    uint64_t count;   ///< of entries
} zip_reader;

static bat_status fault(bat_error *error, const char *what)
{
    return ERROR_FILE(error, 0, "the ZIP archive %s", what);
}

bool zip_resembles(const file_text *text)
{
    return text->size >= LOCAL_SIZE && bytes_u32((const unsigned char *)text->data) == LOCAL;
}

/// Whether `size` bytes from `begin` on lie before `end`.
static bool fits(uint64_t begin, uint64_t size, uint64_t end)
{
    return begin <= end && size <= end - begin;
}

/// Find the directory by the record at the file's end, behind which a comment may stand.
static bat_status open_directory(const file_text *text, zip_reader *reader, bat_error *error)
{
    const unsigned char *bytes = (const unsigned char *)text->data;
    size_t size = text->size, end = size >= END_SIZE ? size - END_SIZE : 0;
    while (end > 0 && (bytes_u32(bytes + end) != END || u16_at(bytes + end + 20) != size - end - END_SIZE) &&
           size - end <= END_SIZE + UINT16_MAX)
        end--;
    if (size < END_SIZE || bytes_u32(bytes + end) != END)
        return fault(error, "has no end: the file is cut off");
    uint64_t count = u16_at(bytes + end + 10), directory = bytes_u32(bytes + end + 12), begin = bytes_u32(bytes + end + 16);
    uint64_t limit = end;
    bool large = count == UINT16_MAX || directory == UINT32_MAX || begin == UINT32_MAX;
    if (large && end >= LOCATOR64_SIZE && bytes_u32(bytes + end - LOCATOR64_SIZE) == LOCATOR64)
    {
        limit = bytes_whole(bytes + end - LOCATOR64_SIZE + 8, 8, false);
        if (!fits(limit, END64_SIZE, end) || bytes_u32(bytes + limit) != END64)
            return fault(error, "has no ZIP64 record where its locator points");
        count = bytes_whole(bytes + limit + 32, 8, false);
        directory = bytes_whole(bytes + limit + 40, 8, false);
        begin = bytes_whole(bytes + limit + 48, 8, false);
    }
    else if (u16_at(bytes + end + 4) != 0 || u16_at(bytes + end + 6) != 0)
        return ERROR_UNSUPPORTED(error, 0, "the ZIP archive has several volumes");
    if (!fits(begin, directory, limit) || count > directory / ENTRY_SIZE)
        return fault(error, "has a directory that lies outside the file");
    *reader = (zip_reader){.bytes = bytes, .size = size, .at = begin, .end = begin + directory, .count = count};
    return BAT_OK;
}

/// Take from the extra field of ZIP64 the numbers that 32 bits do not hold.
static bool read_extra(const unsigned char *extra, size_t size, uint64_t *const numbers[3])
{
    const unsigned char *end = extra + size, *found = NULL;
    size_t found_size = 0;
    while (end - extra >= 4 && u16_at(extra + 2) <= (size_t)(end - extra - 4))
    {
        if (u16_at(extra) == EXTRA64)
        {
            found = extra + 4;
            found_size = u16_at(extra + 2);
        }
        extra += 4 + u16_at(extra + 2);
    }
    for (int i = 0; i < 3; i++)
        if (*numbers[i] == UINT32_MAX && found_size >= 8)
        {
            *numbers[i] = bytes_whole(found, 8, false);
            found += 8;
            found_size -= 8;
        }
        else if (*numbers[i] == UINT32_MAX && found != NULL)
            return false;
    return true;
}

/// Read the next entry of the directory, and check it against the part's own header.
static bat_status next_part(zip_reader *reader, zip_part *part, bat_error *error)
{
    const unsigned char *entry = reader->bytes + reader->at;
    if (!fits(reader->at, ENTRY_SIZE, reader->end) || bytes_u32(entry) != ENTRY)
        return fault(error, "has a directory with a broken entry");
    size_t name = u16_at(entry + 28), extra = u16_at(entry + 30), comment = u16_at(entry + 32);
    if (!fits(reader->at, ENTRY_SIZE + name + extra + comment, reader->end))
        return fault(error, "has a directory with a broken entry");
    uint64_t stored = bytes_u32(entry + 20), size = bytes_u32(entry + 24), begin = bytes_u32(entry + 42);
    size_t method = u16_at(entry + 10);
    *part = (zip_part){
        .name = (const char *)entry + ENTRY_SIZE, .name_size = name, .crc = bytes_u32(entry + 16), .deflated = method != 0};
    char excerpt[EXCERPT_SIZE];
    (void)text_excerpt(excerpt, part->name, part->name + name);
    if ((u16_at(entry + 8) & ENCRYPTED) != 0 || (method != 0 && method != DEFLATED))
        return ERROR_UNSUPPORTED(error, 0, "the part '%s' of the ZIP archive is %s", excerpt,
                                 method != 0 && method != DEFLATED ? "compressed by another method than DEFLATE"
                                                                   : "encrypted");
    if (!read_extra(entry + ENTRY_SIZE + name, extra, (uint64_t *const[]){&size, &stored, &begin}) ||
        !fits(begin, LOCAL_SIZE, reader->size) || bytes_u32(reader->bytes + begin) != LOCAL)
        return ERROR_FILE(error, 0, "the part '%s' is not where the ZIP archive's directory says", excerpt);
    const unsigned char *local = reader->bytes + begin;
    size_t local_name = u16_at(local + 26), header = LOCAL_SIZE + local_name + u16_at(local + 28);
    if (!fits(begin, header, reader->size) || !fits(begin + header, stored, reader->size) || local_name != name ||
        memcmp(local + LOCAL_SIZE, part->name, name) != 0 || (method == 0 && stored != size))
        return ERROR_FILE(error, 0, "the part '%s' has another name or size than in the ZIP archive's directory", excerpt);
    part->bytes = local + header;
    part->stored = stored;
    part->size = size;
    reader->at += ENTRY_SIZE + name + extra + comment;
    return BAT_OK;
}

bat_status zip_find(const file_text *text, const char *name, zip_part *part, bat_error *error)
{
    zip_reader reader = {0};
    bat_status status = open_directory(text, &reader, error);
    size_t size = strlen(name);
    *part = (zip_part){0};
    for (uint64_t i = 0; status == BAT_OK && i < reader.count; i++)
    {
        zip_part next;
        status = next_part(&reader, &next, error);
        if (status != BAT_OK || next.name_size != size || strncasecmp(next.name, name, size) != 0)
            continue;
        if (part->name != NULL)
            return ERROR_FILE(error, 0, "the ZIP archive has two parts '%.60s'", name);
        *part = next;
    }
    return status;
}

static bat_status part_fault(const zip_part *part, bat_status status, const char *what, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    return error_set(error, status, BAT_NO_INDEX, 0, "the part '%s' of the ZIP archive %s",
                     text_excerpt(excerpt, part->name, part->name + part->name_size), what);
}

/// Hand the bytes of a stream on until it ends.
static bat_status inflate_stream(const zip_part *part, z_stream *stream, zip_receiver *receive, void *context,
                                 bat_error *error)
{
    unsigned char out[1 << 14];
    uint64_t left = part->stored, total = 0;
    uLong crc = crc32(0, NULL, 0);
    int outcome = part->size == 0 && part->stored == 0 ? Z_STREAM_END : Z_OK;
    bat_status status = BAT_OK;
    stream->next_in = (unsigned char *)(uintptr_t)part->bytes;
    while (outcome != Z_STREAM_END && status == BAT_OK)
    {
        if (stream->avail_in == 0)
            left -= stream->avail_in = left < (1 << 30) ? (uInt)left : 1 << 30;
        stream->next_out = out;
        stream->avail_out = sizeof out;
        outcome = inflate(stream, Z_NO_FLUSH);
        size_t made = sizeof out - stream->avail_out;
        if (outcome == Z_MEM_ERROR)
            return error_memory(error, sizeof out);
        if ((outcome != Z_OK && outcome != Z_STREAM_END) ||
            (made == 0 && outcome == Z_OK && stream->avail_in == 0 && left == 0))
            return part_fault(part, BAT_BAD_FILE, "is not valid DEFLATE data", error);
        total += made;
        crc = crc32(crc, out, (uInt)made);
        if (total > part->size)
            return part_fault(part, BAT_BAD_FILE, "is larger than its directory says", error);
        status = receive(context, (const char *)out, made, false, error);
    }
    if (status == BAT_OK && (total != part->size || crc != part->crc))
        status = part_fault(part, BAT_BAD_FILE,
                            total != part->size ? "is smaller than its directory says" : "is damaged: its checksum differs",
                            error);
    return status == BAT_OK ? receive(context, "", 0, true, error) : status;
}

bat_status zip_inflate(const zip_part *part, zip_receiver *receive, void *context, bat_error *error)
{
    enum
    {
        MAX_RATIO = 200,
        ALWAYS = 1 << 20 ///< as many bytes are no danger
    };
    if (part->size > ALWAYS && part->size / MAX_RATIO > part->stored)
        return part_fault(part, BAT_TOO_LARGE, "would inflate to more than 200 times its size", error);
    if (part->deflated)
    {
        z_stream stream = {0};
        if (inflateInit2(&stream, -MAX_WBITS) != Z_OK)
            return error_memory(error, sizeof stream);
        bat_status status = inflate_stream(part, &stream, receive, context, error);
        (void)inflateEnd(&stream);
        return status;
    }
    uLong crc = crc32(0, NULL, 0);
    for (uint64_t at = 0, step; at < part->size; at += step)
    {
        step = part->size - at < (1 << 20) ? part->size - at : 1 << 20;
        crc = crc32(crc, part->bytes + at, (uInt)step);
        bat_status status = receive(context, (const char *)part->bytes + at, (size_t)step, false, error);
        if (status != BAT_OK)
            return status;
    }
    return crc == part->crc ? receive(context, "", 0, true, error)
                            : part_fault(part, BAT_BAD_FILE, "is damaged: its checksum differs", error);
}

static char *put(char *out, uint64_t value, size_t size)
{
    return bytes_put(out, value, size, false);
}

/// What the header of a part and its entry in the directory share: 26 bytes from the version to the extra field's size.
static char *put_common(char *out, const char *name, uint64_t stored, const text_buffer *content, uLong crc)
{
    out = put(put(put(out, VERSION, 2), UTF8_NAMES, 2), DEFLATED, 2);
    out = put(put(out, 0, 2), DATE, 2);
    out = put(put(put(out, crc, 4), stored, 4), content->size, 4);
    return put(put(out, strlen(name), 2), 0, 2);
}

static bat_status deflate_text(const text_buffer *content, text_buffer *deflated, bat_error *error)
{
    z_stream stream = {0};
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return error_memory(error, sizeof stream);
    uLong bound = deflateBound(&stream, (uLong)content->size);
    char *out = text_reserve(deflated, bound);
    if (out != NULL && bound <= UINT32_MAX)
    {
        stream.next_in = (unsigned char *)content->data;
        stream.avail_in = (uInt)content->size;
        stream.next_out = (unsigned char *)out;
        stream.avail_out = (uInt)bound;
        (void)deflate(&stream, Z_FINISH);
        text_advance(deflated, (const char *)stream.next_out);
    }
    (void)deflateEnd(&stream);
    return out != NULL ? BAT_OK : error_memory(error, bound);
}

bat_status zip_add(zip_writer *writer, const char *name, const text_buffer *content, bat_error *error)
{
    char local[LOCAL_SIZE], entry[ENTRY_SIZE];
    text_buffer out = {0}, deflated = {0};
    if (content->failed)
        return error_memory(error, content->size);
    bat_status status = content->size < UINT32_MAX / 2 ? deflate_text(content, &deflated, error) : BAT_TOO_LARGE;
    if (status == BAT_TOO_LARGE || writer->written + deflated.size > UINT32_MAX - UINT16_MAX)
        status = ERROR_TOO_LARGE(error, "the part '%.60s' is too large for a ZIP archive", name);
    if (status == BAT_OK)
    {
        uLong crc = crc32_z(crc32(0, NULL, 0), (const unsigned char *)content->data, content->size);
        (void)put_common(put(local, LOCAL, 4), name, deflated.size, content, crc);
        char *end = put_common(put(put(entry, ENTRY, 4), VERSION, 2), name, deflated.size, content, crc);
        end = put(put(put(put(end, 0, 2), 0, 2), 0, 2), 0, 4); // comment, volume, attributes
        (void)put(end, writer->written, 4);
        text_append(&out, local, sizeof local);
        text_append_string(&out, name);
        text_append(&out, deflated.data, deflated.size);
        text_append(&writer->directory, entry, sizeof entry);
        text_append_string(&writer->directory, name);
        writer->written += out.size;
        writer->count++;
    }
    text_free(&deflated);
    return sink_take(writer->sink, &out, status, error);
}

bat_status zip_end(zip_writer *writer, bat_status status, bat_error *error)
{
    char end[END_SIZE] = {0};
    size_t size = writer->directory.size;
    (void)put(put(put(put(put(put(end, END, 4), 0, 4), writer->count, 2), writer->count, 2), size, 4), writer->written, 4);
    text_append(&writer->directory, end, sizeof end);
    return sink_take(writer->sink, &writer->directory, status, error);
}
