#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

bat_status(error_set)(bat_error *error, bat_status status, size_t index, size_t line, const char *format, ...)
{
    if (error != NULL)
    {
        error->status = status;
        error->index = index;
        error->line = line;
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return status;
}

bat_status(error_memory)(bat_error *error, size_t size)
{
    return error_set(error, BAT_NO_MEMORY, BAT_NO_INDEX, 0, "out of memory (%zu bytes wanted)", size);
}

bat_status error_in_file(bat_error *error, bat_status status, const char *path)
{
    if (status == BAT_OK || error == NULL)
        return status;
    const bat_error inner = *error;
    return error_set(error, status, inner.index, inner.line, "%s: %s", path, inner.text);
}

const char *bat_status_name(bat_status status)
{
    switch (status)
    {
    case BAT_OK:
        return "ok";
    case BAT_INVALID_ARGUMENT:
        return "invalid argument";
    case BAT_INVALID_POINT:
        return "invalid point";
    case BAT_CUT_LOCUS:
        return "cut locus";
    case BAT_UNSUPPORTED:
        return "unsupported";
    case BAT_NO_CONVERGENCE:
        return "no convergence";
    case BAT_TOO_LARGE:
        return "too large";
    case BAT_NO_MEMORY:
        return "no memory";
    case BAT_BAD_FILE:
        return "bad file";
    case BAT_FILE_ACCESS:
        return "file access";
    case BAT_CANCELLED:
        return "cancelled";
    case BAT_NOT_MANIFOLD:
        return "not manifold";
    }
    return "unknown status";
}

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

const char *bat_version(void)
{
    return TEXT(BAT_VERSION_MAJOR) "." TEXT(BAT_VERSION_MINOR) "." TEXT(BAT_VERSION_PATCH);
}
