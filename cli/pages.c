#include "verb.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

// Scripts that let a shell complete verbs, options and the names of choices, made of the tables of the verbs.

/// Print the names of a family's choices, separated by blanks.
static void print_choices(const bat_family *family)
{
    const bat_choice *choice;
    for (size_t i = 0; (choice = bat_choices(family, i)) != NULL; i++)
        (void)printf("%s%s", i > 0 ? " " : "", choice->name);
}

/// Print a text up to its first semicolon. Each character of `escaped` gets a backslash; `quote` stands for '.
static void print_short(const char *text, const char *escaped, const char *quote)
{
    for (; *text != '\0' && *text != ';'; text++)
        if (*text == '\'')
            (void)fputs(quote, stdout);
        else
            (void)printf("%s%c", strchr(escaped, *text) != NULL ? "\\" : "", *text);
}

/// The second word of a verb's name; null for none.
static const char *second_word(const verb *what)
{
    const char *blank = strchr(what->name, ' ');
    return blank != NULL ? blank + 1 : NULL;
}

/// Print the words that the first argument of a verb may be: those of its table, and commands that print those of lists.
static void print_words(const verb *what, const char *list)
{
    if (what->words != NULL)
        (void)fputs(what->words, stdout);
    if (what->list != NULL)
        (void)printf(list, what->list);
}

// bash

static void print_bash_verb(const verb *what)
{
    const option_spec *option;
    for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
        if (option->field.family != NULL)
        {
            (void)printf("    '%s --%s') words='", what->name, option->name);
            print_choices(option->field.family);
            (void)printf("' ;;\n");
        }
    (void)printf("    '%s '*)\n        if [[ $word == -* ]]; then words='", what->name);
    for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
        (void)printf("--%s ", option->name);
    (void)printf("--help'\n        elif [[ $COMP_CWORD -eq 2 ]]; then words=\"");
    print_words(what, "$(batten list %s 2> /dev/null | sed -n 's/^\\([^ ][^ ]*\\).*/\\1/p')");
    (void)printf("\"; fi ;;\n");
}

static void print_bash(void)
{
    (void)printf("# Completion of batten for bash.\n_batten()\n{\n"
                 "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=${COMP_WORDS[1]} words=\n"
                 "    [[ $verb != train || $COMP_CWORD -le 2 ]] || verb=\"train ${COMP_WORDS[2]}\"\n"
                 "    [[ $COMP_CWORD -ne 1 ]] || verb=\n    case \"$verb $before\" in\n    ' '* | 'help help') words='help "
                 "--help --version");
    for (const verb *const *each = VERBS; *each != NULL; each++)
        (void)printf(" %.*s", (int)strcspn((*each)->name, " "), (*each)->name);
    (void)printf("' ;;\n    'train train') words='");
    for (const verb *const *each = VERBS; *each != NULL; each++)
        if (second_word(*each) != NULL)
            (void)printf("%s ", second_word(*each));
    (void)printf("' ;;\n");
    for (const verb *const *each = VERBS; *each != NULL; each++)
        print_bash_verb(*each);
    (void)printf("    esac\n    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n}\n"
                 "complete -o default -F _batten batten\n");
}

// zsh

/// Print an option as _arguments takes it.
static void print_zsh_option(const char *dashes, const char *name, const option_spec *option)
{
    (void)printf("        '%s%s[", dashes, name);
    char text[HELP_TEXT_SIZE];
    print_short(help_summary(option, text), "[]:\\", "'\\''");
    (void)printf("]");
    if (option->value != NULL)
    {
        (void)printf(":");
        print_short(option->value, "[]:\\", "'\\''");
        (void)printf(option->field.family != NULL ? ":(" : ":_files");
    }
    if (option->value != NULL && option->field.family != NULL)
    {
        print_choices(option->field.family);
        (void)printf(")");
    }
    (void)printf("' \\\n");
}

static void print_zsh_verb(const verb *what)
{
    const option_spec *option;
    (void)printf("    '%s')\n        _arguments \\\n", what->name);
    for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
    {
        print_zsh_option("--", option->name, option);
        if (strcmp(option->name, "output") == 0)
            print_zsh_option("-", "o", option);
    }
    (void)printf("        '--help[the options]' ");
    if (what->words != NULL || what->list != NULL)
    {
        (void)printf("\"1:name:(");
        print_words(what, "$(batten list %s 2> /dev/null | sed -n 's/^\\([^ ][^ ]*\\).*/\\1/p')");
        (void)printf(")\" ");
    }
    (void)printf("'*:file:_files' ;;\n");
}

static void print_zsh(void)
{
    (void)printf("#compdef batten\n# Completion of batten for zsh.\n_batten()\n{\n    local verb=$words[2]\n"
                 "    local -a verbs models\n    verbs=(\n");
    for (const verb *const *each = VERBS; *each != NULL; each++)
        if (second_word(*each) == NULL)
        {
            (void)printf("        '%s:", (*each)->name);
            print_short((*each)->summary, ":\\", "'\\''");
            (void)printf("'\n");
        }
    (void)printf("        'train:train a learned scheme'\n        'help:explain a verb'\n    )\n    models=(");
    for (const verb *const *each = VERBS; *each != NULL; each++)
        if (second_word(*each) != NULL)
            (void)printf("%s ", second_word(*each));
    (void)printf(
        ")\n    if (( CURRENT == 2 )); then _describe verb verbs; return; fi\n"
        "    if [[ $verb == help ]]; then _describe verb verbs; return; fi\n"
        "    if [[ $verb == train ]]; then\n        if (( CURRENT == 3 )); then _describe model models; return; fi\n"
        "        verb=\"train $words[3]\"\n        shift words\n        (( CURRENT-- ))\n    fi\n"
        "    shift words\n    (( CURRENT-- ))\n    case $verb in\n");
    for (const verb *const *each = VERBS; *each != NULL; each++)
        print_zsh_verb(*each);
    (void)printf("    esac\n}\n_batten \"$@\"\n");
}

// fish

static void print_fish_verb(const verb *what)
{
    const option_spec *option;
    const char *second = second_word(what);
    char seen[120];
    if (second != NULL)
        (void)snprintf(seen, sizeof seen, "__fish_seen_subcommand_from train; and __fish_seen_subcommand_from %s", second);
    else
        (void)snprintf(seen, sizeof seen, "__fish_seen_subcommand_from %s; and not __fish_seen_subcommand_from train",
                       what->name);
    (void)printf("complete -c batten -n '%s' -a %s -d '",
                 second != NULL ? "__fish_seen_subcommand_from train" : "__fish_use_subcommand",
                 second != NULL ? second : what->name);
    print_short(what->summary, "\\", "\\'");
    (void)printf("'\n");
    if (what->words != NULL || what->list != NULL)
    {
        (void)printf("complete -c batten -n '%s' -a '", seen);
        print_words(what, "(batten list %s 2> /dev/null | string match -r \"^[^ ]+\")");
        (void)printf("'\n");
    }
    for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
    {
        (void)printf("complete -c batten -n '%s' %s-l %s%s", seen, strcmp(option->name, "output") == 0 ? "-s o " : "",
                     option->name, option->value != NULL ? " -r" : "");
        if (option->field.family != NULL)
        {
            (void)printf(" -f -a '");
            print_choices(option->field.family);
            (void)printf("'");
        }
        (void)printf(" -d '");
        char text[HELP_TEXT_SIZE];
        print_short(help_summary(option, text), "\\", "\\'");
        (void)printf("'\n");
    }
}

static void print_fish(void)
{
    (void)printf(
        "# Completion of batten for fish.\ncomplete -c batten -n __fish_use_subcommand -f -a train -d 'train a learned "
        "scheme'\ncomplete -c batten -n __fish_use_subcommand -f -a help -d 'explain a verb'\n");
    for (const verb *const *each = VERBS; *each != NULL; each++)
        print_fish_verb(*each);
}

// The verb

static const struct
{
    const char *name;
    void (*print)(void);
} SHELLS[] = {{"bash", print_bash}, {"zsh", print_zsh}, {"fish", print_fish}};

static int make(void *of)
{
    const verb_call *call = of;
    for (size_t i = 0; i < sizeof SHELLS / sizeof *SHELLS; i++)
        if (strcmp(call->input, SHELLS[i].name) == 0)
        {
            SHELLS[i].print();
            return EXIT_DONE;
        }
    return usage_error(call->given, "there is no completion for '%s'; there are bash, zsh and fish", call->input);
}

const verb VERB_COMPLETION = {
    .name = "completion",
    .arguments = "bash|zsh|fish",
    .summary = "print a script by which a shell completes verbs, options and names",
    .about = "Print a script by which a shell completes the verbs of batten, their options and the names of choices. `make "
             "install` puts the scripts where shells find them.",
    .example = "source <(batten completion bash)",
    .positional = {1, 1},
    .words = "bash zsh fish",
    .calls = {NULL, NULL, make, NULL, NULL, NULL},
};

// Manual pages of section 1, made of the tables of the verbs: one of the program, one of each verb.

enum
{
    PAGE_NAME_SIZE = 40
};

/// Print a text so that troff shows its characters as they are, between commands of troff.
static void print_text(FILE *out, const char *before, const char *text, const char *after)
{
    static const struct
    {
        char is;
        const char *troff;
    } SPECIAL[] = {{'\\', "\\(rs"}, {'-', "\\-"}, {'\'', "\\(aq"}, {'`', "\\(ga"}, {'^', "\\(ha"}, {'~', "\\(ti"}};
    (void)fprintf(out, "%s%s", before, *text == '.' ? "\\&" : "");
    for (size_t length = 1; *text != '\0'; text += length)
    {
        // The character that begins here, in UTF-8.
        unsigned char first = (unsigned char)*text;
        length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
        unsigned long code = first < 0x80 ? first : first & (0xFFU >> (length + 1));
        for (size_t k = 1; k < length; k++)
            code = code << 6 | ((unsigned char)text[k] & 0x3FU);
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
    (void)fputs(after, out);
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
            print_text(out, "", option->name, "\\fR");
            if (option->value != NULL)
                print_text(out, " \\fI", option->value, "\\fR");
            char text[HELP_TEXT_SIZE];
            print_text(out, "\n", help_summary(option, text), "\n");
        }
    }
}

static void print_verb(FILE *out, const verb *what)
{
    char name[PAGE_NAME_SIZE];
    print_head(out, what);
    print_text(out, "", page_name(what, name), "");
    print_text(out, " \\- ", what->summary, "\n.SH SYNOPSIS\n");
    (void)fprintf(out, "\\fBbatten %s\\fR ", what->name);
    print_text(out, "", what->arguments, "");
    print_text(out, "\n.SH DESCRIPTION\n", what->about, "\n.SH OPTIONS\n");
    print_options(out, what);
    print_text(out,
               ".SS Help\n.TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR [all]\nthe common options, or all of them\n"
               ".SH EXAMPLE\n.nf\n",
               what->example, "\n.fi\n.SH SEE ALSO\n.BR batten (1)\n");
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
        print_text(out, "", (*each)->summary, "\n");
    }
    (void)fprintf(out, ".SH SEE ALSO\n");
    for (const verb *const *each = VERBS; *each != NULL; each++)
    {
        char name[PAGE_NAME_SIZE];
        print_text(out, ".BR ", page_name(*each, name), each[1] != NULL ? " (1),\n" : " (1)\n");
    }
}

/// Write one page to standard output, or to a file of a folder. `what` is null for the page of the program.
static int write_page(const verb_call *call, const verb *what)
{
    output_file page;
    FILE *out = stdout;
    if (call->output != NULL)
    {
        char name[PAGE_NAME_SIZE], file[PAGE_NAME_SIZE + 2];
        (void)snprintf(file, sizeof file, "%s.1", page_name(what, name));
        if (output_add(call, call->output, file, &page) != EXIT_DONE)
            return EXIT_BAD_INPUT;
        out = fopen(page.write_to, "w");
    }
    if (out == NULL)
        return report_failure(page.path, &(bat_error){.text = "cannot be written"});
    if (what != NULL)
        print_verb(out, what);
    else
        print_program(out);
    bool written = !ferror(out);
    if (out != stdout)
        written = fclose(out) == 0 && written;
    return written || out == stdout ? EXIT_DONE : report_failure(page.path, &(bat_error){.text = "cannot be written"});
}

static int make_manual(void *of)
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

static const option_spec MANUAL_OPTIONS[] = {
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
    .options = {{MANUAL_OPTIONS, 0}},
    .positional = {0, 1},
    .calls = {NULL, NULL, make_manual, NULL, NULL, NULL},
};
