#ifndef CLI_HELP_H
#define CLI_HELP_H

#include "verb.h"

#include <stdio.h>

/// @file
/// The help of a verb, made of its tables.

enum
{
    /// The maximum number of characters on a line.
    HELP_WIDTH = 100,
    /// Of a summary, with its final zero.
    HELP_TEXT_SIZE = 1024,
    HELP_GROUPS = CALL + 1
};

/// The headings of the groups of options.
extern const char *const HELP_HEADINGS[HELP_GROUPS];

/// The name of a verb's program.
const char *verb_program(const verb *what);

/// Print a text, which begins at `column` of its line, with line breaks; further lines begin at `indent`. Ends the line.
void help_wrap(FILE *out, const char *text, size_t column, size_t indent);
/// The summary of an option, with the names of its family in the place of "{}".
/// @param text [HELP_TEXT_SIZE], may receive it
const char *help_summary(const option_spec *option, char *text);
/// Print the help of a verb: its common options, or all of them.
void help_print(const verb *what, bool all);

#endif
