#include "base/memory_available.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/// @file
/// The system's figures of memory: /proc/meminfo and cgroup v2 of Linux, elsewhere sysconf().

/// The number after `key` at the begin of a line of a file, times `unit`; SIZE_MAX for none.
static size_t number_in_file(const char *path, const char *key, size_t unit)
{
    char line[256];
    size_t found = SIZE_MAX;
    FILE *file = fopen(path, "r");
    while (file != NULL && found == SIZE_MAX && fgets(line, sizeof line, file) != NULL)
    {
        if (strncmp(line, key, strlen(key)) != 0)
            continue;
        const char *digits = line + strlen(key);
        digits += strspn(digits, " ");
        if (*digits < '0' || *digits > '9')
            continue;
        unsigned long long number = strtoull(digits, NULL, 10);
        found = number < SIZE_MAX / unit ? (size_t)number * unit : SIZE_MAX - 1;
    }
    if (file != NULL)
        (void)fclose(file);
    return found;
}

size_t memory_available(void)
{
    enum
    {
        KIBIBYTE = 1024
    };
    size_t free = number_in_file("/proc/meminfo", "MemAvailable:", KIBIBYTE);
    size_t most = number_in_file("/sys/fs/cgroup/memory.max", "", 1);
    size_t used = number_in_file("/sys/fs/cgroup/memory.current", "", 1);
    if (most != SIZE_MAX && used != SIZE_MAX)
    {
        size_t left = used < most ? most - used : 0;
        free = left < free ? left : free;
    }
    if (free != SIZE_MAX)
        return free;
    long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    return pages > 0 && size > 0 && (size_t)pages <= SIZE_MAX / (size_t)size ? (size_t)pages * (size_t)size : 0;
}
