#define _GNU_SOURCE // realpath(), O_TMPFILE

#include "base/atomic_file.h"

#include "base/error.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/// The beginning of all hidden names.
static const char HIDDEN[] = ".batten-";

bat_status atomic_access_error(bat_error *error, int reason)
{
    return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot write: %s", strerror(reason));
}

static void forget(atomic_file *file)
{
    free(file->temporary);
    free(file->target);
    *file = (atomic_file){0};
}

const char *atomic_base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == NULL ? path : slash + 1;
}

char *atomic_folder_of(const char *path)
{
    size_t length = (size_t)(atomic_base_name(path) - path);
    return length == 0 ? strdup(".") : strndup(path, length);
}

char *atomic_hidden_name(const char *target, unsigned attempt, int descriptor)
{
    static const int LONGEST = 160; ///< of the part of the target's name that is kept, since file systems bound the length
    const char *base = atomic_base_name(target);
    size_t length = strlen(base);
    const char *kept = length > LONGEST ? base + length - LONGEST : base;
    struct timespec now = {0};
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    size_t size = strlen(target) + sizeof HIDDEN + 64;
    char *name = malloc(size);
    if (name != NULL)
        (void)snprintf(name, size, "%.*s%s%ld-%lx-%x-%x.%s", (int)(base - target), target, HIDDEN, (long)getpid(),
                       (unsigned long)now.tv_nsec, attempt, (unsigned)(descriptor + 1), kept);
    return name;
}

bool atomic_is_hidden(const char *path)
{
    return strncmp(atomic_base_name(path), HIDDEN, sizeof HIDDEN - 1) == 0;
}

int atomic_open_nameless(const char *target BAT_UNUSED, mode_t mode BAT_UNUSED)
{
    int descriptor = -1;
#ifdef O_TMPFILE
    char *folder = atomic_folder_of(target);
    // Through /proc/self/fd the file gets its name.
    if (folder != NULL && access("/proc/self/fd", X_OK) == 0)
        descriptor = open(folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, mode);
    free(folder);
#else
#endif
    return descriptor;
}

/// The parts of a hidden name; false for another one.
static bool read_hidden(const char *path, long *process, unsigned *descriptor)
{
    int end = 0;
    const char *base = atomic_base_name(path);
    if (!atomic_is_hidden(path))
        return false;
    // Names with other numbers have no such file.
    // NOLINTNEXTLINE(cert-err34-c): the text is checked to its end
    (void)sscanf(base + sizeof HIDDEN - 1, "%ld-%*x-%*x-%x.%n", process, descriptor, &end);
    return end > 0;
}

/// A copy of the open file without a name that a hidden name of this process stands for, emptied; -1 for none.
static int open_parked(const char *path)
{
    long process;
    unsigned number;
    struct stat about;
    if (!read_hidden(path, &process, &number) || process != (long)getpid() || number == 0 ||
        fstat((int)number - 1, &about) != 0 || !S_ISREG(about.st_mode) || about.st_nlink != 0)
        return -1;
    int copy = fcntl((int)number - 1, F_DUPFD_CLOEXEC, 0);
    if (copy >= 0 && lseek(copy, 0, SEEK_SET) == 0 && ftruncate(copy, 0) == 0)
        return copy;
    if (copy >= 0)
        (void)close(copy);
    return -1;
}

int atomic_link_nameless(int descriptor, const char *name)
{
    char nameless[48];
    (void)snprintf(nameless, sizeof nameless, "/proc/self/fd/%d", descriptor);
    return linkat(AT_FDCWD, nameless, AT_FDCWD, name, AT_SYMLINK_FOLLOW);
}

void atomic_keep_rights(int descriptor, const struct stat *about, bool owner)
{
    enum
    {
        RIGHTS = 0777,
        ALL_MODES = 07777 ///< with those that stand for the owner
    };
    bool owned = owner && fchown(descriptor, about->st_uid, about->st_gid) == 0;
    (void)fchmod(descriptor, about->st_mode & (owned ? ALL_MODES : RIGHTS));
}

/// Give the nameless file `descriptor` a hidden name in the target's folder, or with -1 make a file there with the rights of
/// `mode`.
/// @return the file's descriptor; -1 with errno on failure, where `temporary` stays null
static int take_name(atomic_file *file, int descriptor, mode_t mode)
{
    static const int ATTEMPTS = 100;
    for (unsigned attempt = 0; attempt < ATTEMPTS; attempt++)
    {
        // A file that already goes to a hidden name needs no other.
        bool final = atomic_is_hidden(file->target);
        char *name = final ? strdup(file->target) : atomic_hidden_name(file->target, attempt, -1);
        if (name == NULL)
            return -1;
        if (final)
            (void)unlink(name);
        int named = descriptor < 0                                ? open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode)
                    : atomic_link_nameless(descriptor, name) == 0 ? descriptor
                                                                  : -1;
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
    mode_t mode = existing != NULL || atomic_is_hidden(file->target) ? S_IRUSR | S_IWUSR : 0666;
    int descriptor = open_parked(file->target);
    file->parked = descriptor >= 0;
    if (descriptor < 0)
        descriptor = atomic_open_nameless(file->target, mode);
    if (descriptor < 0)
        descriptor = take_name(file, -1, mode);
    if (descriptor < 0)
        return atomic_access_error(error, errno);
    if (existing != NULL)
        atomic_keep_rights(descriptor, existing, true);
    file->stream = fdopen(descriptor, "wb");
    if (file->stream != NULL)
        return BAT_OK;
    (void)close(descriptor);
    if (file->temporary != NULL)
        (void)unlink(file->temporary);
    return error_memory(error, BUFSIZ);
}

bat_status atomic_target_find(const char *path, atomic_target *target, bat_error *error)
{
    struct stat link;
    *target = (atomic_target){.path = NULL};
    target->exists = stat(path, &target->existing) == 0;
    if (!target->exists && lstat(path, &link) == 0)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot write: the link leads nowhere");
    if (target->exists && S_ISDIR(target->existing.st_mode))
        return atomic_access_error(error, EISDIR);
    if (target->exists && access(path, W_OK) != 0)
        return atomic_access_error(error, errno);
    // Names of what is open: a file that stands behind one is written through it, never replaced.
    bool device = strncmp(path, "/dev/", 5) == 0 || strncmp(path, "/proc/", 6) == 0;
    if (target->exists && (!S_ISREG(target->existing.st_mode) || device))
        return BAT_OK;
    target->path = target->exists ? realpath(path, NULL) : strdup(path);
    if (target->path != NULL)
        return BAT_OK;
    return target->exists ? atomic_access_error(error, errno) : error_memory(error, strlen(path));
}

bat_status atomic_file_begin(const char *path, atomic_file *file, bat_error *error)
{
    *file = (atomic_file){0};
    if (strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0)
    {
        file->stream = stdout;
        return BAT_OK;
    }
    atomic_target target;
    bat_status status = atomic_target_find(path, &target, error);
    if (status != BAT_OK)
        return status;
    file->target = target.path;
    if (file->target == NULL)
    {
        file->stream = fopen(path, "wb");
        return file->stream != NULL ? BAT_OK : atomic_access_error(error, errno);
    }
    status = open_temporary(file, target.exists ? &target.existing : NULL, error);
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

int atomic_sync(int descriptor)
{
    if (fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP || errno == ENOSYS || errno == EROFS)
        return 0;
    return errno;
}

void atomic_sync_folder(const char *path)
{
    // The file is in its place already: a failure here changes nothing that could be reported.
    char *folder = atomic_folder_of(path);
    int descriptor = folder != NULL ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (descriptor >= 0)
    {
        (void)fsync(descriptor);
        (void)close(descriptor);
    }
    free(folder);
}

/// Finish writing and put the file in its place. When that fails, the file is abandoned.
/// @return BAT_OK or BAT_FILE_ACCESS
static bat_status atomic_file_commit(atomic_file *file, bat_error *error)
{
    int reason = flush(file->stream);
    // Files with hidden names are forced to the disk when they leave them.
    bool replaces = file->target != NULL && !atomic_is_hidden(file->target);
    bool nameless = file->target != NULL && file->temporary == NULL && !file->parked;
    if (reason == 0 && replaces)
        reason = atomic_sync(fileno(file->stream));
    // A new file needs no hidden name, which would stay behind if the process were killed now.
    if (reason == 0 && nameless && replaces && atomic_link_nameless(fileno(file->stream), file->target) == 0)
        nameless = false;
    if (reason == 0 && nameless && take_name(file, fileno(file->stream), 0) < 0)
        reason = errno;
    int shut_reason = shut(file->stream);
    if (reason == 0)
        reason = shut_reason;
    if (reason == 0 && file->temporary != NULL && rename(file->temporary, file->target) != 0)
        reason = errno;
    if (reason == 0 && replaces)
        atomic_sync_folder(file->target);
    if (reason != 0 && file->temporary != NULL)
        (void)unlink(file->temporary);
    forget(file);
    return reason == 0 ? BAT_OK : atomic_access_error(error, reason);
}

bat_status atomic_file_end(atomic_file *file, bat_status status, bat_error *error)
{
    if (status == BAT_OK)
        return atomic_file_commit(file, error);
    if (file->stream != NULL)
    {
        (void)shut(file->stream);
        // An empty file counts as not written.
        int emptied = file->parked ? open_parked(file->target) : -1;
        if (emptied >= 0)
            (void)close(emptied);
    }
    if (file->temporary != NULL)
        (void)unlink(file->temporary);
    forget(file);
    return status;
}

bat_status atomic_file_write(const char *path, const void *bytes, size_t size, bat_error *error)
{
    atomic_file file;
    bat_status status = atomic_file_begin(path, &file, error);
    if (status != BAT_OK)
        return status;
    if (size > 0 && fwrite(bytes, 1, size, file.stream) != size)
        status = atomic_access_error(error, errno);
    return atomic_file_end(&file, status, error);
}

const char *atomic_name_shown(const char *path)
{
    const char *base = atomic_base_name(path);
    const char *dot = atomic_is_hidden(path) ? strchr(base + sizeof HIDDEN - 1, '.') : NULL;
    return dot != NULL ? dot + 1 : base;
}

size_t bat_outputs_sweep(const char *path)
{
    static const double UNTOUCHED = 3600; // seconds; of other machines the processes are not known
    size_t removed = 0;
    char *folder = atomic_folder_of(path);
    DIR *entries = folder != NULL ? opendir(folder) : NULL;
    const struct dirent *entry;
    while (entries != NULL && (entry = readdir(entries)) != NULL)
    {
        long process;
        unsigned descriptor;
        struct stat about;
        if (read_hidden(entry->d_name, &process, &descriptor) && process > 0 && kill((pid_t)process, 0) != 0 &&
            errno == ESRCH && fstatat(dirfd(entries), entry->d_name, &about, AT_SYMLINK_NOFOLLOW) == 0 &&
            S_ISREG(about.st_mode) && difftime(time(NULL), about.st_mtime) > UNTOUCHED)
            removed += unlinkat(dirfd(entries), entry->d_name, 0) == 0;
    }
    if (entries != NULL)
        (void)closedir(entries);
    free(folder);
    return removed;
}
