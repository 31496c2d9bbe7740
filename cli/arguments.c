#include "arguments.h"

#include "verb.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const option_spec JSON_OPTION[] = {
    {"json", NULL, RESULT, COMMON, "print one JSON object", FLAG(verb_call, json)},
    END_OF_OPTIONS,
};
const option_spec OUTPUT_OPTION[] = {
    {"output", "OUT", RESULT, COMMON | IS_WRITTEN, "write the result to OUT (- for standard output)", NO_FIELD},
    END_OF_OPTIONS,
};
const option_spec REPORT_OPTIONS[] = {
    {"json", NULL, RESULT, COMMON, "print the report as one JSON object", FLAG(verb_call, json)},
    {"quiet", NULL, RESULT, COMMON, "print no report", FLAG(verb_call, silent)},
    END_OF_OPTIONS,
};
const option_spec THREADS_OPTION[] = {
    {"threads", "N", CALL, 0, "default: all; the result does not depend on it", WHOLE(verb_call, threads, 1, MAX_THREADS)},
    END_OF_OPTIONS,
};
/// Of every verb, for files of strangers.
static const option_spec LIMIT_OPTIONS[] = {
    {"max-seconds", "S", CALL, 0, "stop after so many seconds, and write nothing", POSITIVE(verb_call, max_seconds)},
    {"max-memory", "MB", CALL, 0, "use no more than so many megabytes of memory", POSITIVE(verb_call, max_memory)},
    END_OF_OPTIONS,
};
const option_spec MANY_OPTIONS[] = {
    {"jobs", "N", CALL, 0, "of several IN: so many at a time, which share the threads; default 1", NO_FIELD},
    {"in-place", NULL, CALL, 0, "of several IN: outputs may replace inputs", NO_FIELD},
    END_OF_OPTIONS,
};

int usage_error(const arguments *given, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    (void)fputs("batten: ", stderr);
    report_text_list(stderr, format, list);
    (void)fprintf(stderr, "\nusage: %s %s %s\n", verb_program(given->verb), given->verb->name, given->verb->arguments);
    va_end(list);
    return EXIT_BAD_USAGE;
}

bool usage_obeys(const arguments *given, const usage_rule *rules, size_t count, const char *first, const char *second)
{
    for (size_t i = 0; i < count; i++)
        if (rules[i].broken)
            return usage_refused(given, rules[i].message, first, second);
    return true;
}

const option_spec *option_at(const verb *what, size_t index, size_t *offset)
{
    static const option_table FIRST[] = {{OUTPUT_OPTION, 0}, {NULL, 0}},
                              LAST[] = {{REPORT_OPTIONS, 0}, {THREADS_OPTION, 0}, {MANY_OPTIONS, 0}, {NULL, 0}},
                              LIMITS[] = {{LIMIT_OPTIONS, 0}, {NULL, 0}};
    bool many = what->formats != NULL;
    const option_table *const all[] = {many ? FIRST : what->options, many ? what->options : NULL, many ? LAST : NULL,
                                       LIMITS};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        for (const option_table *table = all[k]; table != NULL && table->rows != NULL; table++)
            for (const option_spec *option = table->rows; option->name != NULL; option++)
                if (index-- == 0)
                {
                    if (offset != NULL)
                        *offset = table->offset;
                    return option;
                }
    return NULL;
}

/// The place of an option, whose name has `length` bytes; -1 when there is none.
static int find(const verb *what, const char *name, size_t length)
{
    const option_spec *option;
    for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
        if (strlen(option->name) == length && strncmp(option->name, name, length) == 0)
            return (int)i;
    return -1;
}

bool argument_refused(const arguments *given, const char *name, const char *range, ...)
{
    char wanted[400];
    va_list list;
    va_start(list, range);
    (void)vsnprintf(wanted, sizeof wanted, range, list);
    va_end(list);
    char *end;
    const char *text = argument(given, name);
    (void)strtod(text, &end);
    const char *quote = end != text && *end == '\0' ? "" : "'"; // around what is no number
    return usage_refused(given, "--%s is %s%s%s, but must be %s", name, quote, text, quote, wanted);
}

/// Fields that no option has the name of.
static const struct
{
    const char *field, *option;
} OPTION_NAMES[] = {
    {"limits.points", "max-points"},
    {"angle_sigma", "sigma"},
    {"limit_normals", "normals"},
    {"classes", "class"},
    {"max_degree", "degree"},
    {"max_levels", "levels"},
    {"max_points", "points"},
    {"max_vertices", "vertices"},
    {"min_degree", "degree"},
    {"min_points", "points"},
    {"min_vertices", "vertices"},
    {"on_sphere", "on"},
    {"parameters", "parameterization"},
    {"read.format", "from"},
    {"shape", "tangents"},
    {"tangent_order", "tangents"},
    {"write.format", "to"},
};

/// The option that sets a field, as "min_quality", "rules.boundary" or "degree[0]"; null for none.
static const option_spec *option_of_field(const arguments *given, const char *field)
{
    const char *inner = strrchr(field, '.');
    char name[sizeof((bat_error *)0)->option];
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(inner != NULL ? inner + 1 : field, "["),
                   inner != NULL ? inner + 1 : field);
    for (size_t i = 0; i < sizeof OPTION_NAMES / sizeof *OPTION_NAMES; i++)
        if (strcmp(OPTION_NAMES[i].field, name) == 0 || strcmp(OPTION_NAMES[i].field, field) == 0)
            (void)snprintf(name, sizeof name, "%s", OPTION_NAMES[i].option);
    static const char ANGULAR[] = "angular_"; // the second number of an option
    char *second = strstr(name, ANGULAR);
    if (second != NULL)
        memmove(second, second + sizeof ANGULAR - 1, strlen(second + sizeof ANGULAR - 1) + 1);
    for (char *at = name; *at != '\0'; at++)
        *at = *at == '_' ? '-' : *at;
    int index = find(given->verb, name, strlen(name));
    return index < 0 ? NULL : option_at(given->verb, (size_t)index, NULL);
}

void argument_wording(const arguments *given, const bat_error *error, char text[WORDING_SIZE])
{
    const option_spec *option = option_of_field(given, error->option), *remedy = option_of_field(given, error->remedy);
    bool typed = option != NULL && argument(given, option->name) != NULL;
    int used = snprintf(text, WORDING_SIZE, "%s%s%s", typed ? "--" : "", typed ? option->name : "",
                        error->text + (typed ? strlen(error->option) : 0));
    if (error->status == BAT_NO_MEMORY && argument(given, "max-memory") != NULL)
        (void)snprintf(text + used, WORDING_SIZE - (size_t)used, "; use a larger --max-memory");
    if (remedy == NULL || (remedy->value == NULL && argument(given, remedy->name) != NULL))
        return;
    // A value in small letters is the only one.
    bool only = remedy->value != NULL && islower((unsigned char)remedy->value[0]);
    (void)snprintf(text + used, WORDING_SIZE - (size_t)used, "; --%s%s%s %s", remedy->name, only ? " " : "",
                   only ? remedy->value : "", error->remedy_effect);
}

bool usage_accepts(const arguments *given, bat_status status)
{
    char text[WORDING_SIZE];
    if (status == BAT_OK)
        return true;
    argument_wording(given, report_error(), text);
    return usage_refused(given, "%s", text);
}

/// One option at argv[at], which begins with a dash; *at moves to its last word.
static bool read_option(arguments *given, int argc, char **argv, int *at, int *exit_code)
{
    const char *word = argv[*at], *attached = NULL;
    int index;
    if (word[1] != '-')
        index = strcmp(word, "-o") == 0 ? find(given->verb, "output", strlen("output")) : -1;
    else
    {
        size_t length = strcspn(word + 2, "=");
        attached = word[2 + length] == '=' ? word + 3 + length : NULL;
        index = find(given->verb, word + 2, length);
    }
    if (index < 0)
    {
        *exit_code = usage_error(given, "there is no option '%s'", word);
        return false;
    }
    const option_spec *option = option_at(given->verb, (size_t)index, NULL);
    const char *value = attached;
    *exit_code = EXIT_DONE;
    if (given->values[index] != NULL)
        *exit_code = usage_error(given, "--%s is given twice", option->name);
    else if (option->value == NULL && attached != NULL)
        *exit_code = usage_error(given, "--%s takes no value", option->name);
    else if (option->value == NULL)
        value = "";
    else if (attached == NULL && *at + 1 < argc)
        value = argv[++*at];
    else if (attached == NULL)
        *exit_code = usage_error(given, "--%s needs a value (%s)", option->name, option->value);
    given->values[index] = value;
    return *exit_code == EXIT_DONE;
}

bool arguments_read(const verb *what, int argc, char **argv, arguments *given, int *exit_code)
{
    *given = (arguments){.verb = what, .positional = (const char *const *)argv + 1};
    bool only_files = false;
    for (int i = 1; i < argc; i++)
    {
        const char *word = argv[i];
        if (!only_files && strcmp(word, "--") == 0)
            only_files = true;
        else if (!only_files && (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0))
        {
            help_print(what, i + 1 < argc && strcmp(argv[i + 1], "all") == 0);
            *exit_code = EXIT_DONE;
            return false;
        }
        else if (!only_files && word[0] == '-' && word[1] != '\0')
        {
            if (!read_option(given, argc, argv, &i, exit_code))
                return false;
        }
        else if (what->formats == NULL && given->positional_count == what->positional.max)
        {
            *exit_code = usage_error(given, "'%s' is one argument too many", word);
            return false;
        }
        else
            argv[1 + given->positional_count++] = argv[i];
    }
    if (given->positional_count < (what->formats != NULL ? 1 : what->positional.min))
    {
        *exit_code = usage_error(given, "an argument is missing");
        return false;
    }
    return true;
}

const char *argument(const arguments *given, const char *name)
{
    int index = find(given->verb, name, strlen(name));
    return index < 0 ? NULL : given->values[index];
}

void argument_set(arguments *given, const char *name, const char *value)
{
    int index = find(given->verb, name, strlen(name));
    if (index >= 0)
        given->values[index] = value;
}

const char *argument_first(const arguments *given, const char *const *names)
{
    while (*names != NULL && argument(given, *names) == NULL)
        names++;
    return *names;
}

bool argument_whole(const arguments *given, const char *name, long low, long high, long absent, long *value)
{
    const char *text = argument(given, name);
    *value = absent;
    if (text == NULL)
        return true;
    char *end;
    errno = 0;
    *value = strtol(text, &end, 10);
    if (end != text && *end == '\0' && errno == 0 && *value >= low && *value <= high)
        return true;
    return argument_refused(given, name, "a whole number from %ld to %ld", low, high);
}

bool argument_word(const arguments *given, const char *name, const char *const *words, int absent, int *index)
{
    const char *text = argument(given, name);
    *index = absent;
    if (text == NULL)
        return true;
    for (*index = 0; words[*index] != NULL; ++*index)
        if (strcmp(words[*index], text) == 0)
            return true;
    char known[200] = "";
    for (int i = 0; words[i] != NULL; i++)
    {
        size_t used = strlen(known);
        (void)snprintf(known + used, sizeof known - used, "%s%s", i > 0 ? ", " : "", words[i]);
    }
    return argument_refused(given, name, "one of %s", known);
}

bool argument_list(const arguments *given, const char *name, double low, double high, bool whole, number_list *list)
{
    const char *text = argument(given, name);
    if (text == NULL)
        return true;
    number_list read = {.count = 0};
    for (const char *at = text; read.count < MAX_LISTED;)
    {
        char *end;
        double value = strtod(at, &end);
        bool good = end != at && (*end == ',' || *end == '\0') && value >= low && value <= high;
        if (!good || (whole && value != floor(value)))
            break;
        read.numbers[read.count++] = value;
        if (*end == '\0')
        {
            *list = read;
            return true;
        }
        at = end + 1;
    }
    return argument_refused(given, name, "up to %d %snumbers from %g to %g, as in %g,%g", MAX_LISTED, whole ? "whole " : "",
                            low, high, low, high);
}

bool argument_choice(const arguments *given, const char *name, const bat_family *family, void *value)
{
    const bat_choice *choice;
    const char *text = argument(given, name);
    if (text == NULL)
        return true;
    if (!usage_accepts(given, bat_choice_find(family, text, &choice, report_error())))
        return false;
    *(int *)value = choice->value;
    return true;
}

/// A number into a field.
static bool store_number(const arguments *given, const option_spec *option, double *field)
{
    const option_field *how = &option->field;
    const char *name = option->name, *text = argument(given, name);
    char *end;
    *field = strtod(text, &end);
    if (end == text || *end != '\0' || !isfinite(*field))
        return argument_refused(given, name, "a finite number");
    if (how->kind == FIELD_POSITIVE && !(*field > 0))
        return argument_refused(given, name, "finite and above 0");
    if (how->kind == FIELD_DEGREES && !(*field <= (double)how->high && *field >= 0 && (*field > 0 || how->low == 0)))
        return argument_refused(given, name, how->low == 0 ? "from 0 to 180" : "above 0 and at most 180");
    *field *= how->kind == FIELD_DEGREES ? DEGREE : 1;
    return true;
}

/// A whole number, or an enumerator, into a field of any size. False after a message.
static bool store_whole(const arguments *given, const option_spec *option, void *field)
{
    const option_field *how = &option->field;
    long value = how->low;
    if (how->kind == FIELD_CHOICE)
        return argument_choice(given, option->name, how->family, field);
    if (how->kind == FIELD_WHOLE && !argument_whole(given, option->name, how->low, how->high, 0, &value))
        return false;
    int32_t narrow = (int32_t)value;
    int64_t wide = value;
    memcpy(field, how->size == sizeof narrow ? (const void *)&narrow : (const void *)&wide, how->size);
    return true;
}

bool arguments_store(const arguments *given, void *job)
{
    size_t offset;
    const option_spec *option;
    for (size_t i = 0; (option = option_at(given->verb, i, &offset)) != NULL; i++)
    {
        void *field = (char *)job + offset + option->field.offset;
        if (given->values[i] == NULL || option->field.kind == FIELD_NONE)
            continue;
        if (option->field.kind == FIELD_TEXT)
            *(const char **)field = given->values[i];
        else if (option->field.kind == FIELD_FLAG)
            *(bool *)field = option->field.low == 0;
        else if (option->field.size == sizeof(double) && option->field.kind >= FIELD_NUMBER &&
                 option->field.kind <= FIELD_DEGREES)
        {
            if (!store_number(given, option, field))
                return false;
        }
        else if (!store_whole(given, option, field))
            return false;
    }
    return true;
}

bool argument_ending(const arguments *given, const bat_family *formats, int to)
{
    const char *path = argument(given, "output");
    const bat_choice *row;
    if (path == NULL || to != 0 || (bat_choice_of_path(formats, path, true, &row, NULL) == BAT_OK && row != NULL))
        return true;
    char known[256] = "";
    for (size_t i = 0, used = 0; (row = bat_choices(formats, i)) != NULL; i++)
        for (const char *at = row->writes && row->endings != NULL ? row->endings : ""; *at != '\0' && used < sizeof known;)
        {
            int length = (int)strcspn(at, " ");
            used += (size_t)snprintf(known + used, sizeof known - used, "%s%.*s", used > 0 ? ", " : "", length, at);
            at += length + (at[length] == ' ');
        }
    return usage_refused(given, "the ending of '%s' names no format (%s); --to does", path, known);
}
