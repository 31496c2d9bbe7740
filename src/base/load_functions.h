#pragma once

#include <dlfcn.h>
#include <stdbool.h>
#include <string.h>

/// Load a library for as long as the process lasts, and find functions in it.
/// @param table receives `count` pointers to functions, in the order of their names
/// @return false where the library or a function is missing; then dlerror() tells which
static inline bool load_functions(const char *library, const char *const *names, size_t count, void *table)
{
    void *loaded = dlopen(library, RTLD_NOW | RTLD_LOCAL), *function = loaded;
    for (size_t i = 0; i < count && function != NULL; i++)
    {
        function = dlsym(loaded, names[i]);
        // All pointers to functions have one size in POSIX.
        memcpy((char *)table + i * sizeof function, &function, sizeof function);
    }
    return function != NULL;
}
