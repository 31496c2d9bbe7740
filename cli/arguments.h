#pragma once

#include "batten/base.h"

/// @file
/// The command line of a verb: tables of options, and what the user gave.

enum
{
    /// The maximum number of names that a verb takes which bounds them, and of options of a verb.
    MAX_POSITIONAL = 64,
    MAX_OPTIONS = 64,
    /// The maximum of --threads.
    MAX_THREADS = 1024,
    /// The maximum number of values in a list.
    MAX_LISTED = 16,
};

/// A degree, in radians.
#define DEGREE (3.14159265358979323846 / 180)

/// The exit codes of the program.
enum
{
    EXIT_DONE = 0,
    EXIT_BAD_INPUT = 1,
    EXIT_BAD_USAGE = 2,
};

/// The heading under which the help shows an option.
typedef enum option_group
{
    INPUT,
    METHOD,
    RESULT,
    PICTURE,
    CALL ///< processes and threads
} option_group;

/// What is to be known of an option, or-ed together.
enum
{
    COMMON = 1,  ///< most users need it: it stands in the short help
    IS_READ = 2, ///< its value is a file that is read
    IS_WRITTEN = 4,
    IS_DRAWN = 8 ///< a picture, which is written
};

/// How the value of an option is read into a field of the verb's job.
typedef enum field_kind
{
    FIELD_NONE, ///< the verb reads it
    FIELD_TEXT,
    FIELD_FLAG,     ///< bool: true
    FIELD_CONSTANT, ///< int: `low`
    FIELD_WHOLE,    ///< from `low` to `high`
    FIELD_NUMBER,   ///< finite
    FIELD_POSITIVE,
    FIELD_DEGREES, ///< from `low`, which is excluded where it is not 0, to 180; in radians
    FIELD_CHOICE   ///< an enumerator of `family`
} field_kind;

typedef struct option_field
{
    field_kind kind;
    size_t offset, size;
    long low, high;
    const bat_family *family;
} option_field;

// Fields of a struct, for rows of options.
#define FIELD_OF(kind, type, member, low, high, family)                                                                     \
    {                                                                                                                       \
        kind, offsetof(type, member), sizeof((type *)NULL)->member, low, high, family                                       \
    }
#define NO_FIELD FIELD_OF(FIELD_NONE, option_field, kind, 0, 0, NULL)
#define TEXT(type, member) FIELD_OF(FIELD_TEXT, type, member, 0, 0, NULL)
/// A text that is one of a family's names, perhaps with settings.
#define NAME(type, member, family) FIELD_OF(FIELD_TEXT, type, member, 0, 0, &(family))
#define FLAG(type, member) FIELD_OF(FIELD_FLAG, type, member, 0, 0, NULL)
/// A switch that clears a field.
#define CLEARS(type, member) FIELD_OF(FIELD_FLAG, type, member, 1, 1, NULL)
#define CONSTANT(type, member, value) FIELD_OF(FIELD_CONSTANT, type, member, value, value, NULL)
#define WHOLE(type, member, low, high) FIELD_OF(FIELD_WHOLE, type, member, low, high, NULL)
#define NUMBER(type, member) FIELD_OF(FIELD_NUMBER, type, member, 0, 0, NULL)
#define POSITIVE(type, member) FIELD_OF(FIELD_POSITIVE, type, member, 0, 0, NULL)
#define DEGREES(type, member, low) FIELD_OF(FIELD_DEGREES, type, member, low, 180, NULL)
#define CHOICE(type, member, family) FIELD_OF(FIELD_CHOICE, type, member, 0, 0, &(family))

/// One option. Options begin with "--"; that of the name "output" has the short form -o.
typedef struct option_spec
{
    const char *name;  ///< without the dashes; null ends a table
    const char *value; ///< what to call its value in the help; null for a flag
    option_group group;
    unsigned marks;
    const char *summary; ///< one or a few lines of the help, which breaks them
    option_field field;
} option_spec;

#define END_OF_OPTIONS                                                                                                      \
    {                                                                                                                       \
        NULL, NULL, INPUT, 0, NULL, NO_FIELD                                                                                \
    }

/// Options whose fields are in one struct.
typedef struct option_table
{
    const option_spec *rows; ///< null ends the tables of a verb
    size_t offset;           ///< of the struct in the verb's job
} option_table;

struct verb;

/// What the user gave.
typedef struct arguments
{
    const struct verb *verb;
    const char *const *positional; ///< in the command line, which is reordered
    size_t positional_count;
    const char *values[MAX_OPTIONS]; ///< in the order of the tables; null where not given; "" for a flag
} arguments;

/// The options of a verb, from 0 on, through all its tables; null past the last. `offset`, which may be null, receives that
/// of the option's struct.
const option_spec *option_at(const struct verb *what, size_t index, size_t *offset);

/// Read the command line. --help and -h print the help. `argv` is reordered, and must outlive `given`.
/// @return true to go on; else *exit_code says how to end
bool arguments_read(const struct verb *what, int argc, char **argv, arguments *given, int *exit_code);
/// Read the values that were given into the fields of a job. False after a message.
bool arguments_store(const arguments *given, void *job);

/// The value of an option, null when it was not given; "" for a flag that was.
const char *argument(const arguments *given, const char *name);
/// Give an option, which the verb has, a value that outlives `given`.
void argument_set(arguments *given, const char *name, const char *value);
/// The first of some options, a null-terminated list, that was given; null for none.
const char *argument_first(const arguments *given, const char *const *names);

/// A whole number from `low` to `high`, or `absent` when the option was not given; false after a message.
bool argument_whole(const arguments *given, const char *name, long low, long high, long absent, long *value);
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

/// The enumerator of a family, which stays as it is when the option was not given; `value` points to an enumeration. False
/// after a message.
bool argument_choice(const arguments *given, const char *name, const bat_family *family, void *value);
/// Whether the format of -o is known: as `to`, unless that is 0, or by its ending. False after a message.
bool argument_ending(const arguments *given, const bat_family *formats, int to);

/// Print "batten: message" and the usage line of the verb to standard error, and return EXIT_BAD_USAGE.
int usage_error(const arguments *given, const char *format, ...) __attribute__((format(printf, 2, 3)));
/// The same, but false.
#define usage_refused(...) (usage_error(__VA_ARGS__) == EXIT_DONE)
/// A rule of a command line, with the message where it is broken.
typedef struct usage_rule
{
    bool broken;
    const char *message; ///< may take two texts
} usage_rule;
/// Whether all rules are obeyed. False after the message of the first one that is not, in which the two texts stand.
bool usage_obeys(const arguments *given, const usage_rule *rules, size_t count, const char *first, const char *second);
/// Refuse an option that the user gave: "--NAME is VALUE, but must be RANGE". Returns false.
bool argument_refused(const arguments *given, const char *name, const char *range, ...)
    __attribute__((format(printf, 3, 4)));
/// Refuse options that the library refuses, in the words of argument_wording() on report_error(), unless `status` is BAT_OK.
/// True where it is.
bool usage_accepts(const arguments *given, bat_status status);

enum
{
    WORDING_SIZE = 2 * BAT_ERROR_TEXT_SIZE
};

/// The text of a failure for the user: it names the option of the command line that is at fault, and the one that leads
/// out, where the verb has it and it was not given.
void argument_wording(const arguments *given, const bat_error *error, char text[WORDING_SIZE]);
