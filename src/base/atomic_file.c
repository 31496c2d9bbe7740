#define _GNU_SOURCE // realpath(), O_TMPFILE

#include "base/atomic_file.h"

#include "base/error.h"
#include "base/text_buffer.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static bat_status access_error(bat_error *error, int reason)
{
    return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot write: %s", strerror(reason));
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

/// Open a file without a name in the target's folder; -1 where that is not possible.
static int open_nameless(const char *target, mode_t mode)
{
    int descriptor = -1;
#ifdef O_TMPFILE
    const char *slash = strrchr(target, '/');
    char *folder = slash == NULL ? strdup(".") : strndup(target, (size_t)(slash - target) + 1);
    // Through this folder the file gets its name.
    if (folder != NULL && access("/proc/self/fd", X_OK) == 0)
        descriptor = open(folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, mode);
    free(folder);
#else
    (void)target;
    (void)mode;
#endif
    return descriptor;
}

static int link_nameless(int descriptor, const char *name)
{
    char nameless[48];
    (void)snprintf(nameless, sizeof nameless, "/proc/self/fd/%d", descriptor);
    return linkat(AT_FDCWD, nameless, AT_FDCWD, name, AT_SYMLINK_FOLLOW);
}

/// The rights, and where the system allows it the owner, of the file that is replaced.
static void keep_rights(int descriptor, const struct stat *existing)
{
    enum
    {
        RIGHTS = 0777,
        ALL_MODES = 07777 ///< with those that stand for the owner
    };
    bool owned = fchown(descriptor, existing->st_uid, existing->st_gid) == 0;
    (void)fchmod(descriptor, existing->st_mode & (owned ? ALL_MODES : RIGHTS));
}

/// Give the nameless file `descriptor` a hidden name, or with -1 make a file that has one, with the rights of `mode`.
/// @return the file's descriptor; -1 with errno on failure, and then `temporary` stays null
static int take_name(atomic_file *file, int descriptor, mode_t mode)
{
    enum
    {
        ATTEMPTS = 100
    };
    for (unsigned attempt = 0; attempt < ATTEMPTS; attempt++)
    {
        char *name = temporary_name(file->target, attempt);
        if (name == NULL)
            return -1;
        int named = descriptor;
        if (descriptor < 0)
            named = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        else if (link_nameless(descriptor, name) != 0)
            named = -1;
        if (named >= 0)
        {
            file->temporary = name;
            return named;
        }
        int reason = errno;
        free(name);
        errno = reason;
        if (reason != EEXIST)
            break;
    }
    return -1;
}

/// Open a new file in the target's folder, with the rights of the file it will replace or those that any new file gets.
static bat_status open_temporary(atomic_file *file, const struct stat *existing, bat_error *error)
{
    // Nobody else reads what replaces a file before it has that file's rights.
    mode_t mode = existing != NULL ? S_IRUSR | S_IWUSR : 0666;
    int descriptor = open_nameless(file->target, mode);
    if (descriptor < 0)
        descriptor = take_name(file, -1, mode);
    if (descriptor < 0)
        return access_error(error, errno);
    if (existing != NULL)
        keep_rights(descriptor, existing);
    file->stream = fdopen(descriptor, "wb");
    if (file->stream != NULL)
        return BAT_OK;
    (void)close(descriptor);
    if (file->temporary != NULL)
        (void)unlink(file->temporary);
    return error_memory(error, BUFSIZ);
}

static bat_status open_file(const char *path, atomic_file *file, bat_error *error)
{
    struct stat existing, link;
    bool exists = stat(path, &existing) == 0;
    if (!exists && lstat(path, &link) == 0)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot write: the link leads nowhere");
    if (exists && S_ISDIR(existing.st_mode))
        return access_error(error, EISDIR);
    if (exists && access(path, W_OK) != 0)
        return access_error(error, errno);
    if (exists && !S_ISREG(existing.st_mode))
    {
        file->stream = fopen(path, "wb");
        return file->stream != NULL ? BAT_OK : access_error(error, errno);
    }
    file->target = exists ? realpath(path, NULL) : strdup(path);
    if (file->target == NULL)
        return exists ? access_error(error, errno) : error_memory(error, strlen(path));
    return open_temporary(file, exists ? &existing : NULL, error);
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

/// Write out what is buffered; 0 or why it failed.
static int flush(FILE *stream)
{
    bool failed_before = ferror(stream) != 0;
    errno = 0;
    if (fflush(stream) == 0 && !failed_before)
        return 0;
    return errno != 0 ? errno : EIO;
}

static int shut(FILE *stream)
{
    errno = 0;
    if (stream == stdout || fclose(stream) == 0)
        return 0;
    return errno != 0 ? errno : EIO;
}

bat_status atomic_file_commit(atomic_file *file, bat_error *error)
{
    int reason = flush(file->stream);
    bool nameless = file->target != NULL && file->temporary == NULL;
    if (reason == 0 && nameless && take_name(file, fileno(file->stream), 0) < 0)
        reason = errno;
    int shut_reason = shut(file->stream);
    if (reason == 0)
        reason = shut_reason;
    if (reason == 0 && file->temporary != NULL && rename(file->temporary, file->target) != 0)
        reason = errno;
    if (reason != 0 && file->temporary != NULL)
        (void)unlink(file->temporary);
    forget(file);
    return reason == 0 ? BAT_OK : access_error(error, reason);
}

void atomic_file_abandon(atomic_file *file)
{
    if (file->stream != NULL)
        (void)shut(file->stream);
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
