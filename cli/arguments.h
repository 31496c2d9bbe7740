#ifndef CLI_ARGUMENTS_H
#define CLI_ARGUMENTS_H

#include "batten/base.h"

#include <stdbool.h>
#include <stddef.h>

/// @file
/// The command line of a verb: a table of options, what the user gave, and the help made of the table.

enum
{
    /// The maximum number of names that a verb takes which bounds them, and of options in a table.
    MAX_POSITIONAL = 64,
    MAX_OPTIONS = 64,
    /// The maximum of --threads.
    MAX_THREADS = 1024,
    /// The maximum number of values in a list.
    MAX_LISTED = 16,
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

/// What becomes of a file that an option names.
typedef enum file_use
{
    FILE_READ,
    FILE_WRITTEN,
    FILE_DRAWN ///< a picture, written
} file_use;

/// An option whose value is a file.
typedef struct file_option
{
    const char *name; ///< null ends a table
    file_use use;
} file_option;

/// What a verb takes.
typedef struct verb_spec
{
    const char *usage;   ///< "batten curve IN [-o OUT] [options]"
    const char *summary; ///< one or a few lines
    const option_spec *options;
    size_t min_positional, max_positional;
    bool reads_files;         ///< the positional arguments are files that are read
    const file_option *files; ///< null for none
} verb_spec;

/// What the user gave.
typedef struct arguments
{
    const verb_spec *spec;
    const char *const *positional; ///< in the command line, which is reordered
    size_t positional_count;
    const char *values[MAX_OPTIONS]; ///< in the table's order; null where not given; "" for a flag
} arguments;

/// Read the command line. --help and -h print the help. `argv` is reordered, and must outlive `given`.
/// @return true to go on; else *exit_code says how to end
bool arguments_read(const verb_spec *spec, int argc, char **argv, arguments *given, int *exit_code);

/// The value of an option, null when it was not given; "" for a flag that was.
const char *argument(const arguments *given, const char *name);
bool argument_flag(const arguments *given, const char *name);
/// Give an option, which the verb has, a value that outlives `given`.
void argument_set(arguments *given, const char *name, const char *value);
/// Whether the verb has an option of that name.
bool argument_exists(const arguments *given, const char *name);

/// A whole number from `low` to `high`, or `absent` when the option was not given; false after a message.
bool argument_whole(const arguments *given, const char *name, long low, long high, long absent, long *value);
/// A finite number, or `absent`; false after a message.
bool argument_number(const arguments *given, const char *name, double absent, double *value);
/// The index of the option's value in `words` (null-terminated), or `absent`; false after a message.
bool argument_word(const arguments *given, const char *name, const char *const *words, int absent, int *index);

/// Numbers that an option lists, as in "50,100,200".
typedef struct number_list
{
    double numbers[MAX_LISTED];
    size_t count;
} number_list;

/// Numbers from `low` to `high`; `list` is untouched when the option was not given. False after a message.
bool argument_list(const arguments *given, const char *name, double low, double high, bool whole, number_list *list);

/// --threads, or 0 for the default; false after a message.
bool argument_threads(const arguments *given, int *threads);

/// The enumerator, of the family's enumeration, that an option names; unchanged when the option is not given. False after a
/// message.
bool argument_choice(const arguments *given, const char *name, const bat_family *family, void *value);
/// Whether the format of -o is known: as `to`, or by its ending. False after a message.
bool argument_ending(const arguments *given, const bat_family *formats, int to);

/// Print "batten: message" and the usage line of the verb to standard error, and return EXIT_BAD_USAGE.
int usage_error(const arguments *given, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
