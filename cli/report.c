#include "report.h"

#include "arguments.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <unistd.h>

/// The work under way, one at a time.
static struct
{
    const char *what; ///< null when there is none
    bool drawn;       ///< standard error is a terminal
    int percent;      ///< the one drawn last; -1 for none
    struct sigaction on_interrupt_before;
} work;

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

/// Let Ctrl-C ask for a stop, unless the program was started with it switched off.
static void catch_interrupt(void)
{
    struct sigaction action = {.sa_handler = on_interrupt};
    action.sa_flags = (int)(SA_RESETHAND | (unsigned)SA_RESTART);
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(SIGINT, NULL, &work.on_interrupt_before);
    if (work.on_interrupt_before.sa_handler != SIG_IGN)
        (void)sigaction(SIGINT, &action, NULL);
}

static bool draw_progress(void *context, double fraction)
{
    (void)context;
    int percent = (int)(100 * fraction);
    if (work.drawn && percent != work.percent)
        (void)fprintf(stderr, "\r%s %3d %%\033[K", work.what, percent);
    work.percent = percent;
    return interrupted == 0;
}

bat_progress report_progress(const char *what)
{
    if (work.what == NULL)
        catch_interrupt();
    work.what = what;
    work.drawn = isatty(STDERR_FILENO) != 0;
    work.percent = -1;
    return (bat_progress){draw_progress, NULL};
}

void report_progress_end(void)
{
    if (work.what == NULL)
        return;
    work.what = NULL;
    if (work.drawn && work.percent >= 0)
        (void)fputs("\r\033[K", stderr);
    (void)sigaction(SIGINT, &work.on_interrupt_before, NULL);
    if (interrupted)
    {
        (void)fputs("batten: stopped\n", stderr);
        (void)raise(SIGINT);
    }
}

json_t *report_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

int report_json(json_t *object)
{
    bool printed = object != NULL && json_dumpf(object, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) == 0;
    json_decref(object);
    if (printed)
        (void)printf("\n");
    else if (!ferror(stdout))
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    return EXIT_DONE;
}

int report_end(int code)
{
    if (code != EXIT_DONE || (fflush(stdout) == 0 && !ferror(stdout)))
        return code;
    return report_failure(NULL, &(bat_error){.text = "standard output cannot be written"});
}
