#include "analyze.h"

#include "outputs.h"
#include "report.h"
#include "verbs.h"

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

static const option_spec OPTIONS[] = {
    {"depth", 0, "N", "try products of N difference matrices, 1 to 24; more gives tighter bounds; default: 12"},
    {"sweep", 0, "NAME=A:B", "find where the limit is C^k as the scheme's setting NAME goes from A to B"},
    {"smoothness", 0, "K", "the k of C^k for --sweep; default: 1"},
    {"resolution", 0, "T", "the shortest interval of --sweep that is divided; default: (B - A) / 32768"},
    {"picture", 0, "FILE", "draw the basic limit function to FILE: .svg, .png or .pdf"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"picture", FILE_DRAWN}, {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten analyze SCHEME [options]",
    .summary = "Analyze a linear scheme in the limit: symbol, local matrix and eigenvalues, limit stencils, polynomials,\n"
               "convergence and smoothness with proven bounds. `batten list schemes` names the schemes.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
    .files = FILES,
};

/// A family of schemes: a name with settings, and one more setting that varies.
typedef struct named_family
{
    const char *scheme;
    char parameter[PARAMETER_SIZE];
} named_family;

static int check_linear(const arguments *given, const bat_curve_scheme *scheme)
{
    return scheme->kind == BAT_CURVE_SCHEME_LINEAR
               ? EXIT_DONE
               : usage_error(given, "'%s' is not linear: it has no mask", given->positional[0]);
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

/// The options of a sweep, and both its ends tried.
static int read_sweep_options(const arguments *given, const bat_analysis_options *analysis, named_family *family,
                              bat_mask_sweep_options *options)
{
    long smoothness;
    *options = bat_mask_sweep_defaults();
    options->analysis = *analysis;
    family->scheme = given->positional[0];
    if (!read_sweep(argument(given, "sweep"), family, options))
        return usage_error(given, "--sweep takes NAME=A:B, as in w=0:0.25, not '%s'", argument(given, "sweep"));
    if (!argument_whole(given, "smoothness", 0, 30, (long)options->smoothness, &smoothness) ||
        !argument_number(given, "resolution", options->tolerance, &options->tolerance))
        return EXIT_BAD_USAGE;
    options->smoothness = (size_t)smoothness;
    bat_error wrong;
    if (bat_mask_sweep_options_check(options, &wrong) != BAT_OK)
        return usage_error(given, "%s", wrong.text);
    double ends[] = {options->begin, options->end};
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_scheme scheme;
        bat_error error;
        if (family_member(family, ends[i], &scheme, &error) != BAT_OK)
            return usage_error(given, "%s", error.text);
        int code = check_linear(given, &scheme);
        if (code != EXIT_DONE)
            return code;
    }
    return EXIT_DONE;
}

static int run_sweep(const arguments *given, const bat_analysis_options *analysis)
{
    named_family family;
    bat_mask_sweep_options options;
    int code = read_sweep_options(given, analysis, &family, &options);
    if (code != EXIT_DONE)
        return code;
    bat_mask_interval *intervals;
    size_t count;
    bat_error error;
    options.progress = report_progress("analyze");
    bat_status status = bat_mask_sweep(family_mask, &family, &options, &intervals, &count, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    analyze_sweep sweep = {family.parameter, options.smoothness, intervals, count};
    if (argument_flag(given, "json"))
        code = report_json(analyze_sweep_json(family.scheme, &sweep));
    else
        analyze_report_sweep(stdout, family.scheme, &sweep);
    free(intervals);
    return code;
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

static int run_analysis(const arguments *given, const bat_analysis_options *options)
{
    const char *name = given->positional[0];
    bat_curve_scheme scheme;
    bat_error error;
    if (bat_curve_scheme_by_name(name, &scheme, &error) != BAT_OK)
        return usage_error(given, "%s", error.text);
    int code = check_linear(given, &scheme);
    if (code != EXIT_DONE)
        return code;
    outputs files;
    bat_analysis analysis = {0};
    code = outputs_open(given, &files);
    if (code != EXIT_DONE)
        return code;
    if (bat_mask_analyze(&scheme.mask, options, &analysis, &error) != BAT_OK)
        code = report_failure(name, &error);
    if (code == EXIT_DONE && files.count > 0)
        code = draw_basis(argument(given, "picture"), output_path(&files, "picture"), name, &scheme.mask);
    code = outputs_close(&files, code);
    if (code == EXIT_DONE && argument_flag(given, "json"))
        code = report_json(analyze_json(name, &analysis));
    else if (code == EXIT_DONE)
        analyze_report(stdout, name, &analysis);
    bat_analysis_free(&analysis);
    return code;
}

int verb_analyze(int argc, char **argv)
{
    arguments given;
    int code;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    bat_analysis_options options = bat_analysis_defaults();
    long depth;
    if (!argument_whole(&given, "depth", 1, BAT_ANALYSIS_MAX_DEPTH, (long)options.depth, &depth))
        return EXIT_BAD_USAGE;
    options.depth = (size_t)depth;
    if (argument(&given, "sweep") != NULL && argument(&given, "picture") != NULL)
        return usage_error(&given, "--picture does not go with --sweep");
    if (argument(&given, "sweep") != NULL)
        return run_sweep(&given, &options);
    if (argument(&given, "smoothness") != NULL || argument(&given, "resolution") != NULL)
        return usage_error(&given, "--smoothness and --resolution go with --sweep");
    return run_analysis(&given, &options);
}
