#include "verbs.h"

#include "many.h"
#include "outputs.h"
#include "report.h"
#include "surface_options.h"
#include "surface_report.h"
#include "terminal.h"

#include "batten/batten.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_SAMPLES = 1000
};

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the surface to OUT (- for standard output)"},
    {"degree", 0, "P[,Q]", "of the spline in its two directions, 1 to 15; default 3"},
    {"tolerance", 0, "T", "refine where points are farther off than this, in their units"},
    {"functions", 0, "N",
     "the maximum number of functions, which is that of control points; default: as many as bring held-out points nearer"},
    {"share", 0, "S", "stop when this share of the points is within the tolerance; default 1"},
    {"iterations", 0, "N", "the maximum number of refinements; default 30"},
    {"smoothing", 0, "WEIGHT", "of the thin plate; default: found by likelihood, or by --noise"},
    {"noise", 0, "D", "standard deviation of a coordinate, where it is known"},
    {"robust", 0, NULL, "points far off count less"},
    {"corrections", 0, "N", "rounds that move parameters to the nearest place of the surface, after each fit; default 1"},
    {"final-corrections", 0, "N", "the same after the last refinement; default 0"},
    {"parameterization", 0, "NAME",
     "auto (default: what fits best by measure), learned, shape-preserving, stretch-minimizing, inverse-distance, uniform, "
     "mean-value (of a "
     "mesh), or a file with u v of each point of IN"},
    {"model", 0, "FILE", "learned: a network of your own, a safetensors file"},
    {"published", 0, NULL, "classical neighbourhoods as published: they may fail"},
    {"slide-boundary", 0, NULL, "no border curves: corrections move boundary parameters along their sides"},
    {"force", 0, NULL, "write also a surface that the points prove wrong"},
    {"trim", 0, NULL,
     "fit over a rectangle around the points, and cut along their outline, which may be concave, and their holes"},
    {"fill-holes", 0, "D", "with --trim: close holes of at most this diameter"},
    {"keep-folds", 0, NULL, "report folds of the parameters, but do not remove them"},
    {"boundary", 0, "N|FILE", "the first N points are the boundary loop, or FILE's are; default: found, or told in IN"},
    {"corners", 0, "A,B,C,D", "these points of IN, counted from 0, get (0,0), (1,0), (1,1), (0,1); default: found"},
    {"sides", 0, "NAME", "parameters along the sides: chord-length (default), centripetal or uniform"},
    {"strict", 0, NULL, "refuse points that repeat another instead of leaving them out"},
    {"picture", 0, "FILE", "draw cloud, surface, distances and parameters (.png, .svg or .pdf)"},
    {"parameters", 0, "FILE", "write u v of each point, in the order of IN"},
    {"unit", 0, "UNIT", "mm (default), m or inch: what STEP and IGES name as the unit of the coordinates"},
    {"samples", 0, "N", "of each cell and direction, for VTK and OBJ; default: the degree plus 1"},
    {"from", 0, "FORMAT", "xyz, csv, ply, obj, pcd or las; default: by the file's ending, failing that by its content"},
    {"to", 0, "FORMAT", "step, iges, xml (G+Smo), vtk, obj or json; default: by OUT's ending"},
    {"threads", 0, "N", "default: all; the result does not depend on it"},
    MANY_OPTIONS,
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"output", FILE_WRITTEN},
                                    {"picture", FILE_DRAWN},
                                    {"parameters", FILE_WRITTEN},
                                    {"model", FILE_READ},
                                    {"boundary", FILE_READ},
                                    {"parameterization", FILE_READ},
                                    {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten surface IN... [-o OUT] [--tolerance T|--functions N] [--degree P,Q] [--picture FILE] [options]",
    .summary = "Fit an adaptive spline surface to the points of a file (XYZ, CSV, PLY, OBJ, PCD, LAS; - for standard "
               "input): a patch with "
               "one\nboundary, or a mesh of one. A spline surface (.xml, .json) as IN is written in another format.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = SIZE_MAX,
    .reads_files = true,
    .files = FILES,
};

/// The command line.
typedef struct surface_job
{
    const arguments *given;
    const char *input;
    bat_cloud_read_options read;
    size_t corners[4]; ///< points of the input
    bool has_corners;
    outputs files;
    const char *output, *picture, *parameters, *model, *parameter_file; ///< files; may be null
    bat_surface_options options;
    bat_surface_write_options write;
    bool json, quiet;
} surface_job;

/// A whole number of 0 or more; false where the text is anything else.
static bool is_count(const char *text, const char **end, size_t *count)
{
    char *stop;
    if (*text < '0' || *text > '9')
        return false;
    unsigned long long value = strtoull(text, &stop, 10);
    *end = stop;
    *count = (size_t)value;
    return value < LONG_MAX;
}

/// "A,B,C,D"
static bool read_corners(const char *text, size_t corners[4])
{
    for (int k = 0; k < 4; k++)
    {
        if (!is_count(text, &text, &corners[k]) || *text != (k < 3 ? ',' : '\0'))
            return false;
        text++;
    }
    return true;
}

static void read_boundary(const char *text, bat_cloud_read_options *read)
{
    const char *end;
    size_t count;
    if (is_count(text, &end, &count) && *end == '\0')
        read->boundary = count;
    else
        read->boundary_path = text;
}

/// What the command line says about the cloud. False after a message.
static bool read_input(const arguments *given, surface_job *job)
{
    const char *boundary = argument(given, "boundary"), *corners = argument(given, "corners");
    job->has_corners = corners != NULL;
    job->read.strict = argument_flag(given, "strict");
    if (!argument_choice(given, "from", &bat_cloud_format_family, &job->read.format))
        return false;
    if (corners != NULL && !read_corners(corners, job->corners))
    {
        (void)usage_error(given, "--corners takes four numbers of points like 0,33,66,99, not '%s'", corners);
        return false;
    }
    if (boundary != NULL)
        read_boundary(boundary, &job->read);
    if (boundary != NULL && job->read.boundary_path == NULL && job->read.boundary < 4)
    {
        (void)usage_error(given, "--boundary takes a file, or a number of points from 4, not '%s'", boundary);
        return false;
    }
    return true;
}

/// A name, or the file of given parameters, which has a dot or a slash in its name.
static bool read_parameterization(const arguments *given, surface_job *job)
{
    const char *text = argument(given, "parameterization");
    if (text == NULL)
        return true;
    bat_error error;
    const bat_choice *choice;
    if (bat_choice_find(&bat_surface_parameters_family, text, &choice, &error) == BAT_OK)
    {
        job->options.parameters = (bat_surface_parameters)choice->value;
        return true;
    }
    job->options.parameters = BAT_SURFACE_PARAMETERS_GIVEN;
    job->parameter_file = text;
    if (strpbrk(text, "./") != NULL)
        return true;
    (void)usage_error(given, "%s, or a file such as ./%s", error.text, text);
    return false;
}

/// What is wrong with the command line; null for nothing.
static const char *find_fault(const arguments *given, const surface_job *job)
{
    const bat_surface_fit_options *fit = &job->options.fit;
    bool piped = is_standard_output(job->output);
    if (fit->tolerance == 0 && argument(given, "tolerance") != NULL)
        return "--tolerance takes a number above 0";
    if (argument(given, "noise") != NULL && argument(given, "smoothing") != NULL)
        return "--noise and --smoothing exclude each other";
    if (argument(given, "share") != NULL && argument(given, "tolerance") == NULL)
        return "--share needs --tolerance";
    if (job->model != NULL && job->options.parameters > BAT_SURFACE_PARAMETERS_LEARNED)
        return "--model goes with auto and learned parameters";
    if (job->output == NULL && job->picture == NULL && job->parameters == NULL && job->quiet)
        return "there is no output: give -o OUT, --picture FILE or --parameters FILE";
    if (argument(given, "fill-holes") != NULL && !job->options.trim)
        return "--fill-holes goes with --trim";
    if (job->options.trim && job->options.parameters != BAT_SURFACE_PARAMETERS_AUTO)
        return "--trim and --parameterization exclude each other: a trimmed surface has a chart of its own";
    if (job->json && job->quiet)
        return "--json and --quiet exclude each other";
    return job->json && piped ? "--json and -o - both need standard output" : NULL;
}

/// False after a message.
static bool read_job(const arguments *given, surface_job *job)
{
    long samples;
    *job = (surface_job){.given = given,
                         .input = given->positional[0],
                         .output = argument(given, "output"),
                         .picture = argument(given, "picture"),
                         .parameters = argument(given, "parameters"),
                         .model = argument(given, "model"),
                         .options = bat_surface_defaults(),
                         .json = argument_flag(given, "json"),
                         .quiet = argument_flag(given, "quiet")};
    if (!read_input(given, job) || !surface_read_fit(given, &job->options.fit) || !read_parameterization(given, job) ||
        !argument_choice(given, "sides", &bat_cloud_sides_family, &job->options.sides) ||
        !argument_number(given, "fill-holes", 0, &job->options.fill_holes) ||
        !argument_whole(given, "samples", 1, MAX_SAMPLES, 0, &samples))
        return false;
    job->options.published = argument_flag(given, "published");
    job->options.force = argument_flag(given, "force");
    job->options.trim = argument_flag(given, "trim");
    job->options.no_repair = argument_flag(given, "keep-folds");
    job->options.slide_boundary = argument_flag(given, "slide-boundary");
    job->write.samples = (size_t)samples;
    const char *fault = find_fault(given, job);
    if (fault != NULL)
        (void)usage_error(given, "%s", fault);
    job->quiet = job->quiet || is_standard_output(job->output);
    return fault == NULL && argument_choice(given, "unit", &bat_surface_unit_family, &job->write.unit) &&
           argument_choice(given, "to", &bat_surface_format_family, &job->write.format) &&
           argument_ending(given, &bat_surface_format_family, (int)job->write.format);
}

// A fit

/// Returns the program's exit code.
static int read_cloud(const surface_job *job, bat_cloud *cloud)
{
    bat_error error;
    bat_cloud_read_options options = job->read;
    options.corners = job->has_corners ? job->corners : NULL;
    return bat_cloud_read(job->input, &options, cloud, &error) == BAT_OK ? EXIT_DONE
                                                                         : report_bad_input(job->given, job->input, &error);
}

/// Read the network and the parameters that are given, as far as they are. Returns the program's exit code.
static int read_model_and_parameters(const surface_job *job, const bat_cloud *cloud, bat_surface_model **model,
                                     double **given)
{
    bat_error error;
    if (job->model != NULL && bat_surface_model_read(job->model, model, &error) != BAT_OK)
        return report_failure(job->model, &error);
    if (job->parameter_file != NULL && bat_cloud_parameters_read(job->parameter_file, cloud, given, &error) != BAT_OK)
        return report_failure(job->parameter_file, &error);
    return EXIT_DONE;
}

static int reconstruct(const surface_job *job, bat_cloud *cloud, bat_surface_result *result)
{
    bat_error error;
    bat_surface_model *model = NULL;
    double *given = NULL;
    int code = read_model_and_parameters(job, cloud, &model, &given);
    if (code == EXIT_DONE)
    {
        bat_surface_options options = job->options;
        options.model = model;
        options.given = given;
        options.fit.progress = report_progress("fitting");
        bat_status status = bat_surface_reconstruct(cloud, &options, result, &error);
        report_progress_end();
        if (status != BAT_OK)
            code = report_bad_input(job->given, job->input, &error);
    }
    bat_surface_model_free(model);
    free(given);
    return code;
}

static int draw(const surface_job *job, const bat_cloud *cloud, const bat_surface_result *result)
{
    bat_error error;
    char title[240];
    const bat_surface_fit_round *last = &result->report.rounds[result->report.count - 1];
    (void)snprintf(title, sizeof title, "%s parameters, %zu functions: mean squared distance %.3g; verdict: %s",
                   bat_choice_name(&bat_surface_parameters_family, (int)result->chosen), last->functions, last->mean_squared,
                   surface_report_verdict(&result->verdict));
    bat_surface_picture_row panel = {.title = title,
                                     .cloud = cloud,
                                     .surface = &result->surface,
                                     .distances = result->report.distances,
                                     .parameters = result->parameters};
    return bat_surface_picture_write(output_path(&job->files, "picture"), &panel, 1, NULL, &error) == BAT_OK
               ? EXIT_DONE
               : report_failure(job->picture, &error);
}

static int write_parameters(const surface_job *job, const bat_cloud *cloud, const bat_surface_result *result)
{
    bat_error error;
    const char *path = output_path(&job->files, "parameters");
    return bat_cloud_parameters_write(path, cloud, result->parameters, &error) == BAT_OK
               ? EXIT_DONE
               : report_failure(job->parameters, &error);
}

/// Write a surface; the distances of a cloud go along where the format holds them. `cloud` may be null.
static int write_surface(const surface_job *job, const bat_cloud *cloud, const bat_surface_result *result, const char *path)
{
    bat_error error;
    bat_surface_write_options write = job->write;
    if (cloud != NULL)
    {
        write.points = cloud->points;
        write.errors = result->report.distances;
        write.point_count = cloud->count;
    }
    if (path == NULL || bat_surface_write(path, &result->surface, &write, &error) == BAT_OK)
        return EXIT_DONE;
    return report_failure(job->output, &error);
}

/// Everything that can fail, the files included.
static int make_fit(const surface_job *job, bat_cloud *cloud, bat_surface_result *result)
{
    int code = read_cloud(job, cloud);
    if (code == EXIT_DONE)
        code = reconstruct(job, cloud, result);
    if (code == EXIT_DONE && job->picture != NULL)
        code = draw(job, cloud, result);
    if (code == EXIT_DONE && job->parameters != NULL)
        code = write_parameters(job, cloud, result);
    return code == EXIT_DONE ? write_surface(job, cloud, result, output_path(&job->files, "output")) : code;
}

static int fit(surface_job *job)
{
    bat_cloud cloud = {0};
    bat_surface_result result = {0};
    int code = outputs_close(&job->files, make_fit(job, &cloud, &result));
    if (code == EXIT_DONE && is_standard_output(job->output))
        code = write_surface(job, &cloud, &result, "-");
    surface_findings findings = {job->input, &cloud, &job->options, &result};
    bool written = code == EXIT_DONE;
    if (code == EXIT_DONE && job->json)
        code = report_json(surface_report_json(&findings));
    else if (code == EXIT_DONE && !job->quiet)
        surface_report_print(&findings);
    if (written && result.below_noise)
    {
        terminal_print(stderr,
                       "batten: %s: the tolerance is below the noise (about %.3g); the best surface so far is written\n",
                       job->input, result.noise);
        code = EXIT_BAD_INPUT;
    }
    bat_surface_result_free(&result);
    bat_cloud_free(&cloud);
    return code;
}

// A conversion

/// The name of an option that has no part in a conversion; null when none is given.
static const char *find_fit_option(const arguments *given)
{
    static const char *const CONVERTS[] = {"output", "to", "unit", "samples", "picture", "json", "quiet", NULL};
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

static int draw_converted(const surface_job *job, const bat_spline_surface *surface)
{
    bat_error error;
    bat_surface_picture_row panel = {.title = job->input, .surface = surface};
    return bat_surface_picture_write(output_path(&job->files, "picture"), &panel, 1, NULL, &error) == BAT_OK
               ? EXIT_DONE
               : report_failure(job->picture, &error);
}

static int report_converted(const surface_job *job, const bat_spline_surface *surface)
{
    bat_hierarchical_options space = bat_hierarchical_space_options(surface->space);
    size_t functions = bat_hierarchical_space_functions(surface->space);
    size_t levels = bat_hierarchical_space_levels(surface->space);
    if (job->json)
        return report_json(json_pack("{s:[ii], s:I, s:I, s:I}", "degree", space.degree[0], space.degree[1], "functions",
                                     (json_int_t)functions, "levels", (json_int_t)levels, "dimension",
                                     (json_int_t)surface->dimension));
    if (!job->quiet)
        terminal_print(stdout, "%s: bidegree (%d, %d), %zu functions on %zu levels\n", job->input, space.degree[0],
                       space.degree[1], functions, levels);
    return EXIT_DONE;
}

static int convert(surface_job *job)
{
    bat_error error;
    bat_surface_result result = {0};
    int code = EXIT_DONE;
    if (bat_surface_read(job->input, &result.surface, &error) != BAT_OK)
        code = report_bad_input(job->given, job->input, &error);
    if (code == EXIT_DONE && job->picture != NULL)
        code = draw_converted(job, &result.surface);
    if (code == EXIT_DONE)
        code = write_surface(job, NULL, &result, output_path(&job->files, "output"));
    code = outputs_close(&job->files, code);
    if (code == EXIT_DONE && is_standard_output(job->output))
        code = write_surface(job, NULL, &result, "-");
    if (code == EXIT_DONE)
        code = report_converted(job, &result.surface);
    bat_spline_surface_free(&result.surface);
    return code;
}

/// Whether a file holds a spline surface, by its name: there is nothing to fit then.
static bool is_surface(const char *path)
{
    const bat_choice *row;
    (void)bat_choice_of_path(&bat_surface_format_family, path, true, &row, NULL);
    bat_surface_format format = row != NULL ? (bat_surface_format)row->value : BAT_SURFACE_FORMAT_AUTO;
    return format == BAT_SURFACE_FORMAT_XML || format == BAT_SURFACE_FORMAT_JSON || format == BAT_SURFACE_FORMAT_STEP ||
           format == BAT_SURFACE_FORMAT_IGES;
}

static int run(const arguments *given)
{
    int code;
    surface_job job;
    if (!read_job(given, &job))
        return EXIT_BAD_USAGE;
    bool converts = is_surface(job.input);
    const char *option = converts ? find_fit_option(given) : NULL;
    if (option != NULL)
        return usage_error(given, "IN is a spline surface already: --%s goes with points", option);
    code = outputs_open(given, &job.files);
    if (code != EXIT_DONE)
        return code;
    return converts ? convert(&job) : fit(&job);
}

int verb_surface(int argc, char **argv)
{
    return many_run(&SPEC, &bat_surface_format_family, run, argc, argv);
}
