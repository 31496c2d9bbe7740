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

int(report_failure)(const char *file, const bat_error *error)
{
    (void)fputs("batten: ", stderr);
    if (file != NULL)
        terminal_print(stderr, "%s:", file);
    if (error->line > 0)
        (void)fprintf(stderr, "%zu:", error->line);
    terminal_print(stderr, "%s%s\n", file != NULL || error->line > 0 ? " " : "", error->text);
    return EXIT_BAD_INPUT;
}

/// Options that lead out of a failure, by its status and a part of its text.
static const struct
{
    bat_status status;
    const char *part;
    const char *option, *effect;
} WAYS_OUT[] = {
    {BAT_NOT_MANIFOLD, "", "repair", "cuts the mesh there"},
    {BAT_BAD_FILE, "twice", "repair", "drops the face"},
    {BAT_BAD_FILE, "unit length", "project", "moves points onto the space"},
    {BAT_BAD_FILE, "a latitude outside", "space", "plane takes plane coordinates"},
    {BAT_BAD_FILE, "a longitude outside", "space", "plane takes plane coordinates"},
    {BAT_UNSUPPORTED, "option `crs`", "crs", "NAME names their system, as in --crs EPSG:25833"},
    {BAT_INVALID_ARGUMENT, "option extrapolate", "extrapolate", "goes on with constant velocity"},
    {BAT_NO_CONVERGENCE, "acceleration continuous", "tangents", "limited does without"},
    {BAT_INVALID_POINT, "rounding makes", "precision", "N keeps more decimals"},
};

int report_bad_input(const arguments *given, const char *file, const bat_error *error)
{
    bat_error whole = *error;
    for (size_t i = 0; i < sizeof WAYS_OUT / sizeof *WAYS_OUT; i++)
    {
        const char *option = WAYS_OUT[i].option, *end;
        if (error->status != WAYS_OUT[i].status || strstr(error->text, WAYS_OUT[i].part) == NULL ||
            !argument_exists(given, option) || argument_flag(given, option))
            continue;
        end = strchr(error->text, ';');
        int length = end != NULL ? (int)(end - error->text) : (int)strlen(error->text);
        (void)snprintf(whole.text, sizeof whole.text, "%.*s; --%s %s", length, error->text, option, WAYS_OUT[i].effect);
        break;
    }
    return report_failure(file, &whole);
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
