#ifndef CLI_ARGUMENTS_H
#define CLI_ARGUMENTS_H

#include <stdbool.h>
#include <stddef.h>

/// @file
/// The command line of a verb: a table of options, what the user gave, and the help made of the table.

enum
{
    /// Files or names that a verb takes at most, and options in its table.
    MOST_POSITIONAL = 64,
    MOST_OPTIONS = 32,
};

/// The exit codes of the program.
enum
{
    EXIT_DONE = 0,
    EXIT_BAD_INPUT = 1,
    EXIT_BAD_USAGE = 2,
};

/// One option. Options begin with "--"; `letter` is a short form, 0 for none.
typedef struct option_spec
{
    const char *name; ///< without the dashes; null ends a table
    char letter;
    const char *value; ///< what to call its value in the help; null for a flag
    const char *help;
} option_spec;

/// What a verb takes.
typedef struct verb_spec
{
    const char *usage;   ///< "batten curve IN [-o OUT] [options]"
    const char *summary; ///< one or a few lines
    const option_spec *options;
    size_t least_positional, most_positional;
} verb_spec;

/// What the user gave.
typedef struct arguments
{
    const verb_spec *spec;
    const char *positional[MOST_POSITIONAL];
    size_t positional_count;
    const char *values[MOST_OPTIONS]; ///< in the table's order; null where not given; "" for a flag
} arguments;

/// Read the command line. --help and -h print the help.
/// @return true to go on; else *exit_code says how to end
bool arguments_read(const verb_spec *spec, int argc, char **argv, arguments *given, int *exit_code);

/// The value of an option, null when it was not given; "" for a flag that was.
const char *argument(const arguments *given, const char *name);
bool argument_flag(const arguments *given, const char *name);

/// A whole number from `low` to `high`, or `absent` when the option was not given; false after a message.
bool argument_whole(const arguments *given, const char *name, long low, long high, long absent, long *value);
/// A finite number, or `absent`; false after a message.
bool argument_number(const arguments *given, const char *name, double absent, double *value);
/// The index of the option's value in `words` (null-terminated), or `absent`; false after a message.
bool argument_word(const arguments *given, const char *name, const char *const *words, int absent, int *index);

/// Print "batten: message" and the usage line of the verb to standard error, and return EXIT_BAD_USAGE.
int usage_error(const arguments *given, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
