#define _XOPEN_SOURCE 700 // realpath()

#include "io/atomic_file.h"

#include "base/error.h"
#include "io/text_buffer.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static bat_status access_error(bat_error *error, const char *path, int reason)
{
    return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot write %s: %s", path, strerror(reason));
}

static void forget(atomic_file *file)
{
    free(file->temporary);
    free(file->target);
    *file = (atomic_file){0};
}

/// A hidden name in the target's folder that nothing else has.
static char *temporary_name(const char *target, unsigned attempt)
{
    const char *slash = strrchr(target, '/');
    int folder = slash == NULL ? 0 : (int)(slash + 1 - target);
    struct timespec now = {0};
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    size_t size = strlen(target) + 48;
    char *name = malloc(size);
    if (name != NULL)
        (void)snprintf(name, size, "%.*s.batten-%ld-%lx%x", folder, target, (long)getpid(), (unsigned long)now.tv_nsec,
                       attempt);
    return name;
}

/// Open a new file beside the target, with the rights of the file it will replace or those that any new file gets.
static bat_status open_temporary(atomic_file *file, const struct stat *existing, const char *path, bat_error *error)
{
    enum
    {
        ATTEMPTS = 100
    };
    int descriptor = -1;
    for (unsigned attempt = 0; descriptor < 0 && attempt < ATTEMPTS; attempt++)
    {
        free(file->temporary);
        file->temporary = temporary_name(file->target, attempt);
        if (file->temporary == NULL)
            return error_memory(error, strlen(file->target));
        descriptor = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno != EEXIST)
            break;
    }
    if (descriptor < 0)
        return access_error(error, path, errno);
    if (existing != NULL)
        (void)fchmod(descriptor, existing->st_mode & 07777);
    file->stream = fdopen(descriptor, "wb");
    if (file->stream == NULL)
    {
        (void)close(descriptor);
        (void)unlink(file->temporary);
        return error_memory(error, BUFSIZ);
    }
    return BAT_OK;
}

static bat_status open_file(const char *path, atomic_file *file, bat_error *error)
{
    struct stat existing;
    bool exists = stat(path, &existing) == 0;
    if (exists && S_ISDIR(existing.st_mode))
        return access_error(error, path, EISDIR);
    if (exists && access(path, W_OK) != 0)
        return access_error(error, path, errno);
    if (exists && !S_ISREG(existing.st_mode))
    {
        file->stream = fopen(path, "wb");
        return file->stream != NULL ? BAT_OK : access_error(error, path, errno);
    }
    file->target = exists ? realpath(path, NULL) : strdup(path);
    if (file->target == NULL)
        return exists ? access_error(error, path, errno) : error_memory(error, strlen(path));
    return open_temporary(file, exists ? &existing : NULL, path, error);
}

bat_status atomic_file_begin(const char *path, atomic_file *file, bat_error *error)
{
    *file = (atomic_file){0};
    if (strcmp(path, "-") == 0)
    {
        file->stream = stdout;
        return BAT_OK;
    }
    bat_status status = open_file(path, file, error);
    if (status != BAT_OK)
        forget(file);
    return status;
}

/// Write out what is buffered and close; 0 or why it failed.
static int close_stream(FILE *stream)
{
    int reason = 0;
    if (ferror(stream))
        reason = EIO;
    errno = 0;
    if (fflush(stream) != 0)
        reason = errno != 0 ? errno : EIO;
    if (stream != stdout && fclose(stream) != 0 && reason == 0)
        reason = errno != 0 ? errno : EIO;
    return reason;
}

bat_status atomic_file_commit(atomic_file *file, bat_error *error)
{
    bat_status status = BAT_OK;
    int reason = close_stream(file->stream);
    if (reason == 0 && file->temporary != NULL && rename(file->temporary, file->target) != 0)
        reason = errno;
    if (reason != 0)
    {
        status = access_error(error, file->target != NULL ? file->target : "the output", reason);
        if (file->temporary != NULL)
            (void)unlink(file->temporary);
    }
    forget(file);
    return status;
}

void atomic_file_abandon(atomic_file *file)
{
    if (file->stream != NULL)
        (void)close_stream(file->stream);
    if (file->temporary != NULL)
        (void)unlink(file->temporary);
    forget(file);
}

bat_status atomic_file_end(atomic_file *file, bat_status status, bat_error *error)
{
    if (status == BAT_OK)
        return atomic_file_commit(file, error);
    atomic_file_abandon(file);
    return status;
}
