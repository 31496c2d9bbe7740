#include "analyze.h"

#include "report.h"
#include "verb.h"

#include "batten/curve_picture.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    /// The longest name of a scheme with its settings.
    SCHEME_SIZE = 512,
    PARAMETER_SIZE = 32,
    /// Samples of the basic limit function drawn: 2^DRAWN_LEVEL for each unit.
    DRAWN_LEVEL = 9,
};

/// A family of schemes: a name with settings, and one more setting that varies.
typedef struct named_family
{
    const char *scheme;
    char parameter[PARAMETER_SIZE];
} named_family;

/// The job of `batten analyze`.
typedef struct analyze_job
{
    verb_call call;
    bat_mask_analyze_options options;
    bat_curve_scheme scheme; ///< without --sweep
    bat_analysis analysis;   ///< of it
    bool sweeps;
    named_family family;
    bat_mask_sweep_options sweep;
    bat_mask_interval *intervals; ///< of the sweep
    size_t count;
} analyze_job;

static const option_spec OPTIONS[] = {
    {"depth", "N", METHOD, COMMON, "try products of N difference matrices, 1 to 24; more gives tighter bounds; default: 12",
     WHOLE(analyze_job, options.depth, 1, BAT_ANALYSIS_MAX_DEPTH)},
    {"sweep", "NAME=A:B", METHOD, COMMON, "find where the limit is C^k as the scheme's setting NAME goes from A to B",
     NO_FIELD},
    {"smoothness", "K", METHOD, COMMON, "the k of C^k for --sweep; default: 1", WHOLE(analyze_job, sweep.smoothness, 0, 30)},
    {"resolution", "T", METHOD, COMMON, "the shortest interval of --sweep that is divided; default: (B - A) / 32768",
     NUMBER(analyze_job, sweep.tolerance)},
    {"picture", "FILE", PICTURE, COMMON | IS_DRAWN, "draw the basic limit function to FILE: .svg, .png or .pdf", NO_FIELD},
    END_OF_OPTIONS,
};

static bool check_linear(const arguments *given, const bat_curve_scheme *scheme)
{
    if (scheme->kind != BAT_CURVE_SCHEME_LINEAR)
        (void)usage_error(given, "'%s' is not linear: it has no mask", given->positional[0]);
    return scheme->kind == BAT_CURVE_SCHEME_LINEAR;
}

static bat_status family_member(const named_family *family, double value, bat_curve_scheme *scheme, bat_error *error)
{
    char name[SCHEME_SIZE];
    char separator = strchr(family->scheme, ':') != NULL ? ',' : ':';
    int length = snprintf(name, sizeof name, "%s%c%s=%.17g", family->scheme, separator, family->parameter, value);
    if (length >= 0 && (size_t)length < sizeof name)
        return bat_curve_scheme_by_name(name, scheme, error);
    if (error != NULL)
        *error = (bat_error){.status = BAT_INVALID_ARGUMENT, .text = "the name of the scheme is too long"};
    return BAT_INVALID_ARGUMENT;
}

/// An empty mask, which the sweep refuses, stands for a member that does not exist.
static bat_mask family_mask(void *context, double value)
{
    bat_curve_scheme scheme;
    return family_member(context, value, &scheme, NULL) == BAT_OK ? scheme.mask : (bat_mask){0};
}

static bool read_number(const char *text, char **end, double *number)
{
    errno = 0;
    *number = strtod(text, end);
    return *end != text && errno == 0 && isfinite(*number);
}

/// NAME=A:B
static bool read_sweep(const char *text, named_family *family, bat_mask_sweep_options *options)
{
    const char *equals = strchr(text, '=');
    if (equals == NULL || equals == text || equals - text >= PARAMETER_SIZE)
        return false;
    memcpy(family->parameter, text, (size_t)(equals - text));
    family->parameter[equals - text] = '\0';
    char *end;
    return read_number(equals + 1, &end, &options->begin) && *end == ':' && read_number(end + 1, &end, &options->end) &&
           *end == '\0';
}

/// The options of a sweep, and both its ends tried. False after a message.
static bool check_sweep(analyze_job *job)
{
    const arguments *given = job->call.given;
    bat_mask_sweep_options *options = &job->sweep;
    bat_error error;
    options->analysis = job->options;
    job->family.scheme = job->call.input;
    if (!read_sweep(argument(given, "sweep"), &job->family, options))
        return argument_refused(given, "sweep", "NAME=A:B, as in w=0:0.25");
    if (!usage_accepts(given, bat_options_check(&bat_mask_sweep_fields, options, &error), &error))
        return false;
    double ends[] = {options->begin, options->end};
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_scheme scheme = {0};
        if (!usage_accepts(given, family_member(&job->family, ends[i], &scheme, &error), &error) ||
            !check_linear(given, &scheme))
            return false;
    }
    return true;
}

static int run_sweep(analyze_job *job)
{
    bat_error error;
    bat_mask_sweep_options options = job->sweep;
    options.progress = report_progress("analyze");
    bat_status status = bat_mask_sweep(family_mask, &job->family, &options, &job->intervals, &job->count, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : report_failure(NULL, &error);
}

/// The basic limit function over its support.
static int draw_basis(const char *path, const char *write_to, const char *name, const bat_mask *mask)
{
    bat_basis basis;
    bat_error error = {.text = "out of memory"};
    if (bat_mask_basis(mask, DRAWN_LEVEL, &basis, &error) != BAT_OK)
        return report_failure(NULL, &error);
    double *parameters = calloc(basis.count, sizeof *parameters);
    bat_status status = parameters == NULL ? BAT_NO_MEMORY : BAT_OK;
    for (size_t i = 0; i < basis.count && status == BAT_OK; i++)
        parameters[i] = basis.first + ldexp((double)i, -DRAWN_LEVEL);
    if (status == BAT_OK)
    {
        bat_chart_series series = {.x = parameters, .y = basis.values, .count = basis.count};
        bat_chart chart = bat_chart_defaults();
        chart.series = &series;
        chart.series_count = 1;
        chart.title = name;
        chart.x_label = "parameter";
        chart.y_label = "basic limit function";
        status = bat_chart_write(write_to, &chart, 1, NULL, &error);
    }
    free(parameters);
    bat_basis_free(&basis);
    return status == BAT_OK ? EXIT_DONE : report_failure(path, &error);
}

static void begin(void *to)
{
    analyze_job *job = to;
    job->options = bat_mask_analyze_defaults();
    job->sweep = bat_mask_sweep_defaults();
}

static bool check(void *of)
{
    static const char *const of_sweep[] = {"smoothness", "resolution", NULL};
    analyze_job *job = of;
    const arguments *given = job->call.given;
    bat_error error;
    job->sweeps = argument(given, "sweep") != NULL;
    if (job->sweeps && job->call.picture != NULL)
        (void)usage_error(given, "--picture does not go with --sweep");
    else if (job->sweeps)
        return check_sweep(job);
    else if (argument_first(given, of_sweep) != NULL)
        (void)usage_error(given, "--smoothness and --resolution go with --sweep");
    else
        return usage_accepts(given, bat_curve_scheme_by_name(job->call.input, &job->scheme, &error), &error) &&
               check_linear(given, &job->scheme);
    return false;
}

static int make(void *of)
{
    analyze_job *job = of;
    bat_error error;
    const char *name = job->call.input;
    if (job->sweeps)
        return run_sweep(job);
    if (bat_mask_analyze(&job->scheme.mask, &job->options, &job->analysis, &error) != BAT_OK)
        return report_failure(name, &error);
    return job->call.picture == NULL
               ? EXIT_DONE
               : draw_basis(job->call.picture, output_path(&job->call.files, "picture"), name, &job->scheme.mask);
}

static int report(void *of)
{
    const analyze_job *job = of;
    const char *name = job->call.input;
    analyze_sweep sweep = {job->family.parameter, job->sweep.smoothness, job->intervals, job->count};
    if (job->call.json)
        return report_json(job->sweeps ? analyze_sweep_json(name, &sweep) : analyze_json(name, &job->analysis));
    if (job->sweeps)
        analyze_report_sweep(stdout, name, &sweep);
    else
        analyze_report(stdout, name, &job->analysis);
    return EXIT_DONE;
}

static void end(void *of)
{
    analyze_job *job = of;
    bat_analysis_free(&job->analysis);
    free(job->intervals);
}

const verb VERB_ANALYZE = {
    .name = "analyze",
    .arguments = "SCHEME [options]",
    .summary = "analyze the limit of a linear scheme, with proven bounds",
    .about = "Analyze a linear scheme in the limit: symbol, local matrix and eigenvalues, limit stencils, polynomials, "
             "convergence and smoothness with proven bounds. `batten list schemes` names the schemes.",
    .example = "batten analyze four-point:w=0.05 --picture basis.svg",
    .options = (const option_table[]){{OPTIONS, 0}, {JSON_OPTION, 0}, {NULL, 0}},
    .min_positional = 1,
    .max_positional = 1,
    .list = "schemes",
    .job_size = sizeof(analyze_job),
    .begin = begin,
    .check = check,
    .make = make,
    .report = report,
    .end = end,
};
