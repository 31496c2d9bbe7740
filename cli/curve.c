#include "curve.h"

#include "many.h"
#include "report.h"
#include "terminal.h"
#include "verbs.h"

#include "batten/research/curve_study.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    /// Of degrees in GeoJSON.
    MAX_DECIMALS = 12,
};

/// The scheme whose angles a network gives.
static const char LEARNED[] = "learned";

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the refined curves to OUT (- for standard output)"},
    {"scheme", 0, "NAME",
     "how to refine, see `batten list schemes`; default: learned on the plane, sphere and disk, in R^n four-point; for "
     "times of rotations, motions and tensors spline, for velocities alone hermite, else log-exp-4"},
    {"fairness", 0, "F", "learned: from 0, nearest to the data, to 1, smoothest; default 0.5"},
    {"model", 0, "FILE", "learned: a trained network of your own, a safetensors file"},
    {"levels", 0, "K",
     "how often; every level doubles the number of edges; default 5. With a stop: the most levels of an edge; default 20"},
    {"max-edge", 0, "L",
     "a stop, edge by edge: the fewest levels for which no piece is longer than L (metres on the sphere, the Earth's)"},
    {"tolerance", 0, "E",
     "a stop, edge by edge: the fewest levels for which the limit curve is within E of the pieces (metres on the sphere)"},
    {"corner-angle", 0, "A",
     "keep vertices with an exterior angle above A degrees as corners, and edges between corners straight; a CSV column "
     "'corner' (0 or 1) names corners, too"},
    {"rate", 0, "R", "of motions, see `batten motion --help`"},
    {"times", 0, "FILE", "of motions"},
    {"velocities", 0, NULL, "of motions"},
    {"tangents", 0, "HOW", "of motions"},
    {"space", 0, "NAME",
     "plane, euclidean, sphere, disk, rotation, rigid, spd or hyperbolic, see `batten list spaces`; default: what the file "
     "implies"},
    {"columns", 0, "LIST",
     "CSV: the columns of the coordinates, names or numbers from 1, as x,y or lon,lat; default: by names"},
    {"group", 0, "COLUMN", "CSV: rows with one value in this column make one curve; default: blank lines separate curves"},
    {"on", 0, "sphere", "refine projected coordinates on the sphere, and write them in their own system"},
    {"layer", 0, "NAME", "the layer of a GeoPackage or another file with several"},
    {"euler", 0, "ORDER", "CSV: the order and unit of roll, pitch and yaw, as zyx,degrees or xyz,radians"},
    {"key-times", 0, "FILE", "KITTI: the times of the poses, a number a line; default: 0, 1, 2, ..."},
    {"translation-weight", 0, "W", "rigid: how many radians a unit of length counts as much as; default 1"},
    {"closed", 0, NULL, "take every curve as closed"},
    {"open", 0, NULL, "take every curve as open"},
    {"ends", 0, "RULE", "how open curves end: reflect (default), extrapolate, free"},
    {"simple", 0, "WHICH",
     "which curves may not cross themselves: rings (default), always (open curves, too) or never (plane, sphere, disk)"},
    {"topology", 0, "HOW",
     "shared: borders that curves share stay shared, and nothing crosses; separate: every curve by itself, and GeoJSON "
     "sequences of any size go through memory part by part; default: features, which is shared where IN has features"},
    {"snap-tolerance", 0, "D", "join points of a map nearer than D to each other (metres on the sphere)"},
    {"keep-area", 0, NULL, "keep the areas of rings"},
    {"snap", 0, NULL, "move the points of a linear scheme onto its limit curve"},
    {"strict", 0, NULL, "refuse repeated points instead of dropping them"},
    {"project", 0, NULL, "move points that are off their space onto it"},
    {"picture", 0, "FILE", "draw to FILE: .svg, .png or .pdf"},
    {"truth", 0, "FILE", "curves to compare with and to draw, as many as given"},
    {"best-tension", 0, NULL, "angle-based: search the tension that brings the result nearest to the truth"},
    {"panel", 0, "K,K,…", "draw these levels side by side"},
    {"projection", 0, "NAME", "draw the sphere as globe, map, local or both; default: auto, by what the curves cover"},
    {"comb", 0, NULL, "draw the curvature comb"},
    {"axes", 0, NULL, "draw axes with numbers (flat spaces)"},
    {"title", 0, "TEXT", "write a title above the picture"},
    {"from", 0, "FORMAT",
     "csv, geojson, obj, tum or another of `batten list formats`; default: by the file's ending and content"},
    {"to", 0, "FORMAT", "the same for OUT"},
    {"crs", 0, "NAME", "the coordinate reference system of plane coordinates in GeoJSON, as EPSG:25833"},
    {"precision", 0, "N", "decimals of degrees in GeoJSON; default 10"},
    {"threads", 0, "N", "default: all"},
    MANY_OPTIONS,
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"output", FILE_WRITTEN},
                                    {"picture", FILE_DRAWN},
                                    {"truth", FILE_READ},
                                    {"model", FILE_READ},
                                    {"times", FILE_READ},
                                    {"key-times", FILE_READ},
                                    {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten curve IN... [-o OUT] [--space NAME] [--scheme NAME] [--levels K] [--closed|--open] [--picture FILE] "
             "[options]",
    .summary =
        "Refine the curves of a file (CSV, GeoJSON, OBJ; - for standard input). Without -o, --picture and --json the\n"
        "result goes to standard output in the format of the input.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = SIZE_MAX,
    .reads_files = true,
    .files = FILES,
};

static bool read_panels(const arguments *given, curve_job *job)
{
    const char *at = argument(given, "panel");
    while (at != NULL && *at != '\0')
    {
        char *end;
        errno = 0;
        long level = strtol(at, &end, 10);
        if (end == at || (*end != '\0' && *end != ',') || errno != 0 || level < 0 || level > CURVE_MAX_LEVELS ||
            job->panel_count == CURVE_MAX_PANELS)
        {
            (void)usage_error(given, "--panel takes up to %d levels from 0 to %d, as in 0,1,2,5", CURVE_MAX_PANELS,
                              CURVE_MAX_LEVELS);
            return false;
        }
        job->panels[job->panel_count++] = (size_t)level;
        at = end + (*end == ',');
    }
    return true;
}

static bool read_choices(const arguments *given, curve_job *job)
{
    bat_error error;
    bool of_motion = job->is_motion; // whose ends motion_read() reads
    if ((!of_motion && !argument_choice(given, "ends", &bat_curve_end_rule_family, &job->refine.ends)) ||
        !argument_choice(given, "projection", &bat_curve_projection_family, &job->draw.projection) ||
        !argument_choice(given, "simple", &bat_curve_simple_family, &job->refine.simple) ||
        !argument_choice(given, "topology", &bat_curve_map_topology_family, &job->map.topology))
        return false;
    job->read.closed = argument_flag(given, "closed") ? 1 : argument_flag(given, "open") ? 0 : -1;
    const bat_choice *format;
    if (!argument_choice(given, "from", &bat_curve_format_family, &job->read.format) ||
        !argument_choice(given, "to", &bat_curve_format_family, &job->write.format))
        return false;
    if (job->output == NULL || job->write.format != BAT_CURVE_FORMAT_AUTO ||
        bat_choice_of_path(&bat_curve_format_family, job->output, true, &format, &error) == BAT_OK)
        return true;
    (void)usage_error(given, "%s", error.text);
    return false;
}

/// Options that would have no effect without another.
static bool check_needs(const arguments *given, const curve_job *job)
{
    bool drawn = job->picture != NULL, written = job->output != NULL, searched = job->best_tension;
    const struct
    {
        const char *option;
        bool met;
        const char *needs;
    } rules[] = {
        {"panel", drawn, "--picture FILE"},
        {"projection", drawn, "--picture FILE"},
        {"comb", drawn, "--picture FILE"},
        {"axes", drawn, "--picture FILE"},
        {"title", drawn, "--picture FILE"},
        {"to", written, "-o OUT"},
        {"precision", written, "-o OUT"},
        {"crs", written, "-o OUT"},
        {"best-tension", job->truth != NULL, "--truth FILE"},
        {"truth", drawn || searched || !job->quiet, "a report (-o FILE without --quiet), --picture or --best-tension"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++)
        if (argument(given, rules[i].option) != NULL && !rules[i].met)
        {
            (void)usage_error(given, "--%s needs %s", rules[i].option, rules[i].needs);
            return false;
        }
    return true;
}

/// Whether a scheme takes its angles from a tension.
static bool has_tension(const bat_curve_scheme *scheme)
{
    return scheme->kind == BAT_CURVE_SCHEME_ANGLE && scheme->rule == NULL;
}

static bool check_exclusions(const arguments *given, const curve_job *job)
{
    if (argument_flag(given, "closed") && argument_flag(given, "open"))
        (void)usage_error(given, "--closed and --open exclude each other");
    else if (job->map.topology == BAT_CURVE_MAP_SEPARATE && (job->map.keep_area || job->map.snap_tolerance > 0))
        (void)usage_error(given, "--topology separate does not go with --keep-area and --snap-tolerance");
    else if (job->read.on_sphere && strcmp(argument(given, "on"), "sphere") != 0)
        (void)usage_error(given, "--on takes sphere, not '%s'", argument(given, "on"));
    else if (job->json && argument_flag(given, "quiet"))
        (void)usage_error(given, "--json and --quiet exclude each other");
    else if (job->json && is_standard_output(job->output))
        (void)usage_error(given, "--json and -o - exclude each other: both print on standard output");
    else if (job->best_tension && job->scheme != NULL && (job->model_file != NULL || !has_tension(&job->refine.scheme)))
        (void)usage_error(given, "--best-tension goes with angle-based schemes, not '%s'", job->scheme);
    else
        return true;
    return false;
}

static bool read_scheme(const arguments *given, curve_job *job)
{
    bat_error error;
    if (job->is_motion)
        return true;
    bool learned = job->scheme != NULL && strcmp(job->scheme, LEARNED) == 0;
    bool chooses_network = job->model_file != NULL || argument(given, "fairness") != NULL;
    if (chooses_network && job->scheme != NULL && !learned)
    {
        (void)usage_error(given, "--%s goes with --scheme learned, not '%s'", job->model_file != NULL ? "model" : "fairness",
                          job->scheme);
        return false;
    }
    if (!argument_number(given, "fairness", 0.5, &job->fairness))
        return false;
    bat_curve_scheme learned_scheme = bat_curve_scheme_learned(job->fairness);
    if (bat_curve_scheme_check(&learned_scheme, &error) != BAT_OK)
    {
        (void)usage_error(given, "%s", error.text);
        return false;
    }
    if (chooses_network || learned)
    {
        job->scheme = LEARNED;
        job->refine.scheme = bat_curve_scheme_learned(job->fairness);
        return true;
    }
    if (job->scheme == NULL || bat_curve_scheme_by_name(job->scheme, &job->refine.scheme, &error) == BAT_OK)
        return true;
    (void)usage_error(given, "%s", error.text);
    return false;
}

static bool read_numbers(const arguments *given, curve_job *job)
{
    long levels, precision;
    int threads;
    if (!argument_whole(given, "levels", 0, CURVE_MAX_LEVELS, (long)job->refine.levels, &levels) ||
        !argument_threads(given, &threads) ||
        !argument_whole(given, "precision", 0, MAX_DECIMALS, job->write.precision, &precision))
        return false;
    job->refine.levels = (size_t)levels;
    job->refine.threads = job->read.threads = job->write.threads = threads;
    job->write.precision = (int)precision;
    return true;
}

/// Read a length above 0.
static bool read_length(const arguments *given, const char *name, double *value)
{
    if (!argument_number(given, name, 0, value))
        return false;
    if (argument(given, name) == NULL || *value > 0)
        return true;
    (void)usage_error(given, "--%s takes a positive number, not '%s'", name, argument(given, name));
    return false;
}

/// Read the corner angle and the stops. With a stop, --levels is the cap.
static bool read_stops(const arguments *given, curve_job *job)
{
    static const double DEGREE = 3.14159265358979323846 / 180, HALF_TURN = 180;
    bat_curve_refine_options *refine = &job->refine;
    double degrees;
    if (!read_length(given, "max-edge", &refine->max_segment) || !read_length(given, "tolerance", &refine->tolerance) ||
        !read_length(given, "corner-angle", &degrees) || !read_length(given, "snap-tolerance", &job->map.snap_tolerance))
        return false;
    refine->corner_angle = degrees * DEGREE;
    bool stops = curve_stops(job);
    if (stops && argument(given, "levels") != NULL)
        refine->max_levels = refine->levels;
    bat_error error;
    if (degrees > HALF_TURN)
        (void)usage_error(given, "--corner-angle takes degrees up to 180, not '%s'", argument(given, "corner-angle"));
    else if (bat_curve_refine_options_check(refine, &error) != BAT_OK)
        (void)usage_error(given, "%s", error.text);
    else if (stops && job->panel_count > 0)
        (void)usage_error(given, "--panel draws levels, and does not go with --max-edge and --tolerance");
    else if ((stops || degrees > 0) && job->best_tension)
        (void)usage_error(given, "--best-tension does not go with --max-edge, --tolerance and --corner-angle");
    else
        return true;
    return false;
}

bool curve_stops(const curve_job *job)
{
    return job->refine.max_segment > 0 || job->refine.tolerance > 0;
}

static bool read_job(const arguments *given, curve_job *job)
{
    bool is_motion = job->is_motion;
    *job = (curve_job){
        .given = given,
        .is_motion = is_motion,
        .input = given->positional[0],
        .output = argument(given, "output"),
        .picture = argument(given, "picture"),
        .truth = argument(given, "truth"),
        .model_file = argument(given, "model"),
        .read = bat_curve_read_defaults(),
        .write = bat_curve_write_defaults(),
        .refine = bat_curve_refine_defaults(),
        .map = bat_curve_map_defaults(),
        .draw = bat_curve_picture_defaults(),
        .best_tension = argument_flag(given, "best-tension"),
        .json = argument_flag(given, "json"),
    };
    job->refine.snap = argument_flag(given, "snap");
    job->map.keep_area = argument_flag(given, "keep-area");
    job->read.space = argument(given, "space");
    job->read.strict = argument_flag(given, "strict");
    job->write.crs = argument(given, "crs");
    job->read.columns = argument(given, "columns");
    job->read.group = argument(given, "group");
    job->read.project = argument_flag(given, "project");
    job->read.layer = argument(given, "layer");
    job->read.on_sphere = argument(given, "on") != NULL;
    job->read.euler = argument(given, "euler");
    job->read.key_times = argument(given, "key-times");
    job->draw.comb = argument_flag(given, "comb");
    job->draw.axes = argument_flag(given, "axes");
    job->draw.title = argument(given, "title");
    if (job->output == NULL && job->picture == NULL && !job->json)
        job->output = "-";
    job->quiet = argument_flag(given, "quiet") || is_standard_output(job->output);
    return read_numbers(given, job) && read_choices(given, job) && read_panels(given, job) && read_stops(given, job) &&
           motion_read(given, job) && read_scheme(given, job) && check_exclusions(given, job) && check_needs(given, job);
}

int curve_failure(const curve_job *job, const bat_curve_set *set, size_t failed, const bat_error *error)
{
    bat_error whole = *error;
    char place[160];
    bool too_few = failed < set->count && strstr(error->text, " points, not ") != NULL;
    if (error->index != BAT_NO_INDEX || too_few)
    {
        if (failed < set->count && whole.line == 0)
            whole.line = bat_curve_set_line(set, failed, too_few ? 0 : error->index);
        bat_curve_set_place(set, failed, error->index, place, sizeof place);
        int length = snprintf(whole.text, sizeof whole.text, "%s%s", place, place[0] != '\0' ? ": " : "");
        (void)snprintf(whole.text + length, sizeof whole.text - (size_t)length, "%.*s", (int)sizeof whole.text - length - 1,
                       error->text);
    }
    if (curve_stops(job) && error->status == BAT_TOO_LARGE && error->index != BAT_NO_INDEX)
    {
        size_t used = strlen(whole.text);
        (void)snprintf(whole.text + used, sizeof whole.text - used, "; --levels allows more");
    }
    bool pair = error->status == BAT_CUT_LOCUS && error->index != BAT_NO_INDEX && error->index > 0 && whole.line > 0;
    if (pair && strstr(error->text, "lines") == NULL)
    {
        size_t used = strlen(whole.text);
        (void)snprintf(whole.text + used, sizeof whole.text - used, " (line %zu)",
                       bat_curve_set_line(set, failed, error->index - 1));
    }
    return report_bad_input(job->given, job->input, &whole);
}

int curve_refine(const curve_job *job, const bat_curve_set *coarse, size_t levels, bat_curve_set *fine,
                 bat_curve_map_report *report)
{
    if (report != NULL)
        *report = (bat_curve_map_report){.map = false};
    if (job->is_motion)
        return motion_refine(job, coarse, levels, fine);
    bat_error error;
    bat_curve_map_options how = job->map;
    how.refine = job->refine;
    how.refine.levels = levels;
    how.refine.progress = report_progress("refining");
    how.decimals = job->write.precision;
    how.report = report;
    size_t failed;
    bat_status status = bat_curve_map_refine(coarse, &how, fine, &failed, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : curve_failure(job, coarse, failed, &error);
}

/// Replace the tension of the scheme by the best for this truth, and its name.
static int choose_tension(curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth)
{
    bat_curve_scheme *scheme = &job->refine.scheme;
    bat_error error = {.text = "--best-tension needs an angle-based scheme, which this space does not have"};
    if (!has_tension(scheme))
        return report_failure(job->input, &error);
    bat_tension_search_options options = bat_tension_search_defaults();
    options.scheme = *scheme;
    options.levels = job->refine.levels;
    options.threads = job->refine.threads;
    options.progress = report_progress("searching");
    bat_status status = bat_tension_search(coarse->curves, truth->curves, coarse->count, &options, &scheme->tension, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(job->input, &error);
    (void)snprintf(job->best_name, sizeof job->best_name, "angle:mu=%.10g%s%s", scheme->tension,
                   scheme->sign == BAT_CURVE_ANGLE_PRINTED ? ",sign=printed" : "", scheme->adaptive ? ",adaptive=1" : "");
    job->scheme = job->best_name;
    return EXIT_DONE;
}

/// The truth, a curve for each given one.
static int read_truth(const curve_job *job, const bat_curve_set *coarse, bat_curve_set *truth)
{
    bat_error error;
    bat_curve_read_options options = job->read;
    options.format = BAT_CURVE_FORMAT_AUTO;
    if (bat_curve_read(job->truth, &options, truth, &error) != BAT_OK)
        return report_bad_input(job->given, job->truth, &error);
    if (truth->count == coarse->count)
        return EXIT_DONE;
    error.line = 0;
    (void)snprintf(error.text, sizeof error.text, "%zu curves cannot be compared with the %zu of %.100s", truth->count,
                   coarse->count, job->input);
    return report_failure(job->truth, &error);
}

static bool load_model(curve_job *job)
{
    bat_error error;
    if (bat_curve_model_read(job->model_file, &job->model, &error) != BAT_OK)
    {
        (void)report_failure(job->model_file, &error);
        return false;
    }
    job->refine.scheme = bat_curve_scheme_of_model(job->model);
    job->refine.scheme.fairness = job->fairness;
    return true;
}

/// The default scheme.
static void choose_scheme(curve_job *job, const bat_curve_set *coarse)
{
    bool plain = !job->refine.snap && job->refine.ends == BAT_CURVE_END_REFLECT && !job->best_tension &&
                 job->refine.simple != BAT_CURVE_SIMPLE_ALWAYS && job->map.topology != BAT_CURVE_MAP_ALWAYS &&
                 !curve_stops(job) && !(job->refine.corner_angle > 0) && coarse->curves[0].corners == NULL;
    if (job->is_motion)
    {
        job->scheme = motion_scheme(job, coarse);
        return;
    }
    if (plain && bat_motion_suits(coarse))
    {
        job->is_motion = true;
        job->hint = bat_motion_has_times(coarse) ? "has times: treated as a motion" : "has velocities: treated as a motion";
        job->scheme = motion_scheme(job, coarse);
        return;
    }
    if (job->refine.scheme.kind == BAT_CURVE_SCHEME_AUTO && coarse->count > 0)
        job->refine.scheme = bat_curve_scheme_for(coarse->curves[0].space, &job->scheme);
    if (job->best_tension && job->scheme != NULL && strcmp(job->scheme, LEARNED) == 0)
    {
        job->scheme = "angle-4";
        (void)bat_curve_scheme_by_name(job->scheme, &job->refine.scheme, NULL);
    }
}

/// Lengths on the sphere are metres on the Earth.
static void convert_lengths(curve_job *job, const bat_space *space)
{
    bool globe = strcmp(space->name, "sphere") == 0 && space->dimension == 2;
    job->unit = globe ? " m" : "";
    job->refine.max_segment /= globe ? BAT_EARTH_RADIUS : 1;
    job->refine.tolerance /= globe ? BAT_EARTH_RADIUS : 1;
    job->map.snap_tolerance /= globe ? BAT_EARTH_RADIUS : 1;
}

/// The curves of a job.
typedef struct curve_sets
{
    bat_curve_set coarse, truth, fine;
} curve_sets;

static int read_sets(curve_job *job, curve_sets *sets)
{
    bat_error error;
    if (job->model_file != NULL && !load_model(job))
        return EXIT_BAD_INPUT;
    if (bat_curve_read(job->input, &job->read, &sets->coarse, &error) != BAT_OK)
        return report_bad_input(job->given, job->input, &error);
    convert_lengths(job, sets->coarse.space);
    if (job->times_file != NULL && motion_read_times(job, &sets->coarse) != EXIT_DONE)
        return EXIT_BAD_INPUT;
    if (job->scheme == NULL)
        choose_scheme(job, &sets->coarse);
    int code = EXIT_DONE;
    if (job->truth != NULL)
        code = read_truth(job, &sets->coarse, &sets->truth);
    if (code == EXIT_DONE && job->best_tension)
        code = choose_tension(job, &sets->coarse, &sets->truth);
    return code;
}

static int write_curves(const curve_job *job, const bat_curve_set *fine, const char *path, curve_findings *findings)
{
    bat_error error;
    bat_curve_write_options how = job->write;
    how.report = &findings->written;
    if (path == NULL || bat_curve_write(path, fine, &how, &error) == BAT_OK)
        return EXIT_DONE;
    return report_bad_input(job->given, job->output, &error);
}

/// Everything that can fail, the files included.
static int make(curve_job *job, curve_sets *sets, curve_findings *findings)
{
    int code = read_sets(job, sets);
    const bat_curve_set *truth = job->truth != NULL ? &sets->truth : NULL;
    if (code == EXIT_DONE)
        code = curve_refine(job, &sets->coarse, job->refine.levels, &sets->fine, &findings->done);
    if (code == EXIT_DONE && !job->quiet)
        code = curve_measure(job, &sets->coarse, truth, &sets->fine, findings);
    if (code == EXIT_DONE)
        code = write_curves(job, &sets->fine, output_path(&job->files, "output"), findings);
    if (code == EXIT_DONE && job->picture != NULL && motion_is_drawn(job))
        code = motion_draw(job, &sets->coarse);
    else if (code == EXIT_DONE && job->picture != NULL)
        code = curve_draw(job, &sets->coarse, truth, &sets->fine, &findings->projection);
    return code;
}

/// Whether the file is a sequence that can go through memory part by part: nothing else needs it as a whole.
static bool is_streamed(const curve_job *job)
{
    const bat_choice *row = NULL;
    (void)bat_choice_of_path(&bat_curve_format_family, job->input, false, &row, NULL);
    bat_curve_format from = job->read.format;
    if (from == BAT_CURVE_FORMAT_AUTO && row != NULL)
        from = (bat_curve_format)row->value;
    return job->map.topology == BAT_CURVE_MAP_SEPARATE && !job->is_motion && job->output != NULL && job->picture == NULL &&
           job->truth == NULL && (from == BAT_CURVE_FORMAT_GEOJSON_LINES || from == BAT_CURVE_FORMAT_GEOJSON_SEQUENCE);
}

/// What a streamed job hands to measure_part().
typedef struct stream_context
{
    const curve_job *job;
    curve_findings *findings;
    int code;
} stream_context;

static bool measure_part(void *context, const bat_curve_set *coarse, const bat_curve_set *fine)
{
    stream_context *stream = context;
    stream->code = curve_measure_part(stream->job, coarse, fine, stream->findings);
    (void)report_progress("refining");
    return stream->code == EXIT_DONE;
}

/// Refine a sequence part by part. `fine` receives what the report tells of a set, without the curves.
static int run_streamed(curve_job *job, bat_space *space, bat_curve_set *fine, curve_findings *findings)
{
    bat_error error;
    *findings = (curve_findings){.curves = 0};
    if (job->model_file != NULL && !load_model(job))
        return EXIT_BAD_INPUT;
    if (bat_space_by_name(job->read.space != NULL ? job->read.space : "sphere", 0, space, &error) != BAT_OK)
        return report_failure(job->input, &error);
    convert_lengths(job, space);
    if (job->scheme == NULL)
        job->refine.scheme = bat_curve_scheme_for(space, &job->scheme);
    stream_context stream = {job, findings, EXIT_DONE};
    bat_curve_refine_file_report report;
    bat_curve_refine_file_options options = {.read = job->read, .refine = job->refine, .write = job->write};
    options.refine.progress = report_progress("refining");
    options.refine.report = &findings->done.curves;
    options.write.report = &findings->written;
    options.visit = job->quiet ? NULL : measure_part;
    options.context = &stream;
    const char *path = output_path(&job->files, "output");
    bat_status status = bat_curve_refine_file(job->input, path != NULL ? path : "-", &options, &report, &error);
    report_progress_end();
    if (stream.code != EXIT_DONE)
        return stream.code;
    if (status == BAT_FILE_ACCESS && strstr(error.text, "write") != NULL)
        return report_failure(job->output, &error);
    if (status != BAT_OK)
        return report_bad_input(job->given, job->input, &error);
    *fine = (bat_curve_set){.space = space, .count = report.curves};
    return EXIT_DONE;
}

/// Run a streamed job, up to its report.
static int run_parts(const arguments *given, curve_job *job)
{
    bat_space space;
    bat_curve_set fine;
    curve_findings findings;
    int code = outputs_close(&job->files, run_streamed(job, &space, &fine, &findings));
    if (code == EXIT_DONE && !argument_flag(given, "quiet"))
        code = curve_report(job, &fine, &findings);
    bat_curve_model_free(job->model);
    return code;
}

int curve_run(const arguments *given, curve_job *job)
{
    curve_sets sets = {.fine = {0}};
    curve_findings findings;
    bat_motion_report moved = {.keys = 0};
    if (!read_job(given, job))
        return EXIT_BAD_USAGE;
    job->moved = &moved;
    int code = outputs_open(given, &job->files);
    if (code != EXIT_DONE)
        return code;
    if (is_streamed(job))
        return run_parts(given, job);
    code = outputs_close(&job->files, make(job, &sets, &findings));
    if (code == EXIT_DONE && job->hint != NULL && !argument_flag(given, "quiet"))
        terminal_print(stderr, "batten: %s %s, see `batten motion --help`\n", job->input, job->hint);
    if (code == EXIT_DONE && is_standard_output(job->output))
        code = write_curves(job, &sets.fine, "-", &findings);
    if (code == EXIT_DONE && !argument_flag(given, "quiet"))
        code = curve_report(job, &sets.fine, &findings);
    bat_curve_set_free(&sets.coarse);
    bat_curve_set_free(&sets.truth);
    bat_curve_set_free(&sets.fine);
    bat_curve_model_free(job->model);
    free(job->times);
    return code;
}

static int run(const arguments *given)
{
    curve_job job = {.is_motion = false};
    return curve_run(given, &job);
}

int verb_curve(int argc, char **argv)
{
    return many_run(&SPEC, &bat_curve_format_family, run, argc, argv);
}
