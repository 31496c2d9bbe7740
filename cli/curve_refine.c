#include "curve.h"

#include "report.h"

#include "batten/research/curve_study.h"
#include "batten/research/networks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool curve_has_tension(const bat_curve_scheme *scheme)
{
    return scheme->kind == BAT_CURVE_SCHEME_ANGLE && scheme->rule == NULL;
}

/// The name of the scheme that a motion gets when the user names none.
static const char *motion_scheme(const curve_job *job)
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

/// Read the file of times.
static int read_times(curve_job *job)
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

/// curve_refine() of a motion.
static int refine_motion(curve_job *job, size_t levels, bat_curve_set *fine)
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

int curve_refine(curve_job *job, size_t levels, bat_curve_set *fine, bat_curve_map_refine_report *report)
{
    if (report != NULL)
        *report = (bat_curve_map_refine_report){.map = false};
    if (job->is_motion)
        return refine_motion(job, levels, fine);
    bat_error error;
    bat_curve_map_refine_options how = job->map;
    how.refine = job->refine;
    how.refine.levels = levels;
    how.refine.progress = report_progress("refining");
    how.decimals = job->write.precision;
    how.report = report;
    size_t failed;
    bat_status status = bat_curve_map_refine(&job->coarse, &how, fine, &failed, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : curve_failure(job, failed, &error);
}

/// Replace the tension of the scheme by the best for the truth, and its name.
static int choose_tension(curve_job *job)
{
    bat_curve_scheme *scheme = &job->refine.scheme;
    bat_error error = {.text = "--best-tension needs an angle-based scheme, which this space does not have"};
    if (!curve_has_tension(scheme))
        return report_failure(job->call.input, &error);
    bat_tension_search_options options = bat_tension_search_defaults();
    options.scheme = *scheme;
    options.levels = job->refine.levels;
    options.threads = job->refine.threads;
    options.progress = report_progress("searching");
    bat_status status =
        bat_tension_search(job->coarse.curves, job->truths.curves, job->coarse.count, &options, &scheme->tension, &error);
    if (report_status(NULL, job->call.input, status, &error) != EXIT_DONE)
        return EXIT_BAD_INPUT;
    (void)snprintf(job->best_name, sizeof job->best_name, "angle:mu=%.10g%s%s", scheme->tension,
                   scheme->sign == BAT_CURVE_ANGLE_SIGN_PRINTED ? ",sign=printed" : "",
                   scheme->adaptive ? ",adaptive=1" : "");
    job->scheme = job->best_name;
    return EXIT_DONE;
}

/// The truth, a curve for each given one.
static int read_truth(curve_job *job)
{
    bat_error error;
    bat_curve_read_options options = job->read;
    options.format = BAT_CURVE_FORMAT_AUTO;
    if (bat_curve_read(job->truth, &options, &job->truths, &error) != BAT_OK)
        return report_bad_input(job->call.given, job->truth, &error);
    if (job->truths.count == job->coarse.count)
        return EXIT_DONE;
    error.line = 0;
    (void)snprintf(error.text, sizeof error.text, "%zu curves cannot be compared with the %zu of %.100s", job->truths.count,
                   job->coarse.count, job->call.input);
    return report_failure(job->truth, &error);
}

/// The default scheme.
static void choose_scheme(curve_job *job)
{
    const bat_curve_set *coarse = &job->coarse;
    bool plain = !job->refine.snap && job->refine.ends == BAT_CURVE_END_RULE_REFLECT && !job->best_tension &&
                 job->refine.simple != BAT_CURVE_SIMPLE_ALWAYS && job->map.topology != BAT_CURVE_MAP_TOPOLOGY_ALWAYS &&
                 !curve_stops(job) && !(job->refine.corner_angle > 0) && coarse->curves[0].corners == NULL;
    if (!job->is_motion && plain && bat_motion_suits(coarse))
    {
        job->is_motion = true;
        job->hint = bat_motion_has_times(coarse) ? "has times: treated as a motion" : "has velocities: treated as a motion";
    }
    if (job->is_motion)
    {
        job->scheme = motion_scheme(job);
        return;
    }
    if (job->refine.scheme.kind == BAT_CURVE_SCHEME_AUTO && coarse->count > 0)
        job->refine.scheme = bat_curve_scheme_for(coarse->curves[0].space, &job->scheme);
    if (job->best_tension && job->scheme != NULL && strcmp(job->scheme, "learned") == 0)
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
    job->refine.max_edge /= globe ? BAT_EARTH_RADIUS : 1;
    job->refine.tolerance /= globe ? BAT_EARTH_RADIUS : 1;
    job->map.snap_tolerance /= globe ? BAT_EARTH_RADIUS : 1;
}

int curve_read(curve_job *job)
{
    bat_error error;
    if (bat_curve_read(job->call.input, &job->read, &job->coarse, &error) != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, &error);
    convert_lengths(job, job->coarse.space);
    if (job->times_file != NULL && read_times(job) != EXIT_DONE)
        return EXIT_BAD_INPUT;
    if (job->scheme == NULL)
        choose_scheme(job);
    int code = EXIT_DONE;
    if (job->truth != NULL)
        code = read_truth(job);
    return code == EXIT_DONE && job->best_tension ? choose_tension(job) : code;
}

/// What a streamed job hands to measure_part().
typedef struct stream_context
{
    curve_job *job;
    int code;
} stream_context;

static bool measure_part(void *context, const bat_curve_set *coarse, const bat_curve_set *fine)
{
    stream_context *stream = context;
    stream->code = curve_measure_part(stream->job, coarse, fine);
    (void)report_progress("refining");
    return stream->code == EXIT_DONE;
}

int curve_stream(curve_job *job)
{
    bat_error error;
    if (bat_space_by_name(job->read.space != NULL ? job->read.space : "sphere", 0, &job->space, &error) != BAT_OK)
        return report_failure(job->call.input, &error);
    convert_lengths(job, &job->space);
    if (job->scheme == NULL)
        job->refine.scheme = bat_curve_scheme_for(&job->space, &job->scheme);
    stream_context stream = {job, EXIT_DONE};
    bat_curve_refine_file_report report;
    bat_curve_refine_file_options options = {.read = job->read, .refine = job->refine, .write = job->write};
    options.refine.progress = report_progress("refining");
    options.refine.report = &job->findings.done.curves;
    options.write.report = &job->findings.written;
    options.visit = job->call.quiet ? NULL : measure_part;
    options.context = &stream;
    const char *path = output_path(&job->call.files, "output");
    bat_status status = bat_curve_refine_file(job->call.input, path != NULL ? path : "-", &options, &report, &error);
    report_progress_end();
    if (stream.code != EXIT_DONE)
        return stream.code;
    if (status != BAT_OK)
        return report_bad_input(job->call.given, error.operand == 1 ? job->call.output : job->call.input, &error);
    job->fine = (bat_curve_set){.space = &job->space, .count = report.curves};
    return EXIT_DONE;
}

// Pictures

/// Give layers the polygons of a set's curves.
static void set_polygons(const bat_curve_set *set, bat_curve_picture_layer *layers)
{
    for (size_t i = 0; i < set->count; i++)
    {
        size_t polygon;
        if (bat_curve_set_polygon(set, i, &polygon, &layers[i].feature))
            layers[i].polygon = polygon + 1;
    }
}

/// The layers of one panel: the control polygons, the truth when there is one, the refined curves unless the level is 0.
static size_t make_layers(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth,
                          const bat_curve_set *fine, size_t levels, bat_curve_picture_layer *layers)
{
    size_t count = 0;
    for (size_t i = 0; i < coarse->count; i++)
        layers[count++] = (bat_curve_picture_layer){
            .curve = &coarse->curves[i], .role = BAT_CURVE_LAYER_ROLE_CONTROL, .label = i == 0 ? "given" : NULL};
    set_polygons(coarse, layers);
    for (size_t i = 0; truth != NULL && i < truth->count; i++)
        layers[count++] = (bat_curve_picture_layer){
            .curve = &truth->curves[i], .role = BAT_CURVE_LAYER_ROLE_TRUTH, .label = i == 0 ? "truth" : NULL};
    for (size_t i = 0; levels > 0 && i < fine->count; i++)
        layers[count++] = (bat_curve_picture_layer){.curve = &fine->curves[i],
                                                    .role = BAT_CURVE_LAYER_ROLE_CURVE,
                                                    .label = i == 0 ? job->scheme : NULL,
                                                    .colour = 1};
    if (levels > 0)
        set_polygons(fine, layers + count - fine->count);
    return count;
}

/// What one picture is made of.
typedef struct panel_set
{
    size_t count;
    bat_curve_set fine[CURVE_MAX_PANELS]; ///< empty where the job's own result is shown
    bat_curve_picture_layer *layers[CURVE_MAX_PANELS];
    char titles[CURVE_MAX_PANELS][24];
    bat_curve_picture_panel panels[CURVE_MAX_PANELS];
} panel_set;

static int make_panel(curve_job *job, panel_set *set)
{
    const bat_curve_set *coarse = &job->coarse, *truth = job->truth != NULL ? &job->truths : NULL, *fine = &job->fine;
    size_t p = set->count++, levels = job->panel_count > 0 ? job->panels[p] : job->refine.levels;
    if (levels > 0 && levels != job->refine.levels)
    {
        int code = curve_refine(job, levels, &set->fine[p], NULL);
        if (code != EXIT_DONE)
            return code;
        fine = &set->fine[p];
    }
    set->layers[p] = calloc(2 * coarse->count + (truth != NULL ? truth->count : 0), sizeof *set->layers[p]);
    if (set->layers[p] == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    (void)snprintf(set->titles[p], sizeof set->titles[p],
                   levels == 0   ? "given"
                   : levels == 1 ? "1 level"
                                 : "%zu levels",
                   levels);
    set->panels[p] = (bat_curve_picture_panel){.layers = set->layers[p],
                                               .layer_count = make_layers(job, coarse, truth, fine, levels, set->layers[p]),
                                               .title = job->panel_count > 0 ? set->titles[p] : NULL};
    return EXIT_DONE;
}

/// Whether the picture is that of a motion in time, and not of its shape.
static bool shows_time(const curve_job *job)
{
    static const char *const shapes[] = {"truth", "panel", "projection", "comb", "axes", NULL};
    return job->is_motion && job->scheme != NULL && strcmp(job->scheme, "spline") == 0 &&
           argument_first(job->call.given, shapes) == NULL;
}

/// Draw the picture of a motion in time.
static int draw_motion(const curve_job *job)
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

int curve_draw(curve_job *job)
{
    if (shows_time(job))
        return draw_motion(job);
    panel_set set = {0};
    bat_error error;
    int code = EXIT_DONE;
    size_t count = job->panel_count > 0 ? job->panel_count : 1;
    while (code == EXIT_DONE && set.count < count)
        code = make_panel(job, &set);
    const char *path = output_path(&job->call.files, "picture");
    bat_status status = BAT_OK;
    if (code == EXIT_DONE)
        status = bat_curve_picture_projection(set.panels, set.count, &job->draw, &job->findings.projection, &error);
    if (code == EXIT_DONE && status == BAT_OK)
        status = bat_curve_picture_write(path, set.panels, set.count, &job->draw, &error);
    if (code == EXIT_DONE)
        code = report_status(NULL, job->call.picture, status, &error);
    for (size_t p = 0; p < set.count; p++)
    {
        free(set.layers[p]);
        bat_curve_set_free(&set.fine[p]);
    }
    return code;
}
