#include "arguments.h"

#include "terminal.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int usage_error(const arguments *given, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    (void)fputs("batten: ", stderr);
    terminal_print_list(stderr, format, list);
    (void)fprintf(stderr, "\nusage: %s\n", given->spec->usage);
    va_end(list);
    return EXIT_BAD_USAGE;
}

static void print_help(const verb_spec *spec)
{
    (void)printf("usage: %s\n\n%s\n\n", spec->usage, spec->summary);
    for (const option_spec *option = spec->options; option->name != NULL; option++)
    {
        char left[64];
        (void)snprintf(left, sizeof left, "%s--%s%s%s", option->letter == 'o' ? "-o, " : "", option->name,
                       option->value != NULL ? " " : "", option->value != NULL ? option->value : "");
        (void)printf("  %-26s %s\n", left, option->help);
    }
    (void)printf("  %-26s %s\n", "-h, --help", "this text");
}

/// The place of an option in the table; -1 when there is none.
static int find(const verb_spec *spec, const char *name, size_t length)
{
    for (int i = 0; spec->options[i].name != NULL; i++)
        if (strlen(spec->options[i].name) == length && strncmp(spec->options[i].name, name, length) == 0)
            return i;
    return -1;
}

static int find_letter(const verb_spec *spec, char letter)
{
    for (int i = 0; spec->options[i].name != NULL; i++)
        if (spec->options[i].letter == letter)
            return i;
    return -1;
}

/// One option at argv[at], which begins with a dash; *at moves to its last word.
static bool read_option(arguments *given, int argc, char **argv, int *at, int *exit_code)
{
    const char *word = argv[*at], *attached = NULL;
    int index;
    if (word[1] != '-')
        index = word[2] == '\0' ? find_letter(given->spec, word[1]) : -1;
    else
    {
        size_t length = strcspn(word + 2, "=");
        attached = word[2 + length] == '=' ? word + 3 + length : NULL;
        index = find(given->spec, word + 2, length);
    }
    if (index < 0)
    {
        *exit_code = usage_error(given, "there is no option '%s'", word);
        return false;
    }
    const option_spec *option = &given->spec->options[index];
    if (given->values[index] != NULL)
    {
        *exit_code = usage_error(given, "--%s is given twice", option->name);
        return false;
    }
    if (option->value == NULL && attached != NULL)
    {
        *exit_code = usage_error(given, "--%s takes no value", option->name);
        return false;
    }
    if (option->value == NULL)
        given->values[index] = "";
    else if (attached != NULL)
        given->values[index] = attached;
    else if (*at + 1 < argc)
        given->values[index] = argv[++*at];
    else
    {
        *exit_code = usage_error(given, "--%s needs a value (%s)", option->name, option->value);
        return false;
    }
    return true;
}

bool arguments_read(const verb_spec *spec, int argc, char **argv, arguments *given, int *exit_code)
{
    *given = (arguments){.spec = spec, .positional = (const char *const *)argv + 1};
    bool only_files = false;
    for (int i = 1; i < argc; i++)
    {
        const char *word = argv[i];
        if (!only_files && strcmp(word, "--") == 0)
            only_files = true;
        else if (!only_files && (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0))
        {
            print_help(spec);
            *exit_code = EXIT_DONE;
            return false;
        }
        else if (!only_files && word[0] == '-' && word[1] != '\0')
        {
            if (!read_option(given, argc, argv, &i, exit_code))
                return false;
        }
        else if (given->positional_count == spec->max_positional)
        {
            *exit_code = usage_error(given, "'%s' is one argument too many", word);
            return false;
        }
        else
            argv[1 + given->positional_count++] = argv[i];
    }
    if (given->positional_count < spec->min_positional)
    {
        *exit_code = usage_error(given, "an argument is missing");
        return false;
    }
    return true;
}

const char *argument(const arguments *given, const char *name)
{
    int index = find(given->spec, name, strlen(name));
    return index < 0 ? NULL : given->values[index];
}

void argument_set(arguments *given, const char *name, const char *value)
{
    int index = find(given->spec, name, strlen(name));
    if (index >= 0)
        given->values[index] = value;
}

bool argument_exists(const arguments *given, const char *name)
{
    return find(given->spec, name, strlen(name)) >= 0;
}

bool argument_flag(const arguments *given, const char *name)
{
    return argument(given, name) != NULL;
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
    (void)usage_error(given, "--%s takes a whole number from %ld to %ld, not '%s'", name, low, high, text);
    return false;
}

bool argument_number(const arguments *given, const char *name, double absent, double *value)
{
    const char *text = argument(given, name);
    *value = absent;
    if (text == NULL)
        return true;
    char *end;
    *value = strtod(text, &end);
    if (end != text && *end == '\0' && isfinite(*value))
        return true;
    (void)usage_error(given, "--%s takes a number, not '%s'", name, text);
    return false;
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
    (void)usage_error(given, "--%s takes one of %s, not '%s'", name, known, text);
    return false;
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
    (void)usage_error(given, "--%s takes up to %d %snumbers from %g to %g like %g,%g, not '%s'", name, MAX_LISTED,
                      whole ? "whole " : "", low, high, low, high, text);
    return false;
}

bool argument_threads(const arguments *given, int *threads)
{
    long value;
    bool good = argument_whole(given, "threads", 1, MAX_THREADS, 0, &value);
    *threads = (int)value;
    return good;
}

bool argument_choice(const arguments *given, const char *name, const bat_family *family, void *value)
{
    bat_error error;
    const bat_choice *choice;
    const char *text = argument(given, name);
    if (text == NULL)
        return true;
    if (bat_choice_find(family, text, &choice, &error) == BAT_OK)
    {
        *(int *)value = choice->value;
        return true;
    }
    (void)usage_error(given, "%s", error.text);
    return false;
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
    (void)usage_error(given, "the ending of '%s' names no format (%s); --to does", path, known);
    return false;
}
