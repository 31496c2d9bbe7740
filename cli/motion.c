#include "curve.h"

#include "report.h"

#include "batten/curve_picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const option_spec MOTION_OPTIONS[] = {
    {"rate", "R", METHOD, COMMON, "of motions: R points a unit of time, in place of --levels",
     POSITIVE(curve_job, motion.rate)},
    {"times", "FILE", METHOD, COMMON | IS_READ,
     "of motions: the points at these increasing times, a number a line, in place of --levels", TEXT(curve_job, times_file)},
    {"velocities", NULL, METHOD, 0, "of motions: write velocities even if IN has none", FLAG(curve_job, motion.velocities)},
    {"tangents", "HOW", METHOD, 0,
     "of motions: how velocities are found where IN has none: resting (default), smooth or limited, see docs/motion.md, or "
     "estimates of order 2 or 4",
     NO_FIELD},
    END_OF_OPTIONS,
};

const option_spec MOTION_VERB_OPTIONS[] = {
    {"ends", "RULE", METHOD, COMMON, "spline: {}; default auto; clamped ends are at rest",
     CHOICE(curve_job, motion.spline.ends, bat_motion_ends_family)},
    {"sigma", "S[,T]", METHOD, 0,
     "spline: smooth keyframes with noise S, the root mean square distance; for poses S in units of length and T in radians",
     NO_FIELD},
    {"outliers", "RULE", METHOD, 0, "with --sigma: {}; default kept; those of huber count less, those of tukey do not count",
     CHOICE(curve_job, motion.spline.outliers, bat_motion_outliers_family)},
    {"extrapolate", NULL, METHOD, 0, "spline: go on before the first and after the last keyframe, with constant velocity",
     FLAG(curve_job, motion.spline.extrapolate)},
    {"poses", "N", PICTURE, 0, "frames or poses in the picture; default: by the motion", WHOLE(curve_job, poses, 1, 1000)},
    {"units", "L,T", PICTURE, 0, "units of length and time in the picture, as m,s; default: by the file", NO_FIELD},
    END_OF_OPTIONS,
};

/// Options of `batten curve` that only motions take, and those that they do not take.
static const char *const FOR_MOTIONS[] = {"rate", "times", "velocities", "tangents", NULL};
static const char *const FOR_CURVES[] = {"fairness",  "model",    "snap",         "best-tension",
                                         "tolerance", "max-edge", "corner-angle", NULL};

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
    bat_motion_curves_options *motion = &job->motion;
    const bat_choice *shape;
    if (how == NULL)
        return true;
    if (bat_choice_find(&bat_motion_shape_family, how, &shape, NULL) == BAT_OK)
    {
        motion->spline.shape = (bat_motion_shape)shape->value;
        return true;
    }
    if (strcmp(how, "2") != 0 && strcmp(how, "4") != 0)
        return argument_refused(given, "tangents", "resting, smooth, limited, 2 or 4");
    motion->tangent_order = (size_t)(how[0] - '0');
    return true;
}

/// --sigma: one number, or two.
static bool read_sigma(const arguments *given, curve_job *job)
{
    const char *text = argument(given, "sigma");
    bat_motion_spline_options *spline = &job->motion.spline;
    if (text == NULL)
        return true;
    char *end;
    spline->sigma = strtod(text, &end);
    bool good = end != text && spline->sigma >= 0 && isfinite(spline->sigma);
    if (good && *end == ',')
    {
        const char *second = end + 1;
        spline->angle_sigma = strtod(second, &end);
        good = end != second && spline->angle_sigma >= 0 && isfinite(spline->angle_sigma);
    }
    return (good && *end == '\0') || argument_refused(given, "sigma", "a number, or two as in 0.01,0.002");
}

static bool read_units(const arguments *given, curve_job *job)
{
    const char *units = argument(given, "units"), *comma = units != NULL ? strchr(units, ',') : NULL;
    if (units == NULL)
        return true;
    if (comma == NULL || strlen(comma + 1) >= sizeof job->units[1] || comma - units >= (ptrdiff_t)sizeof job->units[0])
        return argument_refused(given, "units", "a unit of length and one of time, as in m,s");
    (void)snprintf(job->units[0], sizeof job->units[0], "%.*s", (int)(comma - units), units);
    (void)snprintf(job->units[1], sizeof job->units[1], "%s", comma + 1);
    return true;
}

/// Options that only splines have, or null.
static const char *first_of_splines(const arguments *given, const curve_job *job)
{
    static const char *const options[] = {"times", "ends", "extrapolate", "sigma", "outliers", NULL}, *const of_curves[] = {
                                                                                                          "times", NULL};
    const char *how = argument(given, "tangents");
    if (how != NULL && job->motion.tangent_order == 0)
        return "tangents";
    return argument_first(given, job->is_verb ? options : of_curves);
}

static bool check_options(const arguments *given, const curve_job *job)
{
    const char *for_motions = argument_first(given, FOR_MOTIONS);
    const char *for_curves = argument_first(given, FOR_CURVES);
    const char *scheme = job->scheme != NULL ? job->scheme : "spline", *for_splines = first_of_splines(given, job);
    const bat_motion_curves_options *motion = &job->motion;
    bool sampled = motion->rate > 0 || job->times_file != NULL, hermite = motion->method == BAT_MOTION_METHOD_HERMITE;
    if (for_curves == NULL && !job->is_verb && argument(given, "ends") != NULL)
        for_curves = "ends";
    if (!job->is_motion && for_motions != NULL)
        return usage_refused(given, "--%s goes with --scheme spline or hermite, not '%s'", for_motions, job->scheme);
    if (job->is_motion && for_curves != NULL)
        return usage_refused(given, "--%s does not go with --scheme %s", for_curves, scheme);
    if (motion->rate > 0 && job->times_file != NULL)
        return usage_refused(given, "--rate and --times exclude each other");
    if (sampled && (argument(given, "levels") != NULL || argument(given, "panel") != NULL))
        return usage_refused(given, "--%s and --levels exclude each other", motion->rate > 0 ? "rate" : "times");
    if (hermite && for_splines != NULL)
        return usage_refused(given, "--%s%s goes with --scheme spline, not '%s'", for_splines,
                             strcmp(for_splines, "tangents") == 0 ? " by name" : "", scheme);
    if (motion->rate > 0 && hermite &&
        (motion->scheme.kind != BAT_HERMITE_KIND_LANE_RIESENFELD || motion->scheme.order != 1))
        return usage_refused(given, "--rate goes with --scheme spline or hermite, not '%s'", scheme);
    return true;
}

bool motion_read(curve_job *job)
{
    bat_error error;
    const arguments *given = job->call.given;
    job->motion.scheme.threads = job->motion.spline.threads = job->refine.threads;
    if (job->scheme != NULL)
        job->is_motion = is_motion_scheme(job->scheme);
    else if (argument_first(given, FOR_MOTIONS) != NULL)
        job->is_motion = true;
    if (job->is_verb && !job->is_motion)
        return usage_refused(given, "'%s' is no scheme for points with tangents; `batten list schemes` names them",
                             job->scheme);
    if (job->is_motion && job->scheme != NULL &&
        !usage_accepts(given, bat_motion_scheme_by_name(job->scheme, &job->motion, &error), &error))
        return false;
    if (job->is_motion && !job->is_verb)
        job->hint = "is treated as a motion";
    return read_tangents(given, job) && read_sigma(given, job) && read_units(given, job) &&
           usage_accepts(given, bat_options_check(&bat_motion_curves_fields, &job->motion, &error), &error) &&
           check_options(given, job);
}

const char *motion_scheme(const curve_job *job)
{
    bat_motion_curves_options options = job->motion;
    double time = 0;
    if (job->times_file != NULL)
    {
        // They are read later.
        options.times = &time;
        options.time_count = 1;
    }
    return bat_motion_method_for(&job->coarse, &options) == BAT_MOTION_METHOD_SPLINE ? "spline" : "hermite";
}

int motion_read_times(curve_job *job)
{
    bat_error error;
    size_t count;
    if (bat_motion_times_read(job->times_file, bat_curve_set_time_origin(&job->coarse), &job->times, &count, &error) !=
        BAT_OK)
        return report_bad_input(job->call.given, job->times_file, &error);
    job->motion.times = job->times;
    job->motion.time_count = count;
    return EXIT_DONE;
}

int motion_refine(curve_job *job, size_t levels, bat_curve_set *fine)
{
    const bat_curve_set *keyframes = &job->coarse;
    bat_motion_curves_options how = job->motion;
    bat_error error;
    size_t failed = keyframes->count;
    const char *sigma = argument(job->call.given, "sigma");
    if (sigma != NULL && strchr(sigma, ',') == NULL && strcmp(keyframes->space->name, "rigid") == 0)
    {
        error = (bat_error){.text = "--sigma takes two numbers for poses, as in 0.01,0.002: lengths and radians"};
        return report_failure(job->call.input, &error);
    }
    how.scheme.levels = levels;
    how.report = &job->findings.moved;
    how.scheme.progress = report_progress("refining");
    bat_status status = bat_motion_curves(keyframes, &how, fine, &failed, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : curve_failure(job, failed, &error);
}

bool motion_is_drawn(const curve_job *job)
{
    static const char *const shapes[] = {"truth", "panel", "projection", "comb", "axes", NULL};
    return job->is_motion && job->scheme != NULL && strcmp(job->scheme, "spline") == 0 &&
           argument_first(job->call.given, shapes) == NULL;
}

int motion_draw(const curve_job *job)
{
    bat_error error;
    bat_motion_curves_options how = job->motion;
    bat_motion_picture_options options = bat_motion_picture_defaults();
    how.method = BAT_MOTION_METHOD_SPLINE;
    options.title = job->draw.title;
    options.poses = job->poses;
    if (job->units[0][0] != '\0' || job->units[1][0] != '\0')
    {
        options.length_unit = job->units[0];
        options.time_unit = job->units[1];
    }
    const char *path = output_path(&job->call.files, "picture");
    return report_status(NULL, job->call.picture, bat_motion_picture_write(path, &job->coarse, &how, &options, &error),
                         &error);
}
