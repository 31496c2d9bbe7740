#include "curve.h"

#include "report.h"

#include <string.h>

/// Options that only Hermite schemes take, and those that they do not.
static const char *const OURS[] = {"rate", "velocities", "tangents"};
static const char *const OTHERS[] = {"fairness", "model", "snap", "ends", "best-tension"};

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
    if (!argument_number(given, "rate", 0, &motion->rate) || !argument_whole(given, "tangents", 2, 4, 2, &order) ||
        !argument_number(given, "translation-weight", 0, &job->translation_weight))
        return false;
    motion->tangent_order = (size_t)order;
    motion->velocities = argument_flag(given, "velocities");
    if (argument(given, "rate") != NULL && !(motion->rate > 0))
        (void)usage_error(given, "--rate takes a positive number");
    else if (order == 3)
        (void)usage_error(given, "--tangents takes 2 or 4");
    else if (argument(given, "translation-weight") != NULL && !(job->translation_weight > 0))
        (void)usage_error(given, "--translation-weight takes a positive number");
    else
        return true;
    return false;
}

static bool check_options(const arguments *given, const curve_job *job)
{
    const char *ours = first_given(given, OURS, sizeof OURS / sizeof *OURS);
    const char *other = first_given(given, OTHERS, sizeof OTHERS / sizeof *OTHERS);
    bool sampled = job->motion.rate > 0;
    if (!job->hermite && ours != NULL)
        (void)usage_error(given, "--%s goes with --scheme hermite, not '%s'", ours, job->scheme);
    else if (job->hermite && other != NULL)
        (void)usage_error(given, "--%s does not go with --scheme hermite", other);
    else if (sampled && (argument(given, "levels") != NULL || argument(given, "panel") != NULL))
        (void)usage_error(given, "--rate and --levels exclude each other");
    else if (sampled && (job->motion.scheme.kind != BAT_HERMITE_LANE_RIESENFELD || job->motion.scheme.order != 1))
        (void)usage_error(given, "--rate goes with --scheme hermite, not '%s'", job->scheme);
    else
        return true;
    return false;
}

bool curve_hermite_read(const arguments *given, curve_job *job)
{
    bat_error error;
    job->scheme = argument(given, "scheme");
    job->motion = bat_motion_defaults();
    job->motion.scheme.threads = job->refine.threads;
    if (job->scheme == NULL && first_given(given, OURS, sizeof OURS / sizeof *OURS) != NULL)
        job->scheme = "hermite";
    job->hermite = job->scheme != NULL && is_hermite(job->scheme);
    if (job->hermite && bat_hermite_by_name(job->scheme, &job->motion.scheme, &error) != BAT_OK)
    {
        (void)usage_error(given, "%s", error.text);
        return false;
    }
    return read_numbers(given, job) && check_options(given, job);
}

bool curve_hermite_suits(const bat_curve_set *keyframes)
{
    static const char *const spaces[] = {"rotation", "rigid", "spd"};
    for (size_t i = 0; i < sizeof spaces / sizeof *spaces; i++)
        if (strcmp(keyframes->space->name, spaces[i]) == 0)
            return bat_motion_has_times(keyframes) || bat_motion_has_velocities(keyframes);
    return false;
}

int curve_hermite_refine(const curve_job *job, const bat_curve_set *keyframes, size_t levels, bat_curve_set *fine)
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
