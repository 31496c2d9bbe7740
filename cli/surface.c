#include "verbs.h"

#include "arguments.h"
#include "report.h"
#include "surface_input.h"
#include "surface_report.h"

#include "batten/batten.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MOST_FUNCTIONS = 100000000,
    MOST_ROUNDS = 1000,
    MOST_THREADS = 1024
};

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the surface to OUT (- for standard output)"},
    {"degree", 0, "P[,Q]", "of the spline in its two directions, 1 to 15; default 2"},
    {"tolerance", 0, "T", "refine where points are farther off than this, in their units"},
    {"functions", 0, "N",
     "the most functions, which is control points; default without --tolerance: a quarter of the points"},
    {"share", 0, "S", "stop when this share of the points is within the tolerance; default 1"},
    {"iterations", 0, "N", "the most refinements; default 30"},
    {"smoothing", 0, "WEIGHT", "of the thin plate; default: found by likelihood, or by --noise"},
    {"noise", 0, "D", "standard deviation of a coordinate: smooth until the distances match it"},
    {"robust", 0, NULL, "points far off count less"},
    {"corrections", 0, "N", "rounds that move parameters to the nearest place of the surface, after each fit; default 1"},
    {"final-corrections", 0, "N", "the same after the last refinement; default 0"},
    {"parameterization", 0, "NAME",
     "auto (default: what fits best by measure), learned, shape-preserving, stretch-minimizing, inverse-distance, uniform, "
     "mean-value (of a "
     "mesh), or a file with u v of each point of IN"},
    {"model", 0, "FILE", "learned: a network of your own, a safetensors file"},
    {"published", 0, NULL, "classical neighbourhoods as published: they may fail"},
    {"slide-boundary", 0, NULL, "corrections move boundary parameters too, along their sides"},
    {"no-repair", 0, NULL, "report folds of the parameters, but leave them"},
    {"boundary", 0, "N|FILE", "the first N points are the boundary loop, or FILE's are; default: found, or told in IN"},
    {"corners", 0, "A,B,C,D", "these points of IN, counted from 0, get (0,0), (1,0), (1,1), (0,1); default: found"},
    {"sides", 0, "NAME", "parameters along the sides: chord-length (default), centripetal or uniform"},
    {"drop-duplicates", 0, NULL, "leave out points that repeat another instead of refusing them"},
    {"picture", 0, "FILE", "draw cloud, surface, distances and parameters (.png, .svg or .pdf)"},
    {"parameters", 0, "FILE", "write u v of each point, in the order of IN"},
    {"samples", 0, "N", "of each cell and direction, for VTK and OBJ; default: the degree plus 1"},
    {"from", 0, "FORMAT", "xyz, csv, ply or obj; default: by the file's ending, failing that by its content"},
    {"to", 0, "FORMAT", "step, xml (G+Smo), vtk, obj or json; default: by OUT's ending"},
    {"threads", 0, "N", "default: all; the result does not depend on it"},
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten surface IN [-o OUT] [--tolerance T|--functions N] [--degree P,Q] [--picture FILE] [options]",
    .summary =
        "Fit an adaptive spline surface to the points of a file (XYZ, CSV, PLY, OBJ; - for standard input): a patch with "
        "one\nboundary, or a mesh of one. A spline surface (.xml, .json) as IN is written in another format.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = 1,
};

/// What the command line asks for.
typedef struct surface_job
{
    surface_input input;
    const char *output, *picture, *parameters, *model, *given; ///< files; may be null
    bat_surface_options options;
    bat_surface_write_options write;
    bool json, quiet;
} surface_job;

static bool read_degrees(const arguments *given, int degree[2])
{
    const char *text = argument(given, "degree");
    if (text == NULL)
        return true;
    char *end;
    long first = strtol(text, &end, 10), second = first;
    bool good = end != text;
    if (good && *end == ',')
    {
        text = end + 1;
        second = strtol(text, &end, 10);
        good = end != text;
    }
    good = good && *end == '\0' && first >= 1 && first <= BAT_SPLINE_MAX_DEGREE && second >= 1 &&
           second <= BAT_SPLINE_MAX_DEGREE;
    if (!good)
        (void)usage_error(given, "--degree takes a number from 1 to %d, or two like 3,2, not '%s'", BAT_SPLINE_MAX_DEGREE,
                          argument(given, "degree"));
    degree[0] = (int)first;
    degree[1] = (int)second;
    return good;
}

static bool read_smoothing(const arguments *given, bat_surface_fit_options *fit)
{
    if (!argument_number(given, "smoothing", 0, &fit->weight) || !argument_number(given, "noise", 0, &fit->noise))
        return false;
    if (argument(given, "smoothing") != NULL)
        fit->smoothing = BAT_SURFACE_SMOOTHING_GIVEN;
    else if (argument(given, "noise") != NULL)
        fit->smoothing = BAT_SURFACE_SMOOTHING_DISCREPANCY;
    return true;
}

static bool read_fit(const arguments *given, bat_surface_fit_options *fit)
{
    long functions, iterations, corrections, final_corrections, threads;
    if (!read_degrees(given, fit->space.degree) || !argument_number(given, "tolerance", 0, &fit->tolerance) ||
        !argument_number(given, "share", 1, &fit->share) || !read_smoothing(given, fit) ||
        !argument_whole(given, "functions", 1, MOST_FUNCTIONS, 0, &functions) ||
        !argument_whole(given, "iterations", 0, MOST_ROUNDS, fit->iterations, &iterations) ||
        !argument_whole(given, "corrections", 0, MOST_ROUNDS, fit->corrections, &corrections) ||
        !argument_whole(given, "final-corrections", 0, MOST_ROUNDS, 0, &final_corrections) ||
        !argument_whole(given, "threads", 1, MOST_THREADS, 0, &threads))
        return false;
    fit->functions = (size_t)functions;
    fit->iterations = (int)iterations;
    fit->corrections = (int)corrections;
    fit->final_corrections = (int)final_corrections;
    fit->threads = (int)threads;
    fit->robust = argument_flag(given, "robust");
    return true;
}

/// A name, or the file of given parameters, which has a dot or a slash in its name.
static bool read_parameterization(const arguments *given, surface_job *job)
{
    const char *text = argument(given, "parameterization");
    if (text == NULL)
        return true;
    for (int i = BAT_SURFACE_PARAMETERS_AUTO; i < BAT_SURFACE_PARAMETERS_GIVEN; i++)
        if (strcmp(text, bat_surface_parameters_name((bat_surface_parameters)i)) == 0)
        {
            job->options.parameters = (bat_surface_parameters)i;
            return true;
        }
    job->options.parameters = BAT_SURFACE_PARAMETERS_GIVEN;
    job->given = text;
    if (strpbrk(text, "./") != NULL)
        return true;
    (void)usage_error(given,
                      "--parameterization takes auto, learned, shape-preserving, stretch-minimizing, inverse-distance, "
                      "uniform, mean-value or a "
                      "file such as ./%s, not '%s'",
                      text, text);
    return false;
}

/// What is wrong with the command line; null for nothing.
static const char *find_fault(const arguments *given, const surface_job *job)
{
    const bat_surface_fit_options *fit = &job->options.fit;
    bool piped = job->output != NULL && strcmp(job->output, "-") == 0;
    if (fit->tolerance < 0 || (fit->tolerance == 0 && argument(given, "tolerance") != NULL))
        return "--tolerance takes a number above 0";
    if (!(fit->share > 0 && fit->share <= 1))
        return "--share takes a number above 0 and at most 1";
    if (fit->weight < 0)
        return "--smoothing takes a number of at least 0";
    if (argument(given, "noise") != NULL && !(fit->noise > 0))
        return "--noise takes a number above 0";
    if (argument(given, "noise") != NULL && argument(given, "smoothing") != NULL)
        return "--noise and --smoothing exclude each other";
    if (argument(given, "share") != NULL && argument(given, "tolerance") == NULL)
        return "--share needs --tolerance";
    if (job->model != NULL && job->options.parameters > BAT_SURFACE_PARAMETERS_LEARNED)
        return "--model goes with auto and learned parameters";
    if (job->output == NULL && job->picture == NULL && job->parameters == NULL && job->quiet)
        return "nothing is asked for: give -o OUT, --picture FILE or --parameters FILE";
    if (job->json && job->quiet)
        return "--json and --quiet exclude each other";
    return job->json && piped ? "--json and -o - both need standard output" : NULL;
}

/// False after a message.
static bool read_job(const arguments *given, surface_job *job)
{
    static const char *const SIDES[] = {"chord-length", "centripetal", "uniform", NULL};
    int sides;
    long samples;
    bat_error error;
    const char *to = argument(given, "to");
    *job = (surface_job){.output = argument(given, "output"),
                         .picture = argument(given, "picture"),
                         .parameters = argument(given, "parameters"),
                         .model = argument(given, "model"),
                         .options = bat_surface_defaults(),
                         .json = argument_flag(given, "json"),
                         .quiet = argument_flag(given, "quiet")};
    if (!surface_input_arguments(given, &job->input) || !read_fit(given, &job->options.fit) ||
        !read_parameterization(given, job) || !argument_word(given, "sides", SIDES, BAT_CLOUD_SIDES_CHORD_LENGTH, &sides) ||
        !argument_whole(given, "samples", 1, MOST_ROUNDS, 0, &samples))
        return false;
    job->options.sides = (bat_cloud_sides)sides;
    job->options.published = argument_flag(given, "published");
    job->options.no_repair = argument_flag(given, "no-repair");
    job->options.slide_boundary = argument_flag(given, "slide-boundary");
    job->write.samples = (size_t)samples;
    const char *fault = find_fault(given, job);
    if (fault == NULL && to != NULL && bat_surface_format_by_name(to, &job->write.format, &error) != BAT_OK)
        fault = error.text;
    if (fault == NULL && to == NULL && job->output != NULL &&
        bat_surface_format_of_path(job->output) == BAT_SURFACE_FORMAT_AUTO)
        fault = "OUT's ending tells no format (.step, .xml, .vtk, .obj, .json): --to does";
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    job->quiet = job->quiet || (job->output != NULL && strcmp(job->output, "-") == 0);
    return fault == NULL;
}

// A fit

/// Read the network and the parameters that are given, as far as they are. Returns the program's exit code.
static int read_helpers(const surface_job *job, const bat_cloud *cloud, bat_surface_model **model, double **given)
{
    bat_error error;
    if (job->model != NULL && bat_surface_model_read(job->model, model, &error) != BAT_OK)
        return report_failure(job->model, &error);
    if (job->given != NULL && bat_cloud_parameters_read(job->given, cloud, given, &error) != BAT_OK)
        return report_failure(job->given, &error);
    return EXIT_DONE;
}

static int reconstruct(const surface_job *job, bat_cloud *cloud, bat_surface_result *result)
{
    bat_error error;
    bat_surface_model *model = NULL;
    double *given = NULL;
    int code = read_helpers(job, cloud, &model, &given);
    if (code == EXIT_DONE)
    {
        bat_surface_options options = job->options;
        options.model = model;
        options.given = given;
        options.fit.progress = report_progress("fitting");
        bat_status status = bat_surface_reconstruct(cloud, &options, result, &error);
        report_progress_end();
        if (status != BAT_OK)
            code = report_failure(job->input.path, &error);
    }
    bat_surface_model_free(model);
    free(given);
    return code;
}

static int draw(const surface_job *job, const bat_cloud *cloud, const bat_surface_result *result)
{
    bat_error error;
    char title[160];
    const bat_surface_fit_round *last = &result->report.rounds[result->report.count - 1];
    (void)snprintf(title, sizeof title, "%s parameters, %zu functions: mean squared distance %.3g",
                   bat_surface_parameters_name(result->chosen), last->functions, last->mean_squared);
    bat_surface_picture_row panel = {.title = title,
                                     .cloud = cloud,
                                     .surface = &result->surface,
                                     .distances = result->report.distances,
                                     .parameters = result->parameters};
    return bat_surface_picture_write(job->picture, &panel, 1, NULL, &error) == BAT_OK ? EXIT_DONE
                                                                                      : report_failure(job->picture, &error);
}

static int write_files(const surface_job *job, const bat_cloud *cloud, const bat_surface_result *result)
{
    bat_error error;
    bat_surface_write_options write = job->write;
    write.points = cloud->points;
    write.errors = result->report.distances;
    write.point_count = cloud->count;
    int code = job->picture != NULL ? draw(job, cloud, result) : EXIT_DONE;
    if (code == EXIT_DONE && job->parameters != NULL &&
        bat_cloud_parameters_write(job->parameters, cloud, result->parameters, &error) != BAT_OK)
        code = report_failure(job->parameters, &error);
    if (code == EXIT_DONE && job->output != NULL &&
        bat_surface_write(job->output, &result->surface, &write, &error) != BAT_OK)
        code = report_failure(job->output, &error);
    return code;
}

static int fit(const surface_job *job)
{
    bat_cloud cloud;
    bat_surface_result result = {0};
    int code = surface_input_read(&job->input, &cloud);
    if (code != EXIT_DONE)
        return code;
    code = reconstruct(job, &cloud, &result);
    if (code == EXIT_DONE)
        code = write_files(job, &cloud, &result);
    surface_findings findings = {job->input.path, &cloud, &job->options, &result};
    if (code == EXIT_DONE && job->json)
        code = report_json(surface_report_json(&findings));
    else if (code == EXIT_DONE && !job->quiet)
        surface_report_print(&findings);
    bat_surface_result_free(&result);
    bat_cloud_free(&cloud);
    return code;
}

// A conversion

/// The name of an option that has no part in a conversion; null when none is given.
static const char *find_fit_option(const arguments *given)
{
    static const char *const CONVERTS[] = {"output", "to", "samples", "picture", "json", "quiet", NULL};
    for (size_t i = 0; OPTIONS[i].name != NULL; i++)
    {
        size_t k = 0;
        while (CONVERTS[k] != NULL && strcmp(CONVERTS[k], OPTIONS[i].name) != 0)
            k++;
        if (CONVERTS[k] == NULL && argument(given, OPTIONS[i].name) != NULL)
            return OPTIONS[i].name;
    }
    return NULL;
}

static int write_converted(const surface_job *job, const bat_spline_surface *surface)
{
    bat_error error;
    bat_surface_picture_row panel = {.title = job->input.path, .surface = surface};
    if (job->picture != NULL && bat_surface_picture_write(job->picture, &panel, 1, NULL, &error) != BAT_OK)
        return report_failure(job->picture, &error);
    if (job->output != NULL && bat_surface_write(job->output, surface, &job->write, &error) != BAT_OK)
        return report_failure(job->output, &error);
    return EXIT_DONE;
}

static int convert(const surface_job *job)
{
    bat_error error;
    bat_spline_surface surface;
    if (bat_surface_read(job->input.path, &surface, &error) != BAT_OK)
        return report_failure(job->input.path, &error);
    int code = write_converted(job, &surface);
    bat_hierarchical_options space = bat_hierarchical_space_options(surface.space);
    size_t functions = bat_hierarchical_space_functions(surface.space);
    size_t levels = bat_hierarchical_space_levels(surface.space);
    if (code == EXIT_DONE && job->json)
        code = report_json(json_pack("{s:[ii], s:I, s:I, s:I}", "degree", space.degree[0], space.degree[1], "functions",
                                     (json_int_t)functions, "levels", (json_int_t)levels, "dimension",
                                     (json_int_t)surface.dimension));
    else if (code == EXIT_DONE && !job->quiet)
        (void)printf("%s: bidegree (%d, %d), %zu functions on %zu levels\n", job->input.path, space.degree[0],
                     space.degree[1], functions, levels);
    bat_spline_surface_free(&surface);
    return code;
}

int verb_surface(int argc, char **argv)
{
    arguments given;
    int code;
    surface_job job;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!read_job(&given, &job))
        return EXIT_BAD_USAGE;
    if (!surface_input_is_surface(job.input.path))
        return fit(&job);
    const char *option = find_fit_option(&given);
    if (option != NULL)
        return usage_error(&given, "IN is a spline surface already: --%s goes with points", option);
    return convert(&job);
}
