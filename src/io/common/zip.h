#pragma once

#include "io/common/block_writer.h"
#include "io/common/file_text.h"

/// @file
/// ZIP archives, strictly: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification" 6.3, of which the parts are stored or
/// deflated, neither encrypted nor in several volumes. ZIP64 is read.

typedef struct zip_part
{
    const char *name; ///< `name_size` bytes of the archive
    size_t name_size;
    const unsigned char *bytes; ///< `stored` bytes of the archive
    uint64_t stored, size;      ///< bytes in the archive; bytes of the part itself
    uint32_t crc;
    bool deflated;
} zip_part;

/// Whether a file begins as an archive does.
bool zip_resembles(const file_text *text);

/// Find a part by its name, in letters of either case (OPC, ISO/IEC 29500-2). All entries are checked against the file.
/// @param part its `name` is null where there is none
/// @return BAT_OK; BAT_BAD_FILE, also where two parts have the name; or BAT_UNSUPPORTED
bat_status zip_find(const file_text *text, const char *name, zip_part *part, bat_error *error);

/// Receives the next bytes of a part; those of the last call may be none.
typedef bat_status zip_receiver(void *context, const char *bytes, size_t size, bool last, bat_error *error);

/// Inflate a part piece by piece. It must have the size and the checksum of the directory, and not be too large for its
/// stored bytes: text as programs write it is not deflated to less than a two-hundredth.
/// @return BAT_OK, BAT_BAD_FILE, BAT_TOO_LARGE, BAT_NO_MEMORY or what `receive` returns
bat_status zip_inflate(const zip_part *part, zip_receiver *receive, void *context, bat_error *error);

/// An archive being written. Begin with the sink alone.
typedef struct zip_writer
{
    text_sink *sink;
    text_buffer directory;
    uint64_t written;
    size_t count;
} zip_writer;

/// Write a part, deflated. The same bytes at any time: parts have the date 1980-01-01.
/// @return BAT_OK, BAT_TOO_LARGE (archives of 4 GiB), BAT_FILE_ACCESS or BAT_NO_MEMORY
bat_status zip_add(zip_writer *writer, const char *name, const text_buffer *content, bat_error *error);
/// Write the directory, and free it; does only the latter where `status` is a failure, which comes back.
bat_status zip_end(zip_writer *writer, bat_status status, bat_error *error);
