#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/// Add to the text, which is cut, never overrun.
static void append(bat_error *error, const char *format, va_list arguments)
{
    size_t used = strlen(error->text);
    (void)vsnprintf(error->text + used, sizeof error->text - used, format, arguments);
}

bat_status(error_set)(bat_error *error, bat_status status, size_t index, size_t line, const char *format, ...)
{
    if (error == NULL)
        return status;
    // Without an initializer, which would clear the whole text.
    error->status = status;
    error->operand = error->curve = BAT_NO_INDEX;
    error->index = index;
    error->index_at = 0;
    error->line = line;
    error->option[0] = error->remedy[0] = error->remedy_effect[0] = error->text[0] = '\0';
    va_list arguments;
    va_start(arguments, format);
    append(error, format, arguments);
    va_end(arguments);
    return status;
}

bat_status(error_memory)(bat_error *error, size_t size)
{
    if (size == 0)
        return error_set(error, BAT_NO_MEMORY, BAT_NO_INDEX, 0, "out of memory");
    return error_set(error, BAT_NO_MEMORY, BAT_NO_INDEX, 0, "out of memory (%zu bytes wanted)", size);
}

bat_status(error_option)(bat_error *error, const char *option, const char *format, ...)
{
    if (error == NULL)
        return BAT_INVALID_ARGUMENT;
    (void)error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "%s ", option);
    (void)snprintf(error->option, sizeof error->option, "%s", option);
    va_list arguments;
    va_start(arguments, format);
    append(error, format, arguments);
    va_end(arguments);
    return BAT_INVALID_ARGUMENT;
}

bat_status(error_point)(bat_error *error, bat_status status, size_t index, const char *before, const char *format, ...)
{
    if (error == NULL)
        return status;
    (void)error_set(error, status, index, 0, "%s %zu", before, index);
    error->index_at = strlen(before) + 1;
    va_list arguments;
    va_start(arguments, format);
    append(error, format, arguments);
    va_end(arguments);
    return status;
}

void error_renumber(bat_error *error, size_t index)
{
    char rest[BAT_ERROR_TEXT_SIZE];
    error->index = index;
    if (error->index_at == 0)
        return;
    char *at = error->text + error->index_at;
    (void)snprintf(rest, sizeof rest, "%s", at + strspn(at, "0123456789"));
    (void)snprintf(at, sizeof error->text - error->index_at, "%zu%s", index, rest);
}

bat_status error_remedy(bat_error *error, bat_status status, const char *remedy, const char *format, ...)
{
    if (status == BAT_OK || error == NULL)
        return status;
    (void)snprintf(error->remedy, sizeof error->remedy, "%s", remedy);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(error->remedy_effect, sizeof error->remedy_effect, format, arguments);
    va_end(arguments);
    return status;
}

bat_status error_copy(bat_error *error, const bat_error *from)
{
    if (error != NULL)
        *error = *from;
    return from->status;
}

bat_status error_operand(bat_error *error, bat_status status, size_t operand)
{
    if (status != BAT_OK && error != NULL)
        error->operand = operand;
    return status;
}

bat_status error_curve(bat_error *error, bat_status status, size_t curve)
{
    if (status != BAT_OK && status != BAT_CANCELLED && error != NULL)
        error->curve = curve;
    return status;
}

bat_status error_prefix(bat_error *error, bat_status status, const char *format, ...)
{
    if (status == BAT_OK || error == NULL)
        return status;
    char inner[BAT_ERROR_TEXT_SIZE];
    memcpy(inner, error->text, sizeof inner);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    size_t used = strlen(error->text);
    (void)snprintf(error->text + used, sizeof error->text - used, "%s", inner);
    error->index_at = error->index_at > 0 && used + error->index_at < sizeof error->text ? used + error->index_at : 0;
    error->option[0] = '\0';
    return status;
}

const char *bat_status_name(bat_status status)
{
    static const char *const NAMES[] = {[BAT_OK] = "ok",
                                        [BAT_INVALID_ARGUMENT] = "invalid argument",
                                        [BAT_INVALID_POINT] = "invalid point",
                                        [BAT_CUT_LOCUS] = "cut locus",
                                        [BAT_UNSUPPORTED] = "unsupported",
                                        [BAT_NO_CONVERGENCE] = "no convergence",
                                        [BAT_TOO_LARGE] = "too large",
                                        [BAT_NO_MEMORY] = "no memory",
                                        [BAT_BAD_FILE] = "bad file",
                                        [BAT_FILE_ACCESS] = "file access",
                                        [BAT_CANCELLED] = "cancelled",
                                        [BAT_NOT_MANIFOLD] = "not manifold"};
    return (size_t)status < sizeof NAMES / sizeof *NAMES && NAMES[status] != NULL ? NAMES[status] : "unknown status";
}

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

const char *bat_version(void)
{
    return TEXT(BAT_VERSION_MAJOR) "." TEXT(BAT_VERSION_MINOR) "." TEXT(BAT_VERSION_PATCH);
}
