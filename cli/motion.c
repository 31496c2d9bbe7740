#include "curve.h"

#include "report.h"
#include "verbs.h"

#include <string.h>

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the motion to OUT (- for standard output)"},
    {"rate", 0, "R", "R points a unit of time, in place of --levels"},
    {"levels", 0, "K", "how often to refine; every level doubles the number of intervals; default 5"},
    {"scheme", 0, "NAME", "a scheme for points with tangents, see `batten list schemes`; default hermite"},
    {"velocities", 0, NULL, "write velocities even if IN has none"},
    {"tangents", 0, "ORDER", "order of the tangents estimated where IN has none, 2 (default) or 4"},
    {"space", 0, "NAME",
     "plane, euclidean, sphere, disk, rotation, rigid, spd or hyperbolic, see `batten list spaces`; default: by the file"},
    {"translation-weight", 0, "W", "rigid: how many radians a unit of length counts as much as; default 1"},
    {"closed", 0, NULL, "take every motion as closed"},
    {"open", 0, NULL, "take every motion as open"},
    {"project", 0, NULL, "move points that are off their space onto it"},
    {"picture", 0, "FILE", "draw to FILE: .svg, .png or .pdf"},
    {"truth", 0, "FILE", "curves to compare with and to draw, as many as given"},
    {"panel", 0, "K,K,…", "draw these levels side by side"},
    {"projection", 0, "NAME", "draw the sphere as globe, map, local or both; default: auto, by what the curves cover"},
    {"comb", 0, NULL, "draw the curvature comb"},
    {"axes", 0, NULL, "draw axes with numbers (flat spaces)"},
    {"title", 0, "TEXT", "write a title above the picture"},
    {"from", 0, "FORMAT", "csv, geojson, obj or tum; default: by the file's ending"},
    {"to", 0, "FORMAT", "the same for OUT"},
    {"precision", 0, "N", "decimals of degrees in GeoJSON; default 10"},
    {"threads", 0, "N", "default: all"},
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const file_option FILES[] = {{"output", FILE_WRITTEN}, {"picture", FILE_DRAWN}, {"truth", FILE_READ}, {NULL, 0}};

static const verb_spec SPEC = {
    .usage = "batten motion IN -o OUT [--rate R|--levels K] [--scheme NAME] [--picture FILE] [options]",
    .summary =
        "Make a smooth motion through the keyframes of a file (CSV, TUM; - for standard input): points, rotations, poses "
        "or\n"
        "tensors, with times and velocities where the file has them. docs/algorithms/hermite-schemes.md explains the "
        "schemes and "
        "docs/formats.md\n"
        "the columns. Without -o, --picture and --json the result goes to standard output in the format of the input.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
    .reads_files = true,
    .files = FILES,
};

/// Options of `batten curve` that only motions take, and those that they do not take.
static const char *const MOTION_OPTIONS[] = {"rate", "velocities", "tangents"};
static const char *const CURVE_OPTIONS[] = {"fairness",     "model",     "snap",        "ends",
                                            "best-tension", "tolerance", "max-segment", "corner-angle"};

/// The first of `count` options that was given, or null.
static const char *first_given(const arguments *given, const char *const *options, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (argument(given, options[i]) != NULL)
            return options[i];
    return NULL;
}

static bool is_hermite(const char *scheme)
{
    static const char family[] = "hermite";
    size_t length = sizeof family - 1;
    return strncmp(scheme, family, length) == 0 && strchr(":-", scheme[length]) != NULL;
}

static bool read_numbers(const arguments *given, curve_job *job)
{
    bat_motion_options *motion = &job->motion;
    long order;
    bat_error error;
    if (!argument_number(given, "rate", motion->rate, &motion->rate) ||
        !argument_whole(given, "tangents", 2, 4, (long)motion->tangent_order, &order) ||
        !argument_number(given, "translation-weight", 0, &job->read.translation_weight))
        return false;
    motion->tangent_order = (size_t)order;
    motion->velocities = argument_flag(given, "velocities");
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

static bool check_options(const arguments *given, const curve_job *job)
{
    const char *for_motions = first_given(given, MOTION_OPTIONS, sizeof MOTION_OPTIONS / sizeof *MOTION_OPTIONS);
    const char *for_curves = first_given(given, CURVE_OPTIONS, sizeof CURVE_OPTIONS / sizeof *CURVE_OPTIONS);
    bool sampled = job->motion.rate > 0;
    if (!job->is_motion && for_motions != NULL)
        (void)usage_error(given, "--%s goes with --scheme hermite, not '%s'", for_motions, job->scheme);
    else if (job->is_motion && for_curves != NULL)
        (void)usage_error(given, "--%s does not go with --scheme hermite", for_curves);
    else if (sampled && (argument(given, "levels") != NULL || argument(given, "panel") != NULL))
        (void)usage_error(given, "--rate and --levels exclude each other");
    else if (sampled && (job->motion.scheme.kind != BAT_HERMITE_LANE_RIESENFELD || job->motion.scheme.order != 1))
        (void)usage_error(given, "--rate goes with --scheme hermite, not '%s'", job->scheme);
    else
        return true;
    return false;
}

bool motion_read(const arguments *given, curve_job *job)
{
    bat_error error;
    bool forced = job->is_motion;
    job->scheme = argument(given, "scheme");
    job->motion = bat_motion_defaults();
    job->motion.scheme.threads = job->refine.threads;
    if (job->scheme == NULL &&
        (forced || first_given(given, MOTION_OPTIONS, sizeof MOTION_OPTIONS / sizeof *MOTION_OPTIONS) != NULL))
        job->scheme = "hermite";
    job->is_motion = job->scheme != NULL && is_hermite(job->scheme);
    if (forced && !job->is_motion)
    {
        (void)usage_error(given, "'%s' is no scheme for points with tangents; `batten list schemes` names them",
                          job->scheme);
        return false;
    }
    if (job->is_motion && bat_hermite_by_name(job->scheme, &job->motion.scheme, &error) != BAT_OK)
    {
        (void)usage_error(given, "%s", error.text);
        return false;
    }
    if (job->is_motion && !forced)
        job->hint = "is treated as a motion";
    return read_numbers(given, job) && check_options(given, job);
}

int motion_refine(const curve_job *job, const bat_curve_set *keyframes, size_t levels, bat_curve_set *fine)
{
    bat_motion_options how = job->motion;
    bat_error error;
    size_t failed = keyframes->count;
    how.scheme.levels = levels;
    how.scheme.progress = report_progress("refining");
    bat_status status = bat_motion_curves(keyframes, &how, fine, &failed, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : curve_failure(job, keyframes, failed, &error);
}

int verb_motion(int argc, char **argv)
{
    arguments given;
    curve_job job = {.is_motion = true};
    int code;
    return arguments_read(&SPEC, argc, argv, &given, &code) ? curve_run(&given, &job) : code;
}
