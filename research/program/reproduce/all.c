#include "reproduce.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

// All results into one folder, each by a process of its own, so that one that fails does not stop the others, and with a
// budget of time, so that the call ends.

enum
{
    MAX_WORDS = 32
};

/// Run one result with its standard output in a file. Does not return.
static void run_result(int argc, char **argv, const char *file)
{
    interrupt_files(NULL);
    if (freopen(file, "w", stdout) == NULL)
    {
        report_text(stderr, "batten: %s: %s\n", file, strerror(errno));
        _exit(EXIT_BAD_INPUT);
    }
    int code = report_end(verb_run(&VERB_REPRODUCE, argc, argv));
    (void)fflush(NULL);
    _exit(code);
}

/// What became of a result.
typedef struct outcome
{
    char state[48];
    double seconds;
} outcome;

/// Make `file` by the words of a command line, which stop it after `budget` seconds.
static outcome make_result(int argc, char **argv, double budget, const char *file)
{
    char part[FOLDER_PATH_SIZE + 8];
    (void)snprintf(part, sizeof part, "%s.part", file);
    struct timespec begin, end;
    (void)clock_gettime(CLOCK_MONOTONIC, &begin);
    (void)fflush(NULL);
    pid_t process = fork();
    if (process == 0)
        run_result(argc, argv, part);
    int status = -1;
    while (process > 0 && waitpid(process, &status, 0) < 0 && errno == EINTR)
        continue;
    (void)clock_gettime(CLOCK_MONOTONIC, &end);
    double seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    bool done = process > 0 && WIFEXITED(status) && WEXITSTATUS(status) == EXIT_DONE && rename(part, file) == 0;
    outcome made = {.seconds = seconds};
    if (!done)
        (void)unlink(part);
    if (!done && seconds >= budget)
        (void)snprintf(made.state, sizeof made.state, "left out: over %.4g s", budget);
    else
        (void)strcpy(made.state, done ? "made" : "failed");
    return made;
}

/// FOLDER/KIND where there is such a folder, else FOLDER.
static const char *folder_of_kind(const char *folder, const char *kind, char path[FOLDER_PATH_SIZE])
{
    struct stat found;
    bool below = folder_path(folder, kind, path) == EXIT_DONE && stat(path, &found) == 0 && S_ISDIR(found.st_mode);
    return below ? path : folder;
}

/// Make one result, or tell why not.
static outcome make_row(const reproduce_job *job, const reproduce_part *part, char file[FOLDER_PATH_SIZE])
{
    char name[64], folder[FOLDER_PATH_SIZE], data[FOLDER_PATH_SIZE], quick[128], budget[32], *words[MAX_WORDS];
    char most[] = "--max-seconds", output[] = "-o", from[] = "--data", as_json[] = "--json", verb_name[] = "reproduce",
         what[64];
    int count = 0;
    (void)snprintf(what, sizeof what, "%s", part->name);
    (void)snprintf(name, sizeof name, "%s.%s", part->name, job->call.json ? "json" : "txt");
    (void)snprintf(quick, sizeof quick, "%s", part->quick != NULL && job->quick ? part->quick : "");
    if (folder_path(job->folder, name, file) != EXIT_DONE || folder_path(job->folder, what, folder) != EXIT_DONE)
        return (outcome){"failed", 0};
    if (access(file, F_OK) == 0)
        return (outcome){"kept", 0};
    if (strcmp(quick, "-") == 0)
        return (outcome){"left out: long", 0};
    if (part->trains && job->without_trainings)
        return (outcome){"left out: a training", 0};
    if (job->data == NULL && part->needs_data)
        return (outcome){"left out: needs --data", 0};
    words[count++] = verb_name;
    words[count++] = what;
    (void)snprintf(budget, sizeof budget, "%.17g", job->budget);
    words[count++] = most;
    words[count++] = budget;
    if (part->has_folder)
    {
        words[count++] = output;
        words[count++] = folder;
    }
    if (job->data != NULL && part->kind != NULL)
    {
        (void)folder_of_kind(job->data, part->kind, data);
        words[count++] = from;
        words[count++] = data;
    }
    if (job->call.json)
        words[count++] = as_json;
    char *rest = NULL;
    for (char *word = strtok_r(quick, " ", &rest); word != NULL && count < MAX_WORDS; word = strtok_r(NULL, " ", &rest))
        words[count++] = word;
    return make_result(count, words, job->budget, file);
}

int reproduce_all(const reproduce_job *job)
{
    output_file summary;
    int code = output_add(&job->call, job->folder, "summary.tsv", &summary);
    FILE *table = code == EXIT_DONE ? fopen(summary.write_to, "w") : NULL;
    if (table == NULL)
        return code != EXIT_DONE ? code : report_failure(summary.path, &(bat_error){.text = "it cannot be written"});
    (void)fprintf(table, "result\tstate\tseconds\tfile\tsummary\n");
    report_table rows = report_begin(job->call.json);
    reproduce_part part;
    size_t failed = 0;
    for (size_t i = 0; reproduce_part_at(i, &part) && !interrupt_pending(); i++)
    {
        char file[FOLDER_PATH_SIZE] = "";
        outcome result = make_row(job, &part, file);
        failed += strcmp(result.state, "failed") == 0;
        (void)fprintf(table, "%s\t%s\t%.1f\t%s\t%s\n", part.name, result.state, result.seconds, file_name(file),
                      part.summary);
        report_row(&rows, "{name:-20} {state:-22} {seconds:8.1f} s\n", "name:s state:s seconds:n", part.name, result.state,
                   result.seconds);
        (void)fflush(stdout);
    }
    bool written = ferror(table) == 0;
    if (fclose(table) != 0 || !written)
        return report_drop(&rows, report_failure(summary.path, &(bat_error){.text = "it cannot be written"}));
    code = report_print(job->call.json, "\n{failed} failed; {folder}/summary.tsv\n", "failed:z folder:s rows:o", failed,
                        job->folder, rows.rows);
    // The summary appears even where a result has failed, so the call has not.
    return code;
}
