#include "curve.h"

#include "many.h"
#include "report.h"
#include "verbs.h"

#include "batten/curve_picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the motion to OUT (- for standard output)"},
    {"rate", 0, "R", "R points a unit of time, in place of --levels"},
    {"times", 0, "FILE", "the points at these increasing times, a number a line, in place of --levels"},
    {"levels", 0, "K", "spline: 2^K parts of each interval; other schemes: how often to refine; default 5"},
    {"scheme", 0, "NAME",
     "spline, in time (default where IN has times), or a scheme for points with tangents, see `batten list schemes`"},
    {"velocities", 0, NULL, "write velocities even if IN has none"},
    {"tangents", 0, "HOW",
     "how velocities are found where IN has none: resting (default), smooth or limited, see docs/motion.md, or "
     "estimates of order 2 or 4"},
    {"ends", 0, "RULE", "spline: auto (default), not-a-knot, natural or clamped, which is at rest"},
    {"sigma", 0, "S[,T]",
     "spline: smooth keyframes with noise S, the root mean square distance; for poses S in units of length and T in "
     "radians"},
    {"outliers", 0, "RULE", "with --sigma: kept (default), huber, which count less, or tukey, which do not count"},
    {"extrapolate", 0, NULL, "spline: go on before the first and after the last keyframe, with constant velocity"},
    {"space", 0, "NAME",
     "plane, euclidean, sphere, disk, rotation, rigid, spd or hyperbolic, see `batten list spaces`; default: by the file"},
    {"columns", 0, "LIST", "CSV: the columns of the coordinates, names or numbers from 1, as x,y; default: by names"},
    {"group", 0, "COLUMN", "CSV: rows with one value in this column make one curve; default: blank lines separate curves"},
    {"euler", 0, "ORDER", "CSV: the order and unit of roll, pitch and yaw, as zyx,degrees or xyz,radians"},
    {"key-times", 0, "FILE", "KITTI: the times of the poses, a number a line; default: 0, 1, 2, ..."},
    {"translation-weight", 0, "W", "rigid: how many radians a unit of length counts as much as; default 1"},
    {"closed", 0, NULL, "take every motion as closed"},
    {"open", 0, NULL, "take every motion as open"},
    {"project", 0, NULL, "move points that are off their space onto it"},
    {"picture", 0, "FILE",
     "draw to FILE: .svg, .png or .pdf; of a motion in time its path or poses, and speeds over time, but its shape with "
     "--truth, --panel, --projection, --comb and --axes"},
    {"poses", 0, "N", "frames or poses in the picture; default: by the motion"},
    {"units", 0, "L,T", "units of length and time in the picture, as m,s; default: by the file"},
    {"truth", 0, "FILE", "curves to compare with and to draw, as many as given"},
    {"panel", 0, "K,K,…", "draw these levels side by side"},
    {"projection", 0, "NAME", "draw the sphere as globe, map, local or both; default: auto, by what the curves cover"},
    {"comb", 0, NULL, "draw the curvature comb"},
    {"axes", 0, NULL, "draw axes with numbers (flat spaces)"},
    {"title", 0, "TEXT", "write a title above the picture"},
    {"from", 0, "FORMAT", "csv, geojson, obj, tum, euroc or kitti; default: by the file's ending and content"},
    {"to", 0, "FORMAT", "the same for OUT"},
    {"precision", 0, "N", "decimals of degrees in GeoJSON; default 10"},
    {"threads", 0, "N", "default: all"},
    MANY_OPTIONS,
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"output", FILE_WRITTEN}, {"picture", FILE_DRAWN},  {"truth", FILE_READ},
                                    {"times", FILE_READ},     {"key-times", FILE_READ}, {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten motion IN... -o OUT [--rate R|--times FILE|--levels K] [--scheme NAME] [--picture FILE] [options]",
    .summary =
        "Make a smooth motion through the keyframes of a file (CSV, TUM; - for standard input): points, rotations, poses "
        "or\n"
        "tensors, with times and velocities where the file has them. docs/motion.md explains the schemes and "
        "docs/formats.md\n"
        "the columns. Without -o, --picture and --json the result goes to standard output in the format of the input.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = SIZE_MAX,
    .reads_files = true,
    .files = FILES,
};

/// Options of `batten curve` that only motions take, and those that they do not take.
static const char *const MOTION_OPTIONS[] = {"rate", "times", "velocities", "tangents"};
static const char *const CURVE_OPTIONS[] = {"fairness",  "model",    "snap",        "best-tension",
                                            "tolerance", "max-edge", "corner-angle"};

/// The first of `count` options that was given, or null.
static const char *first_given(const arguments *given, const char *const *options, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (argument(given, options[i]) != NULL)
            return options[i];
    return NULL;
}

static bool is_motion_scheme(const char *scheme)
{
    static const char *const families[] = {"hermite", "spline"};
    for (size_t i = 0; i < sizeof families / sizeof *families; i++)
    {
        size_t length = strlen(families[i]);
        if (strncmp(scheme, families[i], length) == 0 && strchr(":-", scheme[length]) != NULL)
            return true;
    }
    return false;
}

/// --tangents: a shape of splines, or the order of estimates.
static bool read_tangents(const arguments *given, curve_job *job)
{
    const char *how = argument(given, "tangents");
    bat_motion_options *motion = &job->motion;
    const bat_choice *shape;
    if (how == NULL)
        return true;
    if (bat_choice_find(&bat_motion_shape_family, how, &shape, NULL) == BAT_OK)
    {
        motion->spline.shape = (bat_motion_shape)shape->value;
        return true;
    }
    if (strcmp(how, "2") != 0 && strcmp(how, "4") != 0)
    {
        (void)usage_error(given, "--tangents takes resting, smooth, limited, 2 or 4, not '%s'", how);
        return false;
    }
    motion->tangent_order = (size_t)(how[0] - '0');
    return true;
}

/// --sigma and --outliers.
static bool read_sigma(const arguments *given, curve_job *job)
{
    const char *text = argument(given, "sigma");
    bat_motion_spline_options *spline = &job->motion.spline;
    if (text != NULL)
    {
        char *end;
        spline->sigma = strtod(text, &end);
        bool good = end != text && spline->sigma >= 0 && isfinite(spline->sigma);
        if (good && *end == ',')
        {
            const char *second = end + 1;
            spline->angle_sigma = strtod(second, &end);
            good = end != second && spline->angle_sigma >= 0 && isfinite(spline->angle_sigma);
        }
        if (!good || *end != '\0')
        {
            (void)usage_error(given, "--sigma takes a number, or two as in 0.01,0.002, not '%s'", text);
            return false;
        }
    }
    return argument_choice(given, "outliers", &bat_motion_outliers_family, &spline->outliers);
}

/// --poses and --units.
static bool read_drawing(const arguments *given, curve_job *job)
{
    const char *units = argument(given, "units"), *comma = units != NULL ? strchr(units, ',') : NULL;
    long poses;
    if (!argument_whole(given, "poses", 1, 1000, 1, &poses))
        return false;
    if (units == NULL)
        return true;
    if (comma == NULL || strlen(comma + 1) >= sizeof job->units[1] || comma - units >= (ptrdiff_t)sizeof job->units[0])
    {
        (void)usage_error(given, "--units takes a unit of length and one of time, as in m,s, not '%s'", units);
        return false;
    }
    (void)snprintf(job->units[0], sizeof job->units[0], "%.*s", (int)(comma - units), units);
    (void)snprintf(job->units[1], sizeof job->units[1], "%s", comma + 1);
    return true;
}

static bool read_numbers(const arguments *given, curve_job *job)
{
    bat_motion_options *motion = &job->motion;
    bat_error error;
    if (!argument_number(given, "rate", motion->rate, &motion->rate) || !read_tangents(given, job) ||
        (job->is_verb && (!read_sigma(given, job) || !read_drawing(given, job))) ||
        !argument_number(given, "translation-weight", 0, &job->read.translation_weight))
        return false;
    motion->velocities = argument_flag(given, "velocities");
    motion->spline.extrapolate = job->is_verb && argument_flag(given, "extrapolate");
    job->times_file = argument(given, "times");
    if (job->is_verb && !argument_choice(given, "ends", &bat_motion_ends_family, &motion->spline.ends))
        return false;
    if (argument(given, "rate") != NULL && !(motion->rate > 0))
        (void)usage_error(given, "--rate takes a positive number");
    else if (bat_motion_options_check(motion, &error) != BAT_OK)
        (void)usage_error(given, "%s", error.text);
    else if (argument(given, "translation-weight") != NULL && !(job->read.translation_weight > 0))
        (void)usage_error(given, "--translation-weight takes a positive number");
    else
        return true;
    return false;
}

/// Options that only splines have, or null.
static const char *first_of_splines(const arguments *given, const curve_job *job)
{
    static const char *const options[] = {"times", "ends", "extrapolate", "sigma", "outliers"};
    const char *how = argument(given, "tangents");
    if (how != NULL && job->motion.tangent_order == 0)
        return "tangents";
    return first_given(given, options, job->is_verb ? sizeof options / sizeof *options : 1);
}

static bool check_options(const arguments *given, const curve_job *job)
{
    const char *for_motions = first_given(given, MOTION_OPTIONS, sizeof MOTION_OPTIONS / sizeof *MOTION_OPTIONS);
    const char *for_curves = first_given(given, CURVE_OPTIONS, sizeof CURVE_OPTIONS / sizeof *CURVE_OPTIONS);
    const char *scheme = job->scheme != NULL ? job->scheme : "spline", *for_splines = first_of_splines(given, job);
    bool sampled = job->motion.rate > 0 || job->times_file != NULL;
    if (for_curves == NULL && !job->is_verb && argument(given, "ends") != NULL)
        for_curves = "ends";
    if (!job->is_motion && for_motions != NULL)
        (void)usage_error(given, "--%s goes with --scheme spline or hermite, not '%s'", for_motions, job->scheme);
    else if (job->is_motion && for_curves != NULL)
        (void)usage_error(given, "--%s does not go with --scheme %s", for_curves, scheme);
    else if (job->motion.rate > 0 && job->times_file != NULL)
        (void)usage_error(given, "--rate and --times exclude each other");
    else if (sampled && (argument(given, "levels") != NULL || argument(given, "panel") != NULL))
        (void)usage_error(given, "--%s and --levels exclude each other", job->motion.rate > 0 ? "rate" : "times");
    else if (job->motion.method == BAT_MOTION_HERMITE && for_splines != NULL)
        (void)usage_error(given, "--%s%s goes with --scheme spline, not '%s'", for_splines,
                          strcmp(for_splines, "tangents") == 0 ? " by name" : "", scheme);
    else if (job->motion.rate > 0 && job->motion.method == BAT_MOTION_HERMITE &&
             (job->motion.scheme.kind != BAT_HERMITE_LANE_RIESENFELD || job->motion.scheme.order != 1))
        (void)usage_error(given, "--rate goes with --scheme spline or hermite, not '%s'", scheme);
    else
        return true;
    return false;
}

bool motion_read(const arguments *given, curve_job *job)
{
    bat_error error;
    job->is_verb = job->read.dates = job->is_motion;
    job->scheme = argument(given, "scheme");
    job->motion = bat_motion_defaults();
    job->motion.scheme.threads = job->motion.spline.threads = job->refine.threads;
    if (job->scheme != NULL)
        job->is_motion = is_motion_scheme(job->scheme);
    else if (first_given(given, MOTION_OPTIONS, sizeof MOTION_OPTIONS / sizeof *MOTION_OPTIONS) != NULL)
        job->is_motion = true;
    if (job->is_verb && !job->is_motion)
    {
        (void)usage_error(given, "'%s' is no scheme for points with tangents; `batten list schemes` names them",
                          job->scheme);
        return false;
    }
    if (job->is_motion && job->scheme != NULL && bat_motion_scheme_by_name(job->scheme, &job->motion, &error) != BAT_OK)
    {
        (void)usage_error(given, "%s", error.text);
        return false;
    }
    if (job->is_motion && !job->is_verb)
        job->hint = "is treated as a motion";
    return read_numbers(given, job) && check_options(given, job);
}

const char *motion_scheme(const curve_job *job, const bat_curve_set *keyframes)
{
    bat_motion_options options = job->motion;
    double time = 0;
    if (job->times_file != NULL)
    {
        // They are read later.
        options.times = &time;
        options.time_count = 1;
    }
    return bat_motion_method_for(keyframes, &options) == BAT_MOTION_SPLINE ? "spline" : "hermite";
}

int motion_read_times(curve_job *job, const bat_curve_set *keyframes)
{
    bat_error error;
    size_t count;
    if (bat_motion_times_read_since(job->times_file, bat_curve_set_time_origin(keyframes), &job->times, &count, &error) !=
        BAT_OK)
        return report_bad_input(job->given, job->times_file, &error);
    job->motion.times = job->times;
    job->motion.time_count = count;
    return EXIT_DONE;
}

int motion_refine(const curve_job *job, const bat_curve_set *keyframes, size_t levels, bat_curve_set *fine)
{
    bat_motion_options how = job->motion;
    bat_error error;
    size_t failed = keyframes->count;
    const char *sigma = job->is_verb ? argument(job->given, "sigma") : NULL;
    if (sigma != NULL && strchr(sigma, ',') == NULL && strcmp(keyframes->space->name, "rigid") == 0)
    {
        error = (bat_error){.text = "--sigma takes two numbers for poses, as in 0.01,0.002: lengths and radians"};
        return report_failure(job->input, &error);
    }
    how.scheme.levels = levels;
    how.report = job->moved;
    how.scheme.progress = report_progress("refining");
    bat_status status = bat_motion_curves(keyframes, &how, fine, &failed, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : curve_failure(job, keyframes, failed, &error);
}

bool motion_is_drawn(const curve_job *job)
{
    static const char *const shapes[] = {"truth", "panel", "projection", "comb", "axes"};
    return job->is_motion && job->scheme != NULL && strcmp(job->scheme, "spline") == 0 &&
           first_given(job->given, shapes, sizeof shapes / sizeof *shapes) == NULL;
}

int motion_draw(const curve_job *job, const bat_curve_set *keyframes)
{
    bat_error error;
    bat_motion_options how = job->motion;
    bat_motion_picture_options options = bat_motion_picture_defaults();
    const char *poses = job->is_verb ? argument(job->given, "poses") : NULL;
    how.method = BAT_MOTION_SPLINE;
    options.title = job->draw.title;
    options.poses = poses != NULL ? (size_t)strtoul(poses, NULL, 10) : 0;
    if (job->units[0][0] != '\0' || job->units[1][0] != '\0')
    {
        options.length_unit = job->units[0];
        options.time_unit = job->units[1];
    }
    if (bat_motion_picture_write(output_path(&job->files, "picture"), keyframes, &how, &options, &error) == BAT_OK)
        return EXIT_DONE;
    return report_failure(job->picture, &error);
}

static int run(const arguments *given)
{
    curve_job job = {.is_motion = true};
    return curve_run(given, &job);
}

int verb_motion(int argc, char **argv)
{
    return many_run(&SPEC, &bat_curve_format_family, run, argc, argv);
}
