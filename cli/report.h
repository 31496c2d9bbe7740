#ifndef CLI_REPORT_H
#define CLI_REPORT_H

#include "arguments.h"

#include "batten/mesh_file.h"

#include <jansson.h>
#include <stdio.h>

/// @file
/// Errors in one line, progress, JSON.

/// Print "batten: FILE:LINE: text" (as far as file and line are known) to standard error and return EXIT_BAD_INPUT.
int report_failure(const char *file, const bat_error *error);

/// report_failure() for a file that was read, with the option of the verb that leads out, where there is one.
int report_bad_input(const arguments *given, const char *file, const bat_error *error);

/// Print each note as a line "note: text".
void report_notes(const bat_mesh_notes *notes, FILE *stream);
/// The notes as a JSON array.
json_t *report_notes_json(const bat_mesh_notes *notes);

/// A progress function that draws a line on standard error when that is a terminal, and stops the work once a signal such as
/// that of Ctrl-C has come. `what` names the work and must outlive it. A second signal ends the program at once.
bat_progress report_progress(const char *what);
/// Take the progress line away. Ends the program when a signal has come during the work.
void report_progress_end(void);
/// A number, or null for one that is not finite, which JSON cannot hold.
json_t *report_number(double value);
/// Print one JSON object on standard output and release it; a null one means that memory ran out. Numbers keep 17 digits.
/// Returns the program's exit code.
int report_json(json_t *object);

/// The exit code of a verb that ended with `code`, once its standard output is written out: a failure to do so is a failure.
int report_end(int code);

#if defined(__clang_analyzer__)
// Tells the static analyzer, which does not see the body, which code comes back.
#define report_failure(file, error) ((void)report_failure(file, error), EXIT_BAD_INPUT)
#endif

#endif
