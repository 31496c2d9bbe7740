#include "base/file_bytes.h"

#include "base/error.h"

#include <errno.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

static const size_t CHUNK = 1 << 16; ///< bytes that are read together

/// All bytes of a stream, at most `max` of them.
static bat_status read_stream(FILE *file, unsigned long long max, text_buffer *buffer, bat_error *error)
{
    for (;;)
    {
        char *place = text_reserve(buffer, CHUNK);
        if (place == NULL)
            return error_memory(error, buffer->size);
        size_t got = fread(place, 1, buffer->capacity - buffer->size - 1, file);
        buffer->size += got;
        if (got == 0)
            break;
        if (buffer->size > max)
            return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot read: the input does not end after %llu bytes",
                             max);
    }
    return ferror(file) ? error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot read: %s", strerror(errno)) : BAT_OK;
}

/// Read an open file: a regular file to its end, of which there is one, and anything else up to `max` bytes.
static bat_status read_open(FILE *file, bool standard, unsigned long long max, text_buffer *buffer, bat_error *error)
{
    struct stat about;
    bool known = fstat(fileno(file), &about) == 0;
    bool device = known && (S_ISCHR(about.st_mode) || S_ISBLK(about.st_mode)) && isatty(fileno(file)) == 0;
    if (device && !standard)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot read: a device is no file");
    if (known && S_ISREG(about.st_mode) && about.st_size > 0)
    {
        (void)text_reserve(buffer, (size_t)about.st_size + CHUNK);
        if ((unsigned long long)about.st_size > max)
            max = (unsigned long long)about.st_size;
    }
    return read_stream(file, max, buffer, error);
}

bat_status file_bytes_read(const char *path, unsigned long long max, text_buffer *buffer, bat_error *error)
{
    bool standard = strcmp(path, "-") == 0;
    FILE *file = standard ? stdin : fopen(path, "rb");
    if (file == NULL)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot open: %s", strerror(errno));
    bat_status status = read_open(file, standard, max, buffer, error);
    if (!standard)
        (void)fclose(file);
    if (status != BAT_OK)
        text_free(buffer);
    return status;
}
