#include "interrupt.h"
#include "report.h"
#include "verb.h"

#include "batten/curve_picture.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool is_standard_output(const char *path)
{
    return path != NULL && (strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0);
}

/// Whether two paths lead to the same regular file.
static bool same_file(const char *first, const char *second)
{
    struct stat a, b;
    return stat(first, &a) == 0 && stat(second, &b) == 0 && S_ISREG(a.st_mode) && a.st_dev == b.st_dev &&
           a.st_ino == b.st_ino;
}

/// How an output is called on the command line.
static const char *shown(const char *option)
{
    return strcmp(option, "output") == 0 ? "-o" : option;
}

/// The dashes before it.
static const char *dashes(const char *option)
{
    return strcmp(option, "output") == 0 ? "" : "--";
}

/// Refuse an output to a file that is read. The result may replace IN, which is read before.
static int check_inputs(const arguments *given, const char *option)
{
    const verb *what = given->verb;
    const option_spec *other;
    const char *path = argument(given, option);
    bool replaces = strcmp(option, "output") == 0;
    for (size_t i = 0; (what->reads_files || what->formats != NULL) && !replaces && i < given->positional_count; i++)
        if (same_file(path, given->positional[i]))
            return usage_error(given, "%s%s would overwrite '%s', which is read", dashes(option), shown(option), path);
    for (size_t i = 0; (other = option_at(what, i, NULL)) != NULL; i++)
        if ((other->marks & IS_READ) != 0 && given->values[i] != NULL && same_file(path, given->values[i]))
            return usage_error(given, "%s%s would overwrite '%s', which --%s reads", dashes(option), shown(option), path,
                               other->name);
    return EXIT_DONE;
}

/// Whether what standard output was redirected to is the file of an option.
static bool is_redirected_to(const char *path)
{
    struct stat a, b;
    return stat(path, &a) == 0 && fstat(STDOUT_FILENO, &b) == 0 && S_ISREG(a.st_mode) && a.st_dev == b.st_dev &&
           a.st_ino == b.st_ino;
}

static int open_one(const arguments *given, const char *option, outputs *out)
{
    const char *path = argument(given, option);
    bat_error error;
    if (is_standard_output(path) && strcmp(option, "output") != 0)
        return usage_error(given, "--%s cannot be standard output", option);
    if (is_standard_output(path))
    {
        out->piped = true;
        return EXIT_DONE;
    }
    int code = check_inputs(given, option);
    if (code != EXIT_DONE)
        return code;
    if (is_redirected_to(path))
        return usage_error(given, "%s%s would overwrite '%s', which is standard output", dashes(option), shown(option),
                           path);
    bat_status status = bat_outputs_add(out->files, path, &out->each[out->count].write_to, &error);
    if (status == BAT_INVALID_ARGUMENT)
        return usage_error(given, "%s%s would overwrite '%s', which another option writes", dashes(option), shown(option),
                           path);
    if (status != BAT_OK)
        return report_failure(path, &error);
    out->each[out->count].option = option;
    out->each[out->count].path = path;
    out->count++;
    return EXIT_DONE;
}

/// Whether the endings of pictures tell their formats.
static int check_pictures(const arguments *given)
{
    bat_error error;
    const option_spec *option;
    for (size_t i = 0; (option = option_at(given->verb, i, NULL)) != NULL; i++)
        if ((option->marks & IS_DRAWN) != 0 && given->values[i] != NULL &&
            bat_picture_check(given->values[i], &error) != BAT_OK)
            return report_failure(given->values[i], &error);
    return EXIT_DONE;
}

int outputs_open(const arguments *given, outputs *out)
{
    bat_error error;
    *out = (outputs){.count = 0};
    if (bat_outputs_make(&out->files, &error) != BAT_OK)
        return report_failure(NULL, &error);
    interrupt_files(out->files);
    int code = EXIT_DONE;
    const option_spec *option;
    for (size_t i = 0; code == EXIT_DONE && (option = option_at(given->verb, i, NULL)) != NULL; i++)
        if ((option->marks & (IS_WRITTEN | IS_DRAWN)) != 0 && given->values[i] != NULL)
            code = open_one(given, option->name, out);
    if (code == EXIT_DONE)
        code = check_pictures(given);
    if (code != EXIT_DONE)
        (void)outputs_close(out, code);
    return code;
}

const char *output_path(const outputs *out, const char *option)
{
    for (size_t i = 0; i < out->count; i++)
        if (strcmp(out->each[i].option, option) == 0)
            return out->each[i].write_to;
    return out->piped && out->count > 0 && strcmp(option, "output") == 0 ? "/dev/null" : NULL;
}

int outputs_close(outputs *out, int code)
{
    bat_error error;
    if (code == EXIT_DONE)
    {
        interrupt_use(INTERRUPT_NEVER);
        if (bat_outputs_commit(out->files, &error) != BAT_OK)
            code = report_failure(error.index < out->count ? out->each[error.index].path : out->folder, &error);
    }
    interrupt_files(NULL);
    interrupt_use(INTERRUPT_AT_ONCE);
    bat_outputs_free(out->files);
    out->files = NULL;
    if (code != EXIT_DONE)
        out->piped = false;
    return code;
}
