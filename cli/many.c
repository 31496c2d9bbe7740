#include "verb.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef _OPENMP
#include <omp.h>
#endif

enum
{
    MAX_JOBS = 1024,
    WAIT_MS = 1000,  ///< how long a wait lasts at most
    STREAM_COUNT = 2 ///< standard output and standard error
};

typedef enum task_state
{
    TASK_WAITING,
    TASK_RUNNING,
    TASK_DONE,
    TASK_STOPPED ///< by a signal to the program
} task_state;

/// One input.
typedef struct task
{
    const char *input;
    char *output;
    task_state state;
    pid_t process;
    int alive;                   ///< a pipe that ends with the process
    int code;                    ///< the exit code, once it is done
    FILE *streams[STREAM_COUNT]; ///< temporary files of what it writes
} task;

/// All inputs of a call.
typedef struct many
{
    const arguments *given;
    many_verb run;
    task *tasks;
    size_t count, started, running, reported;
    long jobs;
    char threads[16]; ///< of each process
    json_t *list;     ///< the reports, with --json
    bool stopped;
} many;

// Outputs

/// The length of a name without ".gz".
static size_t unpacked_length(const char *name)
{
    size_t length = strlen(name);
    return length > 3 && strcasecmp(name + length - 3, ".gz") == 0 ? length - 3 : length;
}

/// "FOLDER/NAME", where `ending` takes the place of NAME's when it is not null; null when out of memory.
static char *join(const char *folder, const char *name, const char *ending)
{
    size_t length = strlen(name), ending_length = ending == NULL ? 0 : strcspn(ending, " ");
    if (ending != NULL)
    {
        length = unpacked_length(name);
        size_t dot = length;
        while (dot > 1 && name[dot - 1] != '.')
            dot--;
        length = dot > 1 ? dot - 1 : length;
    }
    size_t folder_length = strlen(folder);
    const char *slash = folder_length > 0 && folder[folder_length - 1] == '/' ? "" : "/";
    size_t size = folder_length + length + ending_length + 2;
    char *path = malloc(size);
    if (path != NULL)
        (void)snprintf(path, size, "%s%s%.*s%.*s", folder, slash, (int)length, name, (int)ending_length,
                       ending == NULL ? "" : ending);
    return path;
}

static int compare_outputs(const void *a, const void *b)
{
    const task *const *first = a, *const *second = b;
    return strcmp((*first)->output, (*second)->output);
}

/// Refuse two inputs whose outputs have one name.
static int check_names(const many *all)
{
    const task **sorted = calloc(all->count, sizeof *sorted);
    if (sorted == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    for (size_t i = 0; i < all->count; i++)
        sorted[i] = &all->tasks[i];
    qsort(sorted, all->count, sizeof(const task *), compare_outputs);
    int code = EXIT_DONE;
    for (size_t i = 1; i < all->count && code == EXIT_DONE; i++)
        if (strcmp(sorted[i - 1]->output, sorted[i]->output) == 0)
            code = usage_error(all->given, "'%s' and '%s' would both be written to '%s'", sorted[i - 1]->input,
                               sorted[i]->input, sorted[i]->output);
    free(sorted);
    return code;
}

/// A file by its number, whatever its path.
typedef struct file_number
{
    dev_t device;
    ino_t inode;
} file_number;

static bool number_of(const char *path, file_number *number)
{
    struct stat about;
    if (stat(path, &about) != 0)
        return false;
    *number = (file_number){about.st_dev, about.st_ino};
    return true;
}

static int compare_numbers(const void *a, const void *b)
{
    const file_number *p = a, *q = b;
    return p->device != q->device ? (p->device > q->device) - (p->device < q->device)
                                  : (p->inode > q->inode) - (p->inode < q->inode);
}

/// Refuse outputs that would replace inputs.
static int check_inputs(const many *all)
{
    file_number *inputs = calloc(all->count, sizeof *inputs), output;
    if (inputs == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    size_t count = 0;
    for (size_t i = 0; i < all->count; i++)
        count += number_of(all->tasks[i].input, &inputs[count]);
    qsort(inputs, count, sizeof *inputs, compare_numbers);
    int code = EXIT_DONE;
    for (size_t i = 0; i < all->count && code == EXIT_DONE; i++)
        if (number_of(all->tasks[i].output, &output) &&
            bsearch(&output, inputs, count, sizeof output, compare_numbers) != NULL)
            code = report_failure(all->tasks[i].output,
                                  &(bat_error){.text = "the output would replace an input; --in-place allows it"});
    free(inputs);
    return code;
}

/// Find the paths of the outputs.
static int name_outputs(many *all)
{
    const bat_family *formats = all->given->verb->formats;
    const char *folder = argument(all->given, "output"), *format = argument(all->given, "to");
    const bat_choice *row = NULL;
    bool written = format != NULL && bat_choice_find(formats, format, &row, NULL) == BAT_OK && row->writes;
    const char *ending = written ? row->endings : NULL;
    if (format != NULL && ending == NULL)
    {
        (void)argument_refused(all->given, "to", "a format with an ending, see `batten list formats`");
        return EXIT_BAD_USAGE;
    }
    for (size_t i = 0; i < all->count; i++)
    {
        const char *name = file_name(all->tasks[i].input);
        if (strcmp(all->tasks[i].input, "-") == 0)
            return usage_error(all->given, "standard input goes to a file, not to a folder");
        char *plain = strndup(name, unpacked_length(name));
        row = NULL;
        if (plain != NULL)
            (void)bat_choice_of_path(formats, plain, true, &row, NULL);
        free(plain);
        if (ending == NULL && (row == NULL || row->endings == NULL || !row->writes))
            return usage_error(all->given, "the ending of '%s' names no format to write; --to does", all->tasks[i].input);
        all->tasks[i].output = join(folder, name, ending);
        if (all->tasks[i].output == NULL)
            return report_failure(NULL, &(bat_error){.text = "out of memory"});
    }
    int code = check_names(all);
    return code == EXIT_DONE && argument(all->given, "in-place") == NULL ? check_inputs(all) : code;
}

// Processes

/// Run the verb for one input in the process that was made for it.
static void work(const many *all, const task *one)
{
    arguments given = *all->given;
    for (int s = 0; s < STREAM_COUNT; s++)
        (void)dup2(fileno(one->streams[s]), STDOUT_FILENO + s);
    interrupt_catch();
    interrupt_use(INTERRUPT_AT_ONCE);
    given.positional = &one->input;
    given.positional_count = 1;
    argument_set(&given, "output", one->output);
    if (argument(&given, "threads") == NULL)
        argument_set(&given, "threads", all->threads);
    exit(report_end(all->run(&given)));
}

static void close_streams(task *one)
{
    for (int s = 0; s < STREAM_COUNT; s++)
    {
        if (one->streams[s] != NULL)
            (void)fclose(one->streams[s]);
        one->streams[s] = NULL;
    }
}

/// Start the next task. False where the system allows no further process.
static bool start(many *all)
{
    task *one = &all->tasks[all->started];
    int ends[2];
    for (int s = 0; s < STREAM_COUNT; s++)
        one->streams[s] = tmpfile();
    if (one->streams[0] == NULL || one->streams[1] == NULL || pipe(ends) != 0)
    {
        close_streams(one);
        return false;
    }
    (void)fflush(NULL);
    one->process = fork();
    if (one->process == 0)
    {
        (void)close(ends[0]);
        work(all, one);
    }
    (void)close(ends[1]);
    one->alive = ends[0];
    if (one->process < 0)
    {
        (void)close(ends[0]);
        close_streams(one);
        return false;
    }
    one->state = TASK_RUNNING;
    all->started++;
    all->running++;
    return true;
}

/// Learn how a process has ended.
static void finish_task(many *all, task *one)
{
    int status;
    (void)close(one->alive);
    while (waitpid(one->process, &status, 0) < 0)
        if (errno != EINTR)
            status = -1;
    one->code = WIFEXITED(status) ? WEXITSTATUS(status) : EXIT_BAD_INPUT;
    if (WIFSIGNALED(status) && !all->stopped)
        report_text(one->streams[1], "batten: %.2000s: the process was ended by signal %d (%s)\n", one->input,
                    WTERMSIG(status), strsignal(WTERMSIG(status)));
    one->state = all->stopped && one->code != EXIT_DONE ? TASK_STOPPED : TASK_DONE;
    all->running--;
}

/// Wait until processes end.
static void wait_for_some(many *all, struct pollfd *polled, task **owners)
{
    nfds_t count = 0;
    for (size_t i = all->reported; i < all->started; i++)
        if (all->tasks[i].state == TASK_RUNNING)
        {
            polled[count] = (struct pollfd){.fd = all->tasks[i].alive, .events = POLLIN};
            owners[count++] = &all->tasks[i];
        }
    if (poll(polled, count, WAIT_MS) <= 0)
        return;
    for (nfds_t k = 0; k < count; k++)
        if (polled[k].revents != 0)
            finish_task(all, owners[k]);
}

// Reports

/// What a process wrote to one of its streams; null for nothing, or where there is no memory for it.
static char *text_of(FILE *from)
{
    long length = fseek(from, 0, SEEK_END) == 0 ? ftell(from) : 0;
    char *text = length > 0 ? calloc((size_t)length + 1, 1) : NULL;
    rewind(from);
    if (text != NULL && fread(text, 1, (size_t)length, from) == 0)
        text[0] = '\0';
    return text;
}

/// Print the first line of a report, and its notes behind it.
static void print_report(const task *one, const char *text)
{
    static const char NOTE[] = "note: ";
    const char *summary = text;
    report_text(stdout, "%s -> %s", one->input, one->output);
    while (summary != NULL && strncmp(summary, NOTE, sizeof NOTE - 1) == 0)
    {
        const char *end = strchr(summary, '\n');
        summary = end == NULL ? NULL : end + 1;
    }
    if (summary != NULL && *summary != '\0')
        (void)printf(": %.*s", (int)strcspn(summary, "\n"), summary);
    for (const char *line = text; line != NULL && *line != '\0';)
    {
        size_t length = strcspn(line, "\n");
        if (strncmp(line, NOTE, sizeof NOTE - 1) == 0)
            (void)printf("; %.*s", (int)length, line);
        line += length + (line[length] == '\n');
    }
    (void)printf("\n");
    (void)fflush(stdout);
}

static void report_task(many *all, const task *one)
{
    char *text = text_of(one->streams[0]), *error = text_of(one->streams[1]);
    if (error != NULL)
        (void)fputs(error, stderr);
    if (all->list != NULL)
    {
        // Names that are not UTF-8 become null.
        json_t *report = text != NULL ? json_loads(text, 0, NULL) : NULL;
        json_t *fault = error != NULL && one->code != EXIT_DONE ? json_stringn(error, strcspn(error, "\n")) : NULL;
        (void)json_array_append_new(all->list, json_pack("{s:o?, s:o?, s:i, s:o*, s:o*}", "input", json_string(one->input),
                                                         "output", json_string(one->output), "exit", one->code, "report",
                                                         report, "error", fault));
    }
    else if (one->code == EXIT_DONE && argument(all->given, "quiet") == NULL)
        print_report(one, text);
    free(text);
    free(error);
}

/// Report the tasks that are done, in the order of the inputs.
static void report_done(many *all)
{
    while (all->reported < all->started && all->tasks[all->reported].state >= TASK_DONE)
    {
        task *one = &all->tasks[all->reported++];
        if (one->state == TASK_DONE)
            report_task(all, one);
        close_streams(one);
    }
}

/// The exit code of the call, after the last words.
static int finish(many *all)
{
    size_t done = 0, unusable = 0;
    for (size_t i = 0; i < all->count; i++)
    {
        done += all->tasks[i].state == TASK_DONE && all->tasks[i].code == EXIT_DONE;
        unusable += all->tasks[i].state == TASK_DONE && all->tasks[i].code == EXIT_BAD_USAGE;
    }
    if (all->list != NULL)
    {
        json_t *whole = json_pack("{s:O, s:I, s:I}", "files", all->list, "done", (json_int_t)done, "failed",
                                  (json_int_t)(all->count - done));
        (void)report_json(whole);
    }
    (void)fflush(stdout);
    if (done < all->count)
        (void)fprintf(stderr, "batten: %zu of %zu files are done\n", done, all->count);
    return done == all->count ? EXIT_DONE : unusable == all->count ? EXIT_BAD_USAGE : EXIT_BAD_INPUT;
}

static int run_tasks(many *all)
{
    size_t jobs = (size_t)all->jobs;
    struct pollfd *polled = calloc(jobs, sizeof *polled);
    task **owners = calloc(jobs, sizeof(task *));
    int code = polled == NULL || owners == NULL ? report_failure(NULL, &(bat_error){.text = "out of memory"}) : EXIT_DONE;
    interrupt_use(INTERRUPT_COOPERATIVE);
    while (code == EXIT_DONE && (all->running > 0 || (!all->stopped && all->started < all->count)))
    {
        while (!all->stopped && all->started < all->count && all->running < jobs)
            if (!start(all))
                break;
        // A signal is handed on to the processes, once.
        bool stops = interrupt_pending() && !all->stopped;
        for (size_t i = 0; i < all->started && stops; i++)
            if (all->tasks[i].state == TASK_RUNNING)
                (void)kill(all->tasks[i].process, SIGTERM);
        all->stopped = all->stopped || stops;
        if (all->running > 0)
            wait_for_some(all, polled, owners);
        else if (!all->stopped && all->started < all->count)
            code = report_failure(NULL, &(bat_error){.text = "the system allows no further process"});
        report_done(all);
    }
    free(polled);
    free(owners);
    return code;
}

// The command line

bool many_wanted(const arguments *given)
{
    const char *output = argument(given, "output");
    struct stat about;
    size_t length = output != NULL ? strlen(output) : 0;
    return given->positional_count > 1 || argument(given, "jobs") != NULL || (length > 0 && output[length - 1] == '/') ||
           (output != NULL && stat(output, &about) == 0 && S_ISDIR(about.st_mode));
}

/// Refuse what does not go with several inputs.
static int check(const arguments *given)
{
    const char *output = argument(given, "output");
    struct stat about;
    if (output == NULL || is_standard_output(output))
        return usage_error(given, "several inputs, and --jobs, need -o FOLDER");
    if (stat(output, &about) == 0 && !S_ISDIR(about.st_mode))
        return usage_error(given, "several inputs, and --jobs, need a folder: '%s' is a file", output);
    const option_spec *option;
    for (size_t i = 0; (option = option_at(given->verb, i, NULL)) != NULL; i++)
        if ((option->marks & (IS_WRITTEN | IS_DRAWN)) != 0 && given->values[i] != NULL &&
            strcmp(option->name, "output") != 0)
            return usage_error(given, "--%s names one file: it goes with one input and -o FILE", option->name);
    return EXIT_DONE;
}

int many_run(const arguments *given, many_verb run)
{
    many all = {.given = given, .run = run, .count = given->positional_count};
    if (!argument_whole(given, "jobs", 1, MAX_JOBS, 1, &all.jobs))
        return EXIT_BAD_USAGE;
    int code = check(given);
    if (code != EXIT_DONE)
        return code;
    all.jobs = all.count < (size_t)all.jobs ? (long)all.count : all.jobs;
    // The processes share the threads that OpenMP would take.
    int threads = 1;
#ifdef _OPENMP
    threads = omp_get_max_threads();
#endif
    (void)snprintf(all.threads, sizeof all.threads, "%d", threads > all.jobs ? threads / (int)all.jobs : 1);
    all.tasks = calloc(all.count, sizeof *all.tasks);
    if (all.tasks == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    for (size_t i = 0; i < all.count; i++)
        all.tasks[i].input = given->positional[i];
    all.list = argument(given, "json") != NULL ? json_array() : NULL;
    code = name_outputs(&all);
    const char *folder = argument(given, "output");
    struct stat about;
    if (code == EXIT_DONE && mkdir(folder, 0777) != 0 &&
        !(errno == EEXIST && stat(folder, &about) == 0 && S_ISDIR(about.st_mode)))
    {
        bat_error error = {.line = 0};
        (void)snprintf(error.text, sizeof error.text, "cannot make the folder: %s", strerror(errno));
        code = report_failure(folder, &error);
    }
    if (code == EXIT_DONE)
    {
        (void)bat_outputs_sweep(all.tasks[0].output);
        code = run_tasks(&all);
    }
    if (code == EXIT_DONE)
        code = finish(&all);
    json_decref(all.list);
    for (size_t i = 0; i < all.count; i++)
        free(all.tasks[i].output);
    free(all.tasks);
    // Ends the program when a signal has come.
    interrupt_use(INTERRUPT_AT_ONCE);
    return code;
}
