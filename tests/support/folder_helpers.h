#ifndef TESTS_SUPPORT_FOLDER_HELPERS_H
#define TESTS_SUPPORT_FOLDER_HELPERS_H

// A folder of its own for each test, and files in it.

#include "check.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/// A new folder for each test, which is the current one meanwhile.
static inline int enter_folder(void **state)
{
    char *name = strdup("/tmp/batten-test-XXXXXX");
    *state = name;
    return mkdtemp(name) != NULL ? chdir(name) : -1;
}

static inline size_t count_files(bool and_remove)
{
    size_t count = 0;
    DIR *directory = opendir(".");
    for (struct dirent *entry = readdir(directory); entry != NULL; entry = readdir(directory))
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
        {
            if (and_remove)
                (void)remove(entry->d_name);
            count++;
        }
    (void)closedir(directory);
    return count;
}

static inline int leave_folder(void **state)
{
    (void)count_files(true);
    int left = chdir("/");
    (void)rmdir(*state);
    free(*state);
    return left;
}

static inline void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

#endif
