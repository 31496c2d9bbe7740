#pragma once

#include "batten/base.h"

/// Fill `error` (may be null) and hand the status back, so that a failing call can `return error_set(...)`.
/// `index` and `line` as in bat_error: BAT_NO_INDEX and 0 for none. The text is cut, never overrun.
bat_status error_set(bat_error *error, bat_status status, size_t index, size_t line, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/// error_set() for an argument, for what is too large, for a fault of a file, at a line or 0, and for what is not supported.
#define ERROR_ARGUMENT(error, ...) error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, __VA_ARGS__)
#define ERROR_TOO_LARGE(error, ...) error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, __VA_ARGS__)
#define ERROR_FILE(error, line, ...) error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, __VA_ARGS__)
#define ERROR_UNSUPPORTED(error, line, ...) error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, line, __VA_ARGS__)

/// error_set() for a failed allocation of `size` bytes.
bat_status error_memory(bat_error *error, size_t size);

/// Refuse an option: the text is the name of the field, a blank and `format`.
/// @return BAT_INVALID_ARGUMENT
bat_status error_option(bat_error *error, const char *option, const char *format, ...) __attribute__((format(printf, 3, 4)));

/// error_set() with the text `before`, a blank, the index and `format`; it sets `index_at`.
bat_status error_point(bat_error *error, bat_status status, size_t index, const char *before, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
/// Replace the index, also where the text names it.
void error_renumber(bat_error *error, size_t index);

/// Name the field of options that leads out of a failure, and what it does; hand the status back. Nothing for BAT_OK.
bat_status error_remedy(bat_error *error, bat_status status, const char *remedy, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Tell again what another call told, and hand its status back.
bat_status error_copy(bat_error *error, const bat_error *from);

/// Tell which input of the call has failed, from 0 on, and hand the status back. Does nothing for BAT_OK or a null error.
bat_status error_operand(bat_error *error, bat_status status, size_t operand);

/// Tell which curve of several has failed, and hand the status back. Does nothing for BAT_OK, BAT_CANCELLED or a null error.
bat_status error_curve(bat_error *error, bat_status status, size_t curve);

/// Put words before the text of a failure, and hand its status back. Does nothing for BAT_OK or a null error.
bat_status error_prefix(bat_error *error, bat_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

#if defined(__clang_analyzer__)
// Tells the static analyzer, which does not see the bodies, which status comes back.
#define error_set(error, status, ...) ((void)error_set(error, status, __VA_ARGS__), (status))
#define error_memory(error, size) ((void)error_memory(error, size), BAT_NO_MEMORY)
#define error_option(error, ...) ((void)error_option(error, __VA_ARGS__), BAT_INVALID_ARGUMENT)
#define error_point(error, status, ...) ((void)error_point(error, status, __VA_ARGS__), (status))
#endif
