#define _GNU_SOURCE // O_CLOEXEC

#include "base/atomic_file.h"
#include "base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/// One file.
typedef struct output
{
    _Atomic(struct output *) next;
    size_t index;      ///< in the order in which they were added
    char *path;        ///< as it was given, where it is written directly
    char *target;      ///< links followed; null for what is written directly
    char *temporary;   ///< the hidden name beside the target
    int descriptor;    ///< the open file without a name that the hidden name stands for; -1 for none
    char *backup;      ///< another name of the file that is replaced, while several are; null for none
    struct stat about; ///< of the file that is replaced; of a new one, its rights
    struct stat folder;
    bool exists;
    bool companion; ///< belongs to the file before: it may stay unwritten, and then an old one is removed
} output;

/// A list that only grows, so that a signal handler can walk it at any time.
struct bat_outputs
{
    _Atomic(output *) first;
    output *last;
    size_t count;
};

bat_status bat_outputs_make(bat_outputs **outputs, bat_error *error)
{
    bat_outputs *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    *outputs = made;
    return BAT_OK;
}

static bool same_inode(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/// Whether two files that are to be replaced or made are one.
static bool same_target(const output *a, const output *b)
{
    if (a->target == NULL || b->target == NULL || a->exists != b->exists)
        return false;
    if (a->exists)
        return same_inode(&a->about, &b->about);
    return same_inode(&a->folder, &b->folder) && strcmp(atomic_base_name(a->target), atomic_base_name(b->target)) == 0;
}

/// Learn what rights a new file gets: from the file without a name, or from an empty one with the hidden name, which a
/// signal may leave behind.
static int probe(output *file)
{
    bool named = file->descriptor < 0;
    int descriptor = named ? open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666) : file->descriptor;
    if (descriptor < 0)
        return errno;
    struct stat about;
    int reason = fstat(descriptor, &about) == 0 ? 0 : errno;
    if (!file->exists)
        file->about = about;
    if (named)
    {
        (void)close(descriptor);
        (void)unlink(file->temporary);
    }
    return reason;
}

static bat_status find_folder(output *file, bat_error *error)
{
    char *folder = atomic_folder_of(file->target);
    if (folder == NULL)
        return error_memory(error, strlen(file->target));
    int reason = stat(folder, &file->folder) == 0 ? 0 : errno;
    free(folder);
    return reason == 0 ? BAT_OK : atomic_access_error(error, reason);
}

static bat_status prepare(const bat_outputs *outputs, const char *path, output *file, bat_error *error)
{
    atomic_target target;
    bat_status status = atomic_target_find(path, &target, error);
    if (status != BAT_OK)
        return status;
    *file = (output){.index = outputs->count, .target = target.path, .about = target.existing, .exists = target.exists};
    static const size_t MOST_OPEN = 64; // of a process's descriptors
    file->descriptor = file->target != NULL && file->index < MOST_OPEN ? atomic_open_nameless(file->target, 0666) : -1;
    file->path = strdup(path);
    if (file->target != NULL)
        file->temporary = atomic_hidden_name(file->target, (unsigned)outputs->count, file->descriptor);
    if (file->path == NULL || (file->target != NULL && file->temporary == NULL))
        return error_memory(error, strlen(path));
    if (file->target == NULL)
        return BAT_OK;
    status = find_folder(file, error);
    for (const output *other = outputs->first; status == BAT_OK && other != NULL; other = other->next)
        if (same_target(file, other))
            return error_set(error, BAT_INVALID_ARGUMENT, file->index, 0, "two outputs go to one file");
    int reason = status == BAT_OK ? probe(file) : 0;
    return reason == 0 ? status : atomic_access_error(error, reason);
}

static void forget_nameless(output *file)
{
    if (file->descriptor >= 0)
        (void)close(file->descriptor);
    file->descriptor = -1;
}

static void output_free(output *file)
{
    forget_nameless(file);
    free(file->path);
    free(file->target);
    free(file->temporary);
    free(file->backup);
    free(file);
}

static void append(bat_outputs *outputs, output *file)
{
    if (outputs->last != NULL)
        outputs->last->next = file;
    else
        outputs->first = file;
    outputs->last = file;
}

/// The path with another ending of three letters; null when out of memory.
static char *with_ending(const char *path, const char *ending)
{
    char *changed = strdup(path);
    if (changed != NULL)
        memcpy(changed + strlen(changed) - strlen(ending), ending, strlen(ending));
    return changed;
}

/// The endings of the files that belong to a Shapefile ending in .shp, and of indices that GDAL and others may add.
static const char *const COMPANIONS[] = {".shx", ".dbf", ".prj", ".cpg", ".qix", ".sbn", ".sbx", ".qpj"};
#define COMPANION_COUNT (sizeof COMPANIONS / sizeof *COMPANIONS)

/// Make one of them; null when out of memory.
static output *new_companion(const output *file, const char *ending)
{
    output *companion = calloc(1, sizeof *companion);
    if (companion == NULL)
        return NULL;
    *companion = (output){.index = file->index,
                          .about = file->about,
                          .folder = file->folder,
                          .companion = true,
                          .descriptor = -1,
                          .target = with_ending(file->target, ending),
                          .temporary = with_ending(file->temporary, ending)};
    if (companion->target == NULL || companion->temporary == NULL)
    {
        output_free(companion);
        return NULL;
    }
    struct stat existing;
    companion->exists = stat(companion->target, &existing) == 0;
    if (companion->exists)
        companion->about = existing;
    return companion;
}

/// Append a file, and its companions.
static bool append_all(bat_outputs *outputs, output *file)
{
    output *companions[COMPANION_COUNT];
    size_t count = 0;
    const char *ending = file->target != NULL ? strrchr(file->target, '.') : NULL;
    bool shapes = ending != NULL && strcasecmp(ending, ".shp") == 0;
    while (shapes && count < COMPANION_COUNT)
    {
        companions[count] = new_companion(file, COMPANIONS[count]);
        if (companions[count] == NULL)
        {
            while (count > 0)
                output_free(companions[--count]);
            return false;
        }
        count++;
    }
    append(outputs, file);
    for (size_t i = 0; i < count; i++)
        append(outputs, companions[i]);
    return true;
}

bat_status bat_outputs_add(bat_outputs *outputs, const char *path, const char **write_to, bat_error *error)
{
    if (strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, outputs->count, 0, "standard output is written after the files");
    output *file = calloc(1, sizeof *file);
    if (file == NULL)
        return error_memory(error, sizeof *file);
    file->descriptor = -1;
    bat_status status = prepare(outputs, path, file, error);
    if (status == BAT_OK && !append_all(outputs, file))
        status = error_memory(error, sizeof *file);
    if (status != BAT_OK)
    {
        output_free(file);
        if (error != NULL)
            error->index = outputs->count;
        return status;
    }
    outputs->count++;
    *write_to = file->target != NULL ? file->temporary : file->path;
    return BAT_OK;
}

/// The rights of the file that is replaced or that a new file gets, and all bytes on the disk; 0 or why it failed. Writers
/// that are not the library's made a file with the hidden name.
static int finish(output *file)
{
    struct stat about;
    int named = open(file->temporary, O_RDWR | O_CLOEXEC), descriptor = named;
    if (named < 0 && errno == ENOENT && file->descriptor >= 0 && fstat(file->descriptor, &about) == 0 && about.st_size > 0)
        descriptor = file->descriptor;
    if (descriptor < 0)
        return file->companion && errno == ENOENT ? 0 : errno;
    atomic_keep_rights(descriptor, &file->about, file->exists);
    int reason = atomic_sync(descriptor);
    if (named >= 0)
    {
        (void)close(named);
        forget_nameless(file);
    }
    return reason;
}

/// Put a finished file in its place; -1 with errno.
static int place(const output *file)
{
    if (file->descriptor >= 0 && atomic_link_nameless(file->descriptor, file->target) == 0)
        return 0;
    if (file->descriptor >= 0 && atomic_link_nameless(file->descriptor, file->temporary) != 0)
        return -1;
    return rename(file->temporary, file->target);
}

/// Give the file that is replaced a second name, by which it can be brought back. Some file systems have no such names.
static void keep_old(output *file)
{
    static const unsigned AFTER_TEMPORARIES = 1 << 16;
    if (!file->exists)
        return;
    file->backup = atomic_hidden_name(file->target, AFTER_TEMPORARIES + (unsigned)file->index, -1);
    if (file->backup != NULL && link(file->target, file->backup) != 0)
    {
        free(file->backup);
        file->backup = NULL;
    }
}

/// Take back what was put in its place, before `end`.
static void take_back(bat_outputs *outputs, const output *end)
{
    for (output *file = outputs->first; file != end; file = file->next)
    {
        if (file->target == NULL)
            continue;
        if (file->backup != NULL)
            (void)rename(file->backup, file->target);
        else if (!file->exists)
            (void)unlink(file->target);
        free(file->backup);
        file->backup = NULL;
    }
}

/// Put all files in their places; null, or the one that failed with errno.
static output *place_all(bat_outputs *outputs)
{
    for (output *file = outputs->first; file != NULL; file = file->next)
    {
        if (file->target == NULL)
            continue;
        if (outputs->first != outputs->last)
            keep_old(file);
        if (place(file) == 0)
            continue;
        if (file->companion && errno == ENOENT && (unlink(file->target) == 0 || errno == ENOENT))
            continue;
        int reason = errno;
        if (file->backup != NULL)
            (void)unlink(file->backup);
        take_back(outputs, file);
        errno = reason;
        return file;
    }
    return NULL;
}

bat_status bat_outputs_commit(bat_outputs *outputs, bat_error *error)
{
    for (output *file = outputs->first; file != NULL; file = file->next)
    {
        int reason = file->target != NULL ? finish(file) : 0;
        if (reason != 0)
            return error_set(error, BAT_FILE_ACCESS, file->index, 0, "cannot write: %s",
                             reason == ENOENT ? "nothing was written to it" : strerror(reason));
    }
    const output *failed = place_all(outputs);
    if (failed != NULL)
        return error_set(error, BAT_FILE_ACCESS, failed->index, 0, "cannot write: %s", strerror(errno));
    for (const output *file = outputs->first; file != NULL; file = file->next)
        if (file->backup != NULL)
            (void)unlink(file->backup);
    for (const output *file = outputs->first; file != NULL; file = file->next)
        if (file->target != NULL)
            atomic_sync_folder(file->target);
    return BAT_OK;
}

void bat_outputs_remove(const bat_outputs *outputs)
{
    for (const output *file = outputs->first; file != NULL; file = file->next)
        if (file->target != NULL)
            (void)unlink(file->temporary);
}

void bat_outputs_free(bat_outputs *outputs)
{
    if (outputs == NULL)
        return;
    bat_outputs_remove(outputs);
    for (output *file = outputs->first, *next; file != NULL; file = next)
    {
        next = file->next;
        output_free(file);
    }
    free(outputs);
}
