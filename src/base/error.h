#ifndef BASE_ERROR_H
#define BASE_ERROR_H

#include "batten/base.h"

/// Fill `error` (may be null) and hand the status back, so that a failing call can `return error_set(...)`.
/// `index` and `line` as in bat_error: BAT_NO_INDEX and 0 for none. The text is cut, never overrun.
bat_status error_set(bat_error *error, bat_status status, size_t index, size_t line, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/// error_set() for a failed allocation of `size` bytes.
bat_status error_memory(bat_error *error, size_t size);

/// Put "PATH: " before the text of an error, and hand its status back. Does nothing for BAT_OK or a null error.
bat_status error_in_file(bat_error *error, bat_status status, const char *path);

#if defined(__clang_analyzer__)
// Tells the static analyzer, which does not see the bodies, which status comes back.
#define error_set(error, status, ...) ((void)error_set(error, status, __VA_ARGS__), (status))
#define error_memory(error, size) ((void)error_memory(error, size), BAT_NO_MEMORY)
#endif

#endif
