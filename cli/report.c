#include "report.h"

#include "arguments.h"

#include <signal.h>
#include <stdio.h>
#include <unistd.h>

static volatile sig_atomic_t interrupted;

int(report_failure)(const char *file, const bat_error *error)
{
    (void)fputs("batten: ", stderr);
    if (file != NULL)
        (void)fprintf(stderr, "%s:", file);
    if (error->line > 0)
        (void)fprintf(stderr, "%zu:", error->line);
    (void)fprintf(stderr, "%s%s\n", file != NULL || error->line > 0 ? " " : "", error->text);
    return EXIT_BAD_INPUT;
}

static void on_interrupt(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

void report_catch_interrupt(void)
{
    struct sigaction action = {.sa_handler = on_interrupt};
    // A second Ctrl-C ends the program at once.
    action.sa_flags = (int)SA_RESETHAND;
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(SIGINT, &action, NULL);
}

bool report_interrupted(void)
{
    return interrupted != 0;
}

static bool draw_progress(void *context, double fraction)
{
    const char *what = context;
    if (isatty(STDERR_FILENO))
        (void)fprintf(stderr, "\r%s %3.0f %%", what, 100 * fraction);
    return interrupted == 0;
}

bat_progress report_progress(const char *what)
{
    return (bat_progress){draw_progress, (void *)(uintptr_t)what};
}

void report_progress_end(void)
{
    if (isatty(STDERR_FILENO))
        (void)fputs("\r\033[K", stderr);
}

int report_json(json_t *object)
{
    int failed = object == NULL || json_dumpf(object, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) != 0;
    json_decref(object);
    if (failed || printf("\n") < 0 || fflush(stdout) != 0)
    {
        (void)fputs("batten: standard output cannot be written\n", stderr);
        return EXIT_BAD_INPUT;
    }
    return EXIT_DONE;
}
