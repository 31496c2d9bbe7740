#pragma once

#include "batten/base.h"

#include <stdio.h>
#include <sys/stat.h>

/// A file that appears whole or not at all: until it is finished an existing file is untouched. It is written without a name
/// in its folder, so that nothing stays behind when the process is killed. When its content is on the disk, a new file gets
/// its name; one that replaces another gets a hidden name and is renamed at once. Where the system or the file system has
/// no nameless files, it has the hidden name from the beginning. Links are followed. What is no regular file (a pipe, a
/// device) is written directly. "-" and "/dev/stdout" are standard output.
///
///     atomic_file file;
///     bat_status status = atomic_file_begin(path, &file, error);
///     if (status != BAT_OK)
///         return status;
///     status = write_something(file.stream, error);
///     return atomic_file_end(&file, status, error);
typedef struct atomic_file
{
    FILE *stream;    ///< write here
    char *temporary; ///< the hidden name; null while it has none
    char *target;    ///< where it goes in the end; null when written directly
    bool parked;     ///< it is the open file of a bat_outputs, which names it
} atomic_file;

/// Open a file for writing.
/// @return BAT_OK, BAT_FILE_ACCESS or BAT_NO_MEMORY; on failure nothing is left behind
bat_status atomic_file_begin(const char *path, atomic_file *file, bat_error *error);

/// Commit when `status` is BAT_OK, else abandon and return the status.
bat_status atomic_file_end(atomic_file *file, bat_status status, bat_error *error);

/// Write bytes to a file.
/// @return as atomic_file_begin()
bat_status atomic_file_write(const char *path, const void *bytes, size_t size, bat_error *error);

// What bat_outputs shares.

/// Where a path leads.
typedef struct atomic_target
{
    char *path; ///< the regular file, links followed; null for what is written directly. Release it with free()
    bool exists;
    struct stat existing; ///< of the file that is replaced, when it exists
} atomic_target;

/// Find where a path leads, and check that it can be written.
/// @return BAT_OK, BAT_FILE_ACCESS or BAT_NO_MEMORY
bat_status atomic_target_find(const char *path, atomic_target *target, bat_error *error);

/// A hidden name in the target's folder that ends with the target's name. A file of such a name is written with no second
/// temporary file, and only its owner can read it. With a descriptor of a file without a name, atomic_file_begin() opens
/// that file for it. Null when out of memory.
char *atomic_hidden_name(const char *target, unsigned attempt, int descriptor);
/// Open a file without a name in the target's folder; -1 where that is not possible.
int atomic_open_nameless(const char *target, mode_t mode);
/// Give such a file a name that no file has; 0, or -1 with errno.
int atomic_link_nameless(int descriptor, const char *name);
/// Whether a path has such a name.
bool atomic_is_hidden(const char *path);
/// The name of the file, without its folder, that a path or a hidden name stands for.
const char *atomic_name_shown(const char *path);

/// The part of a path behind its last slash.
const char *atomic_base_name(const char *path);
/// The folder of a path; null when out of memory. Release it with free().
char *atomic_folder_of(const char *path);
/// Give an open file the rights of another and, with `owner`, where the system allows it, its owner.
void atomic_keep_rights(int descriptor, const struct stat *about, bool owner);

/// Force a folder's names to the disk: of the folder that holds `path`.
void atomic_sync_folder(const char *path);

/// Force a file's content to the disk; 0, or the errno of a failure. File systems that cannot do it are not a failure.
int atomic_sync(int descriptor);

/// Fail with "cannot write" and the text of an errno.
bat_status atomic_access_error(bat_error *error, int reason);
