#include "verb.h"

#include "batten/curve_picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Outputs

bool is_standard_output(const char *path)
{
    return path != NULL && (strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0);
}

void print_file_notes(const verb_call *call, const bat_mesh_notes *notes)
{
    for (size_t i = 0; i < notes->count && !call->silent && !call->json; i++)
        report_text(is_standard_output(call->output) ? stderr : stdout, "note: %s\n", notes->texts[i]);
}

json_t *file_notes_json(const bat_mesh_notes *notes)
{
    json_t *list = json_array();
    for (size_t i = 0; i < notes->count; i++)
        (void)json_array_append_new(list, json_string(notes->texts[i]));
    return list;
}

bool add_file_note(bat_mesh_notes *notes, const char *text)
{
    char **texts = realloc(notes->texts, (notes->count + 1) * sizeof *texts), *copy = strdup(text);
    notes->texts = texts != NULL ? texts : notes->texts;
    if (texts != NULL && copy != NULL)
        texts[notes->count++] = copy;
    else
        free(copy);
    return texts != NULL && copy != NULL;
}

/// Whether a path leads to a regular file, and to that of `other`.
static bool is_file(const char *path, const struct stat *other)
{
    struct stat own;
    return stat(path, &own) == 0 && S_ISREG(own.st_mode) && own.st_dev == other->st_dev && own.st_ino == other->st_ino;
}

/// Refuse an output to a file. Returns the program's exit code.
static int refuse_output(const arguments *given, const char *option, const char *use)
{
    bool is_output = strcmp(option, "output") == 0;
    return usage_error(given, "%s%s would overwrite '%s', which %s", is_output ? "" : "--", is_output ? "-o" : option,
                       argument(given, option), use);
}

/// Refuse an output to a file that is read, or to standard output. The result may replace IN, which is read before.
static int check_inputs(const arguments *given, const char *option)
{
    const verb *what = given->verb;
    const option_spec *other;
    const char *path = argument(given, option);
    struct stat file;
    bool replaces = strcmp(option, "output") == 0;
    for (size_t i = 0; (what->reads_files || what->formats != NULL) && !replaces && i < given->positional_count; i++)
        if (stat(given->positional[i], &file) == 0 && is_file(path, &file))
            return refuse_output(given, option, "is read");
    for (size_t i = 0; (other = option_at(what, i, NULL)) != NULL; i++)
        if ((other->marks & IS_READ) != 0 && given->values[i] != NULL && stat(given->values[i], &file) == 0 &&
            is_file(path, &file))
        {
            char reader[64];
            (void)snprintf(reader, sizeof reader, "--%s reads", other->name);
            return refuse_output(given, option, reader);
        }
    return fstat(STDOUT_FILENO, &file) == 0 && is_file(path, &file) ? refuse_output(given, option, "is standard output")
                                                                    : EXIT_DONE;
}

static int open_one(const arguments *given, const char *option, outputs *out)
{
    const char *path = argument(given, option);
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
    bat_status status = bat_outputs_add(out->files, path, &out->each[out->count].write_to, report_error());
    if (status == BAT_INVALID_ARGUMENT)
        return refuse_output(given, option, "another option writes");
    if (status != BAT_OK)
        return report_failure(path, report_error());
    out->each[out->count].option = option;
    out->each[out->count].path = path;
    out->count++;
    return EXIT_DONE;
}

/// Put the files in their places when `code` is EXIT_DONE, else remove them. Returns the program's exit code.
static int close_outputs(outputs *out, int code)
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

/// Open the files. Two outputs to one file, and an output to a file that is read (but for -o to IN), are a bad command line;
/// pictures need an ending that tells their format. Returns the program's exit code; after a failure nothing is open.
static int open_outputs(const arguments *given, outputs *out)
{
    *out = (outputs){.count = 0};
    if (bat_outputs_make(&out->files, report_error()) != BAT_OK)
        return report_failure(NULL, report_error());
    interrupt_files(out->files);
    int code = EXIT_DONE;
    const option_spec *option;
    for (size_t i = 0; code == EXIT_DONE && (option = option_at(given->verb, i, NULL)) != NULL; i++)
        if ((option->marks & (IS_WRITTEN | IS_DRAWN)) != 0 && given->values[i] != NULL)
            code = open_one(given, option->name, out);
    for (size_t i = 0; code == EXIT_DONE && (option = option_at(given->verb, i, NULL)) != NULL; i++)
        if ((option->marks & IS_DRAWN) != 0 && given->values[i] != NULL)
            code = report_status(NULL, given->values[i], bat_picture_check(given->values[i], report_error()));
    if (code != EXIT_DONE)
        (void)close_outputs(out, code);
    return code;
}

const char *output_path(const outputs *out, const char *option)
{
    for (size_t i = 0; i < out->count; i++)
        if (strcmp(out->each[i].option, option) == 0)
            return out->each[i].write_to;
    return out->piped && out->count > 0 && strcmp(option, "output") == 0 ? "/dev/null" : NULL;
}

int folder_path(const char *folder, const char *name, char path[FOLDER_PATH_SIZE])
{
    int length = snprintf(path, FOLDER_PATH_SIZE, "%s/%s", folder, name);
    if (length < 0 || length >= FOLDER_PATH_SIZE)
        return report_failure(NULL, &(bat_error){.text = "the folder's name is too long"});
    return EXIT_DONE;
}

int output_add(const verb_call *call, const char *folder, const char *name, output_file *file)
{
    int code = folder_path(folder, name, file->path);
    if (code != EXIT_DONE)
        return code;
    return report_status(NULL, file->path, bat_outputs_add(call->files.files, file->path, &file->write_to, report_error()));
}

// Verbs

/// Find the outputs. False after a message.
static bool choose_outputs(const verb *what, verb_call *call)
{
    size_t given = 0, known = 0;
    const option_spec *option;
    for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
    {
        bool written = (option->marks & (IS_WRITTEN | IS_DRAWN)) != 0;
        known += written;
        given += written && call->given->values[i] != NULL;
    }
    call->output = argument(call->given, "output");
    call->picture = argument(call->given, "picture");
    if (what->prints_result && given == 0 && !call->json)
        call->output = "-";
    bool piped = is_standard_output(call->output);
    call->quiet = call->silent || piped;
    const usage_rule rules[] = {
        {call->json && call->silent, "--json and --quiet exclude each other"},
        {call->json && piped, "--json and -o - both need standard output"},
        {known > 0 && given == 0 && call->silent && !what->prints_result,
         "there is no output: give -o OUT, or do without --quiet"},
    };
    return usage_obeys(call->given, rules, sizeof rules / sizeof *rules, NULL, NULL);
}

/// Run a verb for one input.
static int run(const arguments *given)
{
    const verb *what = given->verb;
    const verb_calls *calls = &what->calls;
    verb_call *call = calloc(1, what->job_size > 0 ? what->job_size : sizeof(verb_call));
    if (call == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    call->given = given;
    call->input = given->positional_count > 0 ? given->positional[0] : NULL;
    if (calls->begin != NULL)
        calls->begin(call);
    int code = EXIT_BAD_USAGE;
    bool stored = arguments_store(given, call);
    if (stored)
        interrupt_limit(call->max_seconds, call->max_memory);
    if (stored && choose_outputs(what, call) && (calls->check == NULL || calls->check(call)))
        code = open_outputs(given, &call->files);
    if (code == EXIT_DONE)
    {
        const char *out = output_path(&call->files, "output");
        code = calls->make(call);
        if (code == EXIT_DONE && calls->write != NULL && out != NULL)
            code = calls->write(call, out);
        code = close_outputs(&call->files, code);
        if (code == EXIT_DONE && calls->write != NULL && is_standard_output(call->output))
            code = calls->write(call, "-");
        if (code == EXIT_DONE && calls->report != NULL)
            code = calls->report(call);
    }
    if (calls->end != NULL)
        calls->end(call);
    free(call);
    return code;
}

int verb_run(const verb *what, int argc, char **argv)
{
    arguments given;
    int code;
    if (!arguments_read(what, argc, argv, &given, &code))
        return code;
    if (what->formats != NULL && many_wanted(&given))
        return many_run(&given, run);
    const char *output = argument(&given, "output");
    if (output != NULL && !is_standard_output(output))
        (void)bat_outputs_sweep(output);
    return run(&given);
}
