#include "verb.h"

#include <stdio.h>
#include <string.h>

enum
{
    INDENT = 2,       ///< of the name of an option
    DESCRIPTION = 26, ///< where descriptions begin
    LINE_SIZE = 400
};

const char *const HELP_HEADINGS[HELP_GROUPS] = {"Input", "Method", "Result", "Picture", "Processes and threads"};

const char *verb_program(const verb *what)
{
    return what->program != NULL ? what->program : "batten";
}

/// The number of characters of `length` bytes of UTF-8.
static size_t count_characters(const char *text, size_t length)
{
    size_t count = 0;
    for (size_t i = 0; i < length; i++)
        count += ((unsigned char)text[i] & 0xC0) != 0x80;
    return count;
}

/// Print a text, which begins at `column` of its line, with line breaks; further lines begin at `indent`. Ends the line.
static void wrap(const char *text, size_t column, size_t indent)
{
    bool begins = true;
    while (*text != '\0')
    {
        size_t length = strcspn(text, " \n"), wide = count_characters(text, length);
        if (!begins && column + 1 + wide > HELP_WIDTH)
        {
            (void)printf("\n%*s", (int)indent, "");
            column = indent;
            begins = true;
        }
        (void)printf("%s%.*s", begins ? "" : " ", (int)length, text);
        column += wide + !begins;
        text += length;
        begins = *text == '\n';
        if (begins)
        {
            (void)printf("\n%*s", (int)indent, "");
            column = indent;
        }
        text += *text != '\0';
    }
    (void)putchar('\n');
}

const char *help_summary(const option_spec *option, char *text)
{
    const char *place = strstr(option->summary, "{}");
    const bat_choice *choice;
    if (place == NULL || option->field.family == NULL)
        return option->summary;
    int used = snprintf(text, HELP_TEXT_SIZE, "%.*s", (int)(place - option->summary), option->summary);
    for (size_t i = 0; (choice = bat_choices(option->field.family, i)) != NULL && used < HELP_TEXT_SIZE; i++)
        used += snprintf(text + used, HELP_TEXT_SIZE - (size_t)used, "%s%s", i > 0 ? ", " : "", choice->name);
    if (used < HELP_TEXT_SIZE)
        (void)snprintf(text + used, HELP_TEXT_SIZE - (size_t)used, "%s", place + 2);
    return text;
}

static void print_option(const option_spec *option)
{
    char left[LINE_SIZE], text[HELP_TEXT_SIZE];
    (void)snprintf(left, sizeof left, "%*s%s--%s%s%s", INDENT, "", strcmp(option->name, "output") == 0 ? "-o, " : "",
                   option->name, option->value != NULL ? " " : "", option->value != NULL ? option->value : "");
    size_t wide = count_characters(left, strlen(left));
    (void)fputs(left, stdout);
    if (wide + 2 > DESCRIPTION)
        (void)printf("\n%*s", DESCRIPTION, "");
    else
        (void)printf("%*s", (int)(DESCRIPTION - wide), "");
    wrap(help_summary(option, text), DESCRIPTION, DESCRIPTION);
}

void help_print(const verb *what, bool all)
{
    char usage[LINE_SIZE];
    size_t indent =
        (size_t)snprintf(usage, sizeof usage, "usage: %s %s %s", verb_program(what), what->name, what->arguments) -
        strlen(what->arguments);
    wrap(usage, 0, indent);
    (void)fputc('\n', stdout);
    wrap(what->about, 0, 0);
    size_t left_out = 0;
    const option_spec *option;
    for (option_group group = INPUT; group <= CALL; group++)
    {
        bool begun = false;
        for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
        {
            bool shown = all || (option->marks & COMMON) != 0;
            left_out += option->group == group && !shown;
            if (option->group != group || !shown)
                continue;
            if (!begun)
                (void)printf("\n%s\n", HELP_HEADINGS[group]);
            begun = true;
            print_option(option);
        }
    }
    if (what->example != NULL)
        (void)printf("\nExample\n  %s\n", what->example);
    if (left_out > 0)
        (void)printf("\n`%s %s --help all` shows %zu more options.\n", verb_program(what), what->name, left_out);
}
