#ifndef CLI_REPORT_H
#define CLI_REPORT_H

#include "batten/base.h"

#include <jansson.h>

/// @file
/// What the program says: errors in one line, progress, JSON.

/// Print "batten: FILE:LINE: text" (as far as file and line are known) to standard error and return EXIT_BAD_INPUT.
int report_failure(const char *file, const bat_error *error);

/// A progress function that draws a line on standard error when that is a terminal, and stops the work once the user has
/// pressed Ctrl-C. `what` names the work and must outlive it.
bat_progress report_progress(const char *what);
/// Take the progress line away.
void report_progress_end(void);

/// Let Ctrl-C ask running work to stop instead of ending the program.
void report_catch_interrupt(void);
/// Whether the user has pressed Ctrl-C.
bool report_interrupted(void);

/// Print one JSON object on standard output and release it. Numbers keep 17 digits. Returns the program's exit code.
int report_json(json_t *object);

#if defined(__clang_analyzer__)
// Tells the static analyzer, which does not see the body, which code comes back.
#define report_failure(file, error) ((void)report_failure(file, error), EXIT_BAD_INPUT)
#endif

#endif
