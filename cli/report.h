#pragma once

#include "arguments.h"

#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>

/// @file
/// Errors in one line, signals, progress, and reports as text or as JSON.

// Text for people. Names of files and what files contain may hold control characters, which a terminal would obey.

/// Replace each control character by '?', in place: of ASCII, also line breaks, and of the C1 set. So are bytes that are no
/// UTF-8.
void report_clean(char *text);

/// As fprintf(), with control characters replaced but for a line break that ends the format.
void report_text(FILE *stream, const char *format, ...) __attribute__((format(printf, 2, 3)));
void report_text_list(FILE *stream, const char *format, va_list list) __attribute__((format(printf, 2, 0)));

/// What stands behind a path's last slash; null for no path.
const char *file_name(const char *path);

/// Print "batten: FILE:LINE: text" (as far as file and line are known) to standard error and return EXIT_BAD_INPUT.
int report_failure(const char *file, const bat_error *error);

/// report_failure() for a file that was read, with the option of the verb that leads out, where there is one.
int report_bad_input(const arguments *given, const char *file, const bat_error *error);

// What SIGINT (Ctrl-C), SIGTERM and SIGHUP do: they end the program with one line and exit code 1, and no temporary file
// stays.

/// Catch the signals that the program was not started to ignore. Called once, from the main thread.
void interrupt_catch(void);

/// The files under way, whose temporary files are removed when a signal ends the program; null for none.
void interrupt_files(const bat_outputs *files);

/// How a signal is taken.
typedef enum interrupt_mode
{
    INTERRUPT_AT_ONCE,     ///< it ends the program
    INTERRUPT_COOPERATIVE, ///< the first one makes interrupt_pending() true; a second one ends the program
    INTERRUPT_NEVER        ///< it is forgotten
} interrupt_mode;

/// Choose how signals are taken. INTERRUPT_AT_ONCE ends the program when one is pending.
void interrupt_use(interrupt_mode mode);

/// End the program after so many seconds, and let it have no more than so many megabytes of memory; 0 for no limit.
void interrupt_limit(double seconds, double megabytes);
/// Whether memory has a limit, by an option or by the caller's shell.
bool interrupt_memory_is_limited(void);

/// Whether a signal has come.
bool interrupt_pending(void);

/// A progress function that draws a line on standard error when that is a terminal, and stops the work once a signal such as
/// that of Ctrl-C has come. `what` names the work and must outlive it. A second signal ends the program at once.
bat_progress report_progress(const char *what);
/// Take the progress line away. Ends the program when a signal has come during the work.
void report_progress_end(void);
/// A number, or null for one that is not finite, which JSON cannot hold.
json_t *report_number(double value);
/// An array of numbers; null where memory ran out.
json_t *report_numbers(const double *values, size_t count);

// Reports. Values with keys make both forms: a text for people and an object of JSON.
//
// The keys stand in one text with the kinds of the values, which follow as arguments: "shape:s faces:z". The kinds are s for
// a text or null, z for size_t, i for int, b for int as a truth value, n for double, and o for a json_t *. A double that is
// not finite is null in JSON. A json_t * is taken over; a null one means that memory ran out. A key with a full stop, as
// "fine.faces", is a member of an object in the object. One that begins with - is for the text alone. One whose kind has ?
// behind it is left out of the object where its value is not set: null, an empty text, 0, false or not finite; an o where it
// is the null of JSON.
//
// In the text, "{faces:8}" stands for a value, with its width, or with the format of a number without %: "{mean:9.4f}".
// "{100 mean:9.4f}" is a hundred times it, "{ours/theirs:9.5g}" a number and in brackets its ratio to the other where that
// is finite. "[faces?...]" is printed where the value is set, "[!faces?...]" where it is not. Control characters in values
// are replaced.

/// Print the text and return null, or return the object, which is null where memory ran out.
json_t *report_part(bool as_json, const char *text, const char *keys, ...);
/// An object of JSON.
#define report_object(...) report_part(true, "", __VA_ARGS__)
/// Print an object. Returns the program's exit code, EXIT_DONE where only a text was wanted.
int report_whole(bool as_json, json_t *object);
/// Print the text or the object. Returns the program's exit code.
#define report_print(as_json, ...) report_whole(as_json, report_part(as_json, __VA_ARGS__))
/// Add a member to an object and return the object; null where either is, or where memory ran out.
json_t *report_add(json_t *object, const char *key, json_t *member);

/// Rows of a table, which are printed one by one, or gathered.
typedef struct report_table
{
    bool as_json;
    json_t *rows; ///< null where they are printed, or memory ran out
} report_table;

report_table report_begin(bool as_json);
/// Print what stands above rows, where they are printed.
void report_head(const report_table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));
/// Add a row that report_part() has made.
void report_gather(report_table *table, json_t *row);
#define report_row(table, ...) report_gather(table, report_part((table)->as_json, __VA_ARGS__))
/// Release the rows of a table that has failed. Returns `code`.
int report_drop(report_table *table, int code);

/// Print one JSON object on standard output and release it; a null one means that memory ran out. Numbers keep 17 digits.
/// Returns the program's exit code.
int report_json(json_t *object);

/// Where a call of the library writes what went wrong, for report_status() and usage_accepts(). The next call overwrites it.
bat_error *report_error(void);
/// Take the progress line away, and report what is in report_error() unless `status` is BAT_OK: as report_bad_input() does,
/// or as report_failure() where `given` is null. Returns the program's exit code.
int report_status(const arguments *given, const char *file, bat_status status);

/// The exit code of a verb that ended with `code`, once its standard output is written out: a failure to do so is a failure.
int report_end(int code);

#if defined(__clang_analyzer__)
// Tells the static analyzer, which does not see the body, which code comes back.
#define report_failure(file, error) ((void)report_failure(file, error), EXIT_BAD_INPUT)
#endif
