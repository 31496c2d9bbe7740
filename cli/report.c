#include "report.h"

#include "interrupt.h"
#include "terminal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/// The work under way, one at a time.
static struct
{
    const char *what; ///< null when there is none
    bool drawn;       ///< standard error is a terminal
    int percent;      ///< the one drawn last; -1 for none
} work;

static int report_text(const char *file, size_t line, const char *text)
{
    (void)fputs("batten: ", stderr);
    if (file != NULL)
        terminal_print(stderr, "%s:", file);
    if (line > 0)
        (void)fprintf(stderr, "%zu:", line);
    terminal_print(stderr, "%s%s\n", file != NULL || line > 0 ? " " : "", text);
    return EXIT_BAD_INPUT;
}

int(report_failure)(const char *file, const bat_error *error)
{
    return report_text(file, error->line, error->text);
}

int report_bad_input(const arguments *given, const char *file, const bat_error *error)
{
    char text[WORDING_SIZE];
    argument_wording(given, error, text);
    return report_text(file, error->line, text);
}

void report_notes(const bat_mesh_notes *notes, FILE *stream)
{
    for (size_t i = 0; i < notes->count; i++)
        terminal_print(stream, "note: %s\n", notes->texts[i]);
}

json_t *report_notes_json(const bat_mesh_notes *notes)
{
    json_t *list = json_array();
    for (size_t i = 0; i < notes->count; i++)
        (void)json_array_append_new(list, json_string(notes->texts[i]));
    return list;
}

static bool draw_progress(void *context, double fraction)
{
    (void)context;
    int percent = (int)(100 * fraction);
    if (work.drawn && percent != work.percent)
        (void)fprintf(stderr, "\r%s %3d %%\033[K", work.what, percent);
    work.percent = percent;
    return !interrupt_pending();
}

bat_progress report_progress(const char *what)
{
    interrupt_use(INTERRUPT_COOPERATIVE);
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
    interrupt_use(INTERRUPT_AT_ONCE);
}

json_t *report_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

/// Print JSON with the control characters beyond those of ASCII escaped as well.
static void print_json(const char *text)
{
    for (const unsigned char *at = (const unsigned char *)text; *at != '\0'; at++)
        if (*at == 0x7f)
            (void)printf("\\u007f");
        else if (at[0] == 0xc2 && at[1] < 0xa0)
            (void)printf("\\u%04x", *++at);
        else
            (void)putchar(*at);
    (void)printf("\n");
}

int report_json(json_t *object)
{
    char *text = object != NULL ? json_dumps(object, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) : NULL;
    json_decref(object);
    if (text == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    print_json(text);
    free(text);
    return EXIT_DONE;
}

int report_end(int code)
{
    if (code != EXIT_DONE || (fflush(stdout) == 0 && !ferror(stdout)))
        return code;
    return report_failure(NULL, &(bat_error){.text = "standard output cannot be written"});
}
