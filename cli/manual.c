#include "verb.h"

#include "report.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

// Manual pages of section 1, made of the tables of the verbs: one of the program, one of each verb.

enum
{
    PAGE_NAME_SIZE = 40
};

/// The character that begins at `text`, in UTF-8; *length receives its bytes.
static unsigned long decode(const char *text, size_t *length)
{
    unsigned char first = (unsigned char)text[0];
    *length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    unsigned long code = first < 0x80 ? first : first & (0xFFU >> (*length + 1));
    for (size_t i = 1; i < *length; i++)
        code = code << 6 | ((unsigned char)text[i] & 0x3FU);
    return code;
}

/// Print a text so that troff shows its characters as they are, on lines of their own where it has several.
static void print_text(FILE *out, const char *text)
{
    static const struct
    {
        char is;
        const char *troff;
    } SPECIAL[] = {{'\\', "\\(rs"}, {'-', "\\-"}, {'\'', "\\(aq"}, {'`', "\\(ga"}, {'^', "\\(ha"}, {'~', "\\(ti"}};
    if (*text == '.')
        (void)fputs("\\&", out);
    for (size_t length = 1; *text != '\0'; text += length)
    {
        unsigned long code = decode(text, &length);
        size_t i = 0;
        while (i < sizeof SPECIAL / sizeof *SPECIAL && (unsigned long)SPECIAL[i].is != code)
            i++;
        if (i < sizeof SPECIAL / sizeof *SPECIAL)
            (void)fputs(SPECIAL[i].troff, out);
        else if (code < 0x80)
            (void)fputc((int)code, out);
        else
            (void)fprintf(out, "\\[u%04lX]", code);
    }
}

/// "batten-train-mesh"; `what` is null for the program.
static const char *page_name(const verb *what, char name[PAGE_NAME_SIZE])
{
    (void)snprintf(name, PAGE_NAME_SIZE, "batten%s%s", what != NULL ? "-" : "", what != NULL ? what->name : "");
    for (char *at = name; *at != '\0'; at++)
        *at = *at == ' ' ? '-' : *at;
    return name;
}

/// The title of a page, as "BATTEN-CURVE"; `what` is null for the page of the program.
static void print_head(FILE *out, const verb *what)
{
    char name[PAGE_NAME_SIZE];
    (void)fprintf(out, ".TH ");
    for (const char *at = page_name(what, name); *at != '\0'; at++)
        (void)fputc(toupper((unsigned char)*at), out);
    (void)fprintf(out, " 1 \"\" \"batten %s\" \"batten manual\"\n.SH NAME\n", bat_version());
}

static void print_options(FILE *out, const verb *what)
{
    const option_spec *option;
    for (option_group group = INPUT; group <= CALL; group++)
    {
        bool begun = false;
        for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
        {
            if (option->group != group)
                continue;
            if (!begun)
                (void)fprintf(out, ".SS %s\n", HELP_HEADINGS[group]);
            begun = true;
            (void)fprintf(out, ".TP\n\\fB%s\\-\\-", strcmp(option->name, "output") == 0 ? "\\-o\\fR, \\fB" : "");
            print_text(out, option->name);
            (void)fprintf(out, "\\fR");
            if (option->value != NULL)
            {
                (void)fprintf(out, " \\fI");
                print_text(out, option->value);
                (void)fprintf(out, "\\fR");
            }
            (void)fprintf(out, "\n");
            char text[HELP_TEXT_SIZE];
            print_text(out, help_summary(option, text));
            (void)fprintf(out, "\n");
        }
    }
}

static void print_verb(FILE *out, const verb *what)
{
    char name[PAGE_NAME_SIZE];
    print_head(out, what);
    print_text(out, page_name(what, name));
    (void)fprintf(out, " \\- ");
    print_text(out, what->summary);
    (void)fprintf(out, "\n.SH SYNOPSIS\n\\fBbatten %s\\fR ", what->name);
    print_text(out, what->arguments);
    (void)fprintf(out, "\n.SH DESCRIPTION\n");
    print_text(out, what->about);
    (void)fprintf(out, "\n.SH OPTIONS\n");
    print_options(out, what);
    (void)fprintf(out, ".SS Help\n.TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR [all]\nthe common options, or all of them\n"
                       ".SH EXAMPLE\n.nf\n");
    print_text(out, what->example);
    (void)fprintf(out, "\n.fi\n.SH SEE ALSO\n.BR batten (1)\n");
}

static void print_program(FILE *out)
{
    print_head(out, NULL);
    (void)fprintf(out,
                  "batten \\- turn coarse geometry into fair geometry\n.SH SYNOPSIS\n\\fBbatten\\fR \\fIVERB\\fR "
                  "[arguments]\n.SH DESCRIPTION\nEach verb reads files, makes one thing of them and writes it. "
                  "The exit code is 0 where all is done, 1 where the input or the result is bad, and 2 where the command "
                  "line is wrong.\n.SH VERBS\n");
    for (const verb *const *each = VERBS; *each != NULL; each++)
    {
        (void)fprintf(out, ".TP\n.B %s\n", (*each)->name);
        print_text(out, (*each)->summary);
        (void)fprintf(out, "\n");
    }
    (void)fprintf(out, ".SH SEE ALSO\n");
    for (const verb *const *each = VERBS; *each != NULL; each++)
    {
        char name[PAGE_NAME_SIZE];
        (void)fprintf(out, ".BR ");
        print_text(out, page_name(*each, name));
        (void)fprintf(out, " (1)%s\n", each[1] != NULL ? "," : "");
    }
}

/// Write one page to standard output, or to a file of a folder. `what` is null for the page of the program.
static int write_page(const verb_call *call, const verb *what)
{
    char path[1024];
    const char *write_to = NULL;
    bat_error error;
    FILE *out = stdout;
    if (call->output != NULL)
    {
        char name[PAGE_NAME_SIZE];
        if (snprintf(path, sizeof path, "%s/%s.1", call->output, page_name(what, name)) >= (int)sizeof path)
            return report_failure(NULL, &(bat_error){.text = "the folder's name is too long"});
        if (bat_outputs_add(call->files.files, path, &write_to, &error) != BAT_OK)
            return report_failure(path, &error);
        out = fopen(write_to, "w");
    }
    if (out == NULL)
        return report_failure(path, &(bat_error){.text = "cannot be written"});
    if (what != NULL)
        print_verb(out, what);
    else
        print_program(out);
    bool written = !ferror(out);
    if (out != stdout)
        written = fclose(out) == 0 && written;
    return written || out == stdout ? EXIT_DONE : report_failure(path, &(bat_error){.text = "cannot be written"});
}

static int make(void *of)
{
    verb_call *call = of;
    call->files.folder = call->output;
    if (call->output == NULL && call->input == NULL)
        return write_page(call, NULL);
    int code = call->output != NULL ? write_page(call, NULL) : EXIT_DONE;
    bool found = call->output != NULL;
    for (const verb *const *each = VERBS; *each != NULL && code == EXIT_DONE; each++)
        if (call->output != NULL || strcmp((*each)->name, call->input) == 0)
        {
            found = true;
            code = write_page(call, *each);
        }
    return found ? code : usage_error(call->given, "there is no verb '%s'", call->input);
}

static const option_spec OPTIONS[] = {
    {"output", "FOLDER", RESULT, COMMON, "write the pages of all verbs to FOLDER", NO_FIELD},
    END_OF_OPTIONS,
};

const verb VERB_MANUAL = {
    .name = "manual",
    .arguments = "[VERB] [-o FOLDER]",
    .summary = "print a manual page",
    .about =
        "Print the manual page of the program or of a verb, or write all pages to a folder. `make install` puts them where "
        "man finds them.",
    .example = "batten manual curve | man -l -",
    .options = {{OPTIONS, 0}},
    .positional = {0, 1},
    .calls = {NULL, NULL, make, NULL, NULL, NULL},
};
