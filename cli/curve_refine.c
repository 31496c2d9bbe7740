#include "curve.h"

#include "batten/curve_measure.h"
#include "batten/research/curve_study.h"
#include "batten/research/networks.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Report that refining failed.
static int report_curve(const curve_job *job, const bat_error *error)
{
    size_t failed = error->curve;
    const bat_curve_set *set = &job->coarse;
    bat_error whole = *error;
    char place[160];
    bool whole_curve = failed < set->count && error->operand == 0; // and no point of it
    if (error->index != BAT_NO_INDEX || whole_curve)
    {
        if (failed < set->count && whole.line == 0)
            whole.line = bat_curve_set_line(set, failed, whole_curve ? 0 : error->index);
        bat_curve_set_place(set, failed, error->index, place, sizeof place);
        int length = snprintf(whole.text, sizeof whole.text, "%s%s", place, place[0] != '\0' ? ": " : "");
        (void)snprintf(whole.text + length, sizeof whole.text - (size_t)length, "%.*s", (int)sizeof whole.text - length - 1,
                       error->text);
    }
    bool pair = error->status == BAT_CUT_LOCUS && error->index != BAT_NO_INDEX && error->index > 0 && whole.line > 0;
    if (pair)
    {
        size_t used = strlen(whole.text);
        (void)snprintf(whole.text + used, sizeof whole.text - used, " (line %zu)",
                       bat_curve_set_line(set, failed, error->index - 1));
    }
    return report_bad_input(job->call.given, job->call.input, &whole);
}

/// refine_set() of a motion.
static int refine_motion(curve_job *job, size_t levels, bat_curve_set *fine)
{
    const bat_curve_set *keyframes = &job->coarse;
    bat_motion_curves_options how = job->motion;
    bat_error error;
    const char *sigma = argument(job->call.given, "sigma");
    if (how.spline.sigma < 0 && strcmp(keyframes->space->name, "rigid") == 0)
        how.spline.angle_sigma = BAT_MOTION_SIGMA_AUTO;
    else if (sigma != NULL && strchr(sigma, ',') == NULL && strcmp(keyframes->space->name, "rigid") == 0)
    {
        error = (bat_error){.text = "--sigma takes two numbers for poses, as in 0.01,0.002: lengths and radians"};
        return report_failure(job->call.input, &error);
    }
    how.scheme.levels = levels;
    how.report = &job->findings.moved;
    how.scheme.progress = report_progress("refining");
    bat_status status = bat_motion_curves(keyframes, &how, fine, &error);
    report_progress_end();
    return status == BAT_OK ? EXIT_DONE : report_curve(job, &error);
}

/// Refine a set by `levels` levels, or up to the stops of the job, into another that keeps the file's attributes. `report`
/// receives what was done, zeros for motions; it may be null.
static int refine_set(curve_job *job, size_t levels, bat_curve_set *fine, bat_curve_map_refine_report *report)
{
    if (report != NULL)
        *report = (bat_curve_map_refine_report){.map = false};
    if (job->is_motion)
        return refine_motion(job, levels, fine);
    bat_curve_map_refine_options how = job->map;
    how.refine = job->refine;
    how.refine.levels = levels;
    how.refine.strict = job->read.strict;
    if (report == NULL)
        how.refine.relative_tolerance = 0; // of a panel
    how.refine.progress = report_progress("refining");
    how.decimals = job->write.precision;
    how.report = report;
    bat_status status = bat_curve_map_refine(&job->coarse, &how, fine, report_error());
    report_progress_end();
    if (status == BAT_OK && report != NULL && report->map)
        job->write.given = &job->coarse;
    return status == BAT_OK ? EXIT_DONE : report_curve(job, report_error());
}

/// Replace the tension of the scheme by the best for the truth, and its name.
static int choose_tension(curve_job *job)
{
    bat_curve_scheme *scheme = &job->refine.scheme;
    static const bat_error unsuited = {.text = "--best-tension needs an angle-based scheme, which this space does not have"};
    if (!curve_has_tension(scheme))
        return report_failure(job->call.input, &unsuited);
    bat_tension_search_options options = bat_tension_search_defaults();
    options.scheme = *scheme;
    options.levels = job->refine.levels;
    options.threads = job->refine.threads;
    options.progress = report_progress("searching");
    bat_status status = bat_tension_search(job->coarse.curves, job->truths.curves, job->coarse.count, &options,
                                           &scheme->tension, report_error());
    if (report_status(NULL, job->call.input, status) != EXIT_DONE)
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
    bool plain = !job->refine.snap && job->refine.ends <= BAT_CURVE_END_RULE_REFLECT && !job->best_tension &&
                 job->refine.simple != BAT_CURVE_SIMPLE_ALWAYS && job->map.topology != BAT_CURVE_MAP_TOPOLOGY_ALWAYS &&
                 !curve_stops(job) && job->refine.smooth == 0 && !(job->refine.corner_angle > 0) &&
                 !job->refine.find_corners && coarse->curves[0].corners == NULL;
    if (!job->is_motion && plain && bat_motion_suits(coarse))
    {
        job->is_motion = true;
        job->hint = bat_motion_has_times(coarse) ? "has times: treated as a motion" : "has velocities: treated as a motion";
    }
    if (job->is_motion)
    {
        job->scheme = bat_motion_method_for(coarse, &job->motion) == BAT_MOTION_METHOD_SPLINE ? "spline" : "hermite";
        return;
    }
    if (job->refine.scheme.kind == BAT_CURVE_SCHEME_KIND_AUTO && coarse->count > 0)
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
    double *const lengths[] = {&job->refine.max_edge, &job->refine.tolerance, &job->refine.smooth, &job->map.simplify,
                               &job->map.snap_tolerance};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        *lengths[i] /= globe ? BAT_EARTH_RADIUS : 1;
}

/// What the user did not choose, for geographic files and drawings: corners are kept, unless points are smoothed, and a stop
/// takes the place of levels.
static void choose_for_features(curve_job *job)
{
    static const char *const OF_LEVELS[] = {"levels", "max-edge", "tolerance", "panel", "best-tension", NULL};
    static const double TOLERANCE = 0.02; // a fiftieth of the median edge
    const arguments *given = job->call.given;
    if (!job->best_tension && job->refine.smooth == 0 && argument(given, "corner-angle") == NULL)
        job->refine.find_corners = true;
    if (argument_first(given, OF_LEVELS) == NULL)
        job->refine.relative_tolerance = TOLERANCE;
}

/// Read the curves and all that belongs to them, and choose the scheme.
static int read_curves(curve_job *job)
{
    if (bat_curve_read(job->call.input, &job->read, &job->coarse, report_error()) != BAT_OK)
        return report_bad_input(job->call.given, job->call.input, report_error());
    convert_lengths(job, job->coarse.space);
    if (bat_curve_set_has_features(&job->coarse))
        choose_for_features(job);
    if (job->times_file != NULL &&
        bat_motion_times_read(job->times_file, &job->coarse, &job->times, &job->motion.time_count, report_error()) != BAT_OK)
        return report_bad_input(job->call.given, job->times_file, report_error());
    job->motion.times = job->times;
    if (job->gyro_file != NULL && bat_motion_gyro_read(job->gyro_file, &job->coarse, &job->gyro, report_error()) != BAT_OK)
        return report_bad_input(job->call.given, job->gyro_file, report_error());
    job->motion.spline.gyro = job->gyro_file != NULL ? &job->gyro : NULL;
    if (job->scheme == NULL)
        choose_scheme(job);
    int code = EXIT_DONE;
    if (job->truth != NULL)
        code = read_truth(job);
    return code == EXIT_DONE && job->best_tension ? choose_tension(job) : code;
}

// Measures

static int measure_fairness(const curve_job *job, const bat_curve_set *set, curve_totals *sum)
{
    *sum = (curve_totals){0};
    bat_curve_fairness_values *fairness = calloc(set->count, sizeof *fairness);
    if (fairness == NULL)
        return report_failure(job->call.input, &(bat_error){.text = "out of memory"});
    bat_curve_measure_options how = bat_curve_measure_defaults();
    how.threads = job->read.threads;
    how.progress = report_progress("measuring fairness");
    bat_status status = bat_curves_fairness(set->curves, set->count, &how, fairness, report_error());
    for (size_t i = 0; i < set->count && status == BAT_OK; i++)
    {
        sum->points += set->curves[i].count;
        sum->length += fairness[i].length;
        sum->bending += fairness[i].bending / (double)set->count;
        sum->g1 = fairness[i].g1 > sum->g1 ? fairness[i].g1 : sum->g1;
    }
    free(fairness);
    return report_status(NULL, job->call.input, status);
}

/// The mean distances of the curves from those of the truth, curve by curve.
static int measure_distances(curve_job *job)
{
    size_t count = job->fine.count;
    curve_findings *findings = &job->findings;
    bat_curve_distance *each = calloc(count, sizeof *each);
    if (each == NULL)
        return report_failure(job->truth, &(bat_error){.text = "out of memory"});
    bat_curve_measure_options how = bat_curve_measure_defaults();
    how.threads = job->read.threads;
    how.progress = report_progress("measuring distances");
    bat_status status = bat_curves_compare(job->fine.curves, job->truths.curves, count, &how, each, report_error());
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        findings->mean_nn += each[i].mean_nn / (double)count;
        findings->hausdorff += each[i].hausdorff / (double)count;
    }
    free(each);
    return report_status(NULL, job->truth, status);
}

/// Add the totals of `added` curves to those of `count`.
static void add_totals(curve_totals *sum, size_t count, const curve_totals *part, size_t added)
{
    sum->points += part->points;
    sum->length += part->length;
    sum->bending = (sum->bending * (double)count + part->bending * (double)added) / (double)(count + added);
    sum->g1 = part->g1 > sum->g1 ? part->g1 : sum->g1;
}

/// Measure a part of the curves, after others; job->findings is all zero before the first part.
static int measure_part(curve_job *job, const bat_curve_set *coarse, const bat_curve_set *fine)
{
    curve_findings *findings = &job->findings;
    curve_totals before, after;
    if (coarse->count == 0)
        return EXIT_DONE;
    // Half a turn has no shortest geodesic to measure.
    bool turned = job->is_motion && findings->moved.turned > 0;
    int code = turned ? EXIT_DONE : measure_fairness(job, coarse, &before);
    if (turned)
        before = (curve_totals){findings->moved.keys, NAN, NAN, NAN};
    if (code == EXIT_DONE)
        code = measure_fairness(job, fine, &after);
    if (code != EXIT_DONE)
        return code;
    add_totals(&findings->before, findings->curves, &before, coarse->count);
    add_totals(&findings->after, findings->curves, &after, coarse->count);
    findings->curves += coarse->count;
    for (size_t i = 0; i < coarse->count && !job->is_motion && job->refine.smooth == 0 && job->map.simplify == 0; i++)
    {
        findings->edges += coarse->curves[i].count - !coarse->curves[i].closed;
        findings->straight += bat_curve_straight_edges(&coarse->curves[i], &fine->curves[i]);
    }
    return EXIT_DONE;
}

/// What a streamed job hands to measure_streamed().
typedef struct stream_context
{
    curve_job *job;
    int code;
} stream_context;

static bool measure_streamed(void *context, const bat_curve_set *coarse, const bat_curve_set *fine)
{
    stream_context *stream = context;
    stream->code = measure_part(stream->job, coarse, fine);
    (void)report_progress("refining");
    return stream->code == EXIT_DONE;
}

/// Refine a sequence part by part, from its file to OUT.
static int refine_stream(curve_job *job)
{
    bat_error error;
    if (bat_space_by_name(job->read.space != NULL ? job->read.space : "sphere", 0, &job->space, &error) != BAT_OK)
        return report_failure(job->call.input, &error);
    convert_lengths(job, &job->space);
    choose_for_features(job);
    if (job->scheme == NULL)
        job->refine.scheme = bat_curve_scheme_for(&job->space, &job->scheme);
    stream_context stream = {job, EXIT_DONE};
    bat_curve_refine_file_report report;
    bat_curve_refine_file_options options = {.read = job->read, .refine = job->refine, .write = job->write};
    options.refine.strict = job->read.strict;
    options.refine.progress = report_progress("refining");
    options.refine.report = &job->findings.done.curves;
    options.write.report = &job->findings.written;
    options.visit = job->call.quiet ? NULL : measure_streamed;
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

void curve_layers_group(const bat_curve_set *set, bat_curve_picture_layer *layers)
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
    curve_layers_group(coarse, layers);
    for (size_t i = 0; truth != NULL && i < truth->count; i++)
        layers[count++] = (bat_curve_picture_layer){
            .curve = &truth->curves[i], .role = BAT_CURVE_LAYER_ROLE_TRUTH, .label = i == 0 ? "truth" : NULL};
    for (size_t i = 0; levels > 0 && i < fine->count; i++)
        layers[count++] = (bat_curve_picture_layer){.curve = &fine->curves[i],
                                                    .role = BAT_CURVE_LAYER_ROLE_CURVE,
                                                    .label = i == 0 ? job->scheme : NULL,
                                                    .colour = 1};
    if (levels > 0)
        curve_layers_group(fine, layers + count - fine->count);
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

/// Whether the result is refined up to a stop by default, and a picture would show its edges.
static bool is_too_coarse(const curve_job *job)
{
    static const size_t MANY = 20000;
    size_t points = 0;
    for (size_t i = 0; i < job->fine.count; i++)
        points += job->fine.curves[i].count;
    return job->refine.relative_tolerance > 0 && job->findings.done.curves.stopped > 0 && points < MANY;
}

static int make_panel(curve_job *job, panel_set *set)
{
    const bat_curve_set *coarse = &job->coarse, *truth = job->truth != NULL ? &job->truths : NULL, *fine = &job->fine;
    size_t p = set->count++, levels = job->panel_count > 0 ? job->panels[p] : job->refine.levels;
    if ((levels > 0 && levels != job->refine.levels) || is_too_coarse(job))
    {
        int code = refine_set(job, levels, &set->fine[p], NULL);
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

/// Draw the picture of a motion in time.
static int draw_motion(const curve_job *job)
{
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
    return report_status(NULL, job->call.picture,
                         bat_motion_picture_write(path, &job->coarse, &how, &options, report_error()));
}

/// Draw the picture. findings.projection receives that of the sphere, else BAT_CURVE_PROJECTION_AUTO.
static int draw(curve_job *job)
{
    // A motion in time, unless its shape is asked for.
    static const char *const OF_SHAPES[] = {"truth", "panel", "projection", "comb", "axes", NULL};
    if (job->is_motion && job->scheme != NULL && strcmp(job->scheme, "spline") == 0 &&
        argument_first(job->call.given, OF_SHAPES) == NULL)
        return draw_motion(job);
    panel_set set = {0};
    int code = EXIT_DONE;
    size_t count = job->panel_count > 0 ? job->panel_count : 1;
    while (code == EXIT_DONE && set.count < count)
        code = make_panel(job, &set);
    const char *path = output_path(&job->call.files, "picture");
    bat_status status = BAT_OK;
    if (code == EXIT_DONE)
        status = bat_curve_picture_projection(set.panels, set.count, &job->draw, &job->findings.projection, report_error());
    if (code == EXIT_DONE && status == BAT_OK)
        status = bat_curve_picture_write(path, set.panels, set.count, &job->draw, report_error());
    if (code == EXIT_DONE)
        code = report_status(NULL, job->call.picture, status);
    for (size_t p = 0; p < set.count; p++)
    {
        free(set.layers[p]);
        bat_curve_set_free(&set.fine[p]);
    }
    return code;
}

// The report

/// "on the sphere", "in R^3", "in the space rotation".
static const char *place_of(const bat_space *space, char *text, size_t size)
{
    if (strcmp(space->name, "euclidean") == 0)
        (void)snprintf(text, size, "in R^%zu", space->dimension);
    else if (strcmp(space->name, "sphere") == 0)
        (void)snprintf(text, size, "on the sphere");
    else
    {
        bool noun = strcmp(space->name, "plane") == 0 || strcmp(space->name, "disk") == 0;
        (void)snprintf(text, size, "in the %s%s", noun ? "" : "space ", space->name);
    }
    return text;
}

/// Whether curves crossed themselves.
static json_t *report_simple(const bat_curve_refine_report *simple, bool as_json)
{
    return report_part(
        as_json,
        "[given_crossing?crossing before: {given_crossing} of {checked} given curves cross themselves and may do so "
        "refined\n]"
        "[kept?kept simple: {kept} of {checked} curves crossed themselves; the new points of {drawn_back} edges were drawn "
        "back\n][left_crossing?crossing: {left_crossing} of {checked} refined curves cross themselves: the scheme moves "
        "given points, or given edges overlap\n]",
        "checked:z given_crossing:z crossing:z crossings:z drawn_back:z straight:z left_crossing:z -kept:z", simple->checked,
        simple->given_crossing, simple->crossing, simple->crossings, simple->drawn_back, simple->straight,
        simple->left_crossing,
        simple->crossing > simple->left_crossing ? simple->crossing - simple->left_crossing : (size_t)0);
}

/// What was done to a map.
static json_t *report_map(const bat_curve_map_refine_report *map, const char *unit, bool as_json)
{
    return report_part(
        as_json,
        "map: {arcs} arc[!one_arc?s] between {nodes} node[!one_node?s], {shared} shared\n"
        "[dropped?simplified: {dropped} points dropped\n]"
        "[joints?lines: {joints} pairs of ends meet where no third line does, and go on smoothly\n]"
        "[snapped?joined: {snapped} points moved onto others or added to edges, by {snap:.3g}{unit} at most\n]"
        "[spikes?dropped: {spikes} points of spikes, edges that lead there and back\n]"
        "[given_crossing?crossing before: {given_crossing} pairs of given edges cross or touch, and may do so refined\n]"
        "[keeps_areas?areas kept to {largest_area_error:.1g} of them\n]"
        "[drawn_back?kept apart: {crossings} pairs of refined edges met; the new points of {drawn_back} edges were drawn "
        "back\n]",
        "arcs:z -one_arc:b nodes:z -one_node:b shared:z dropped:z joints:z given_crossing:z crossings:z drawn_back:z "
        "snapped:z spikes:z largest_area_error:n -keeps_areas:b -snap:n -unit:s",
        map->arcs, (int)(map->arcs == 1), map->nodes, (int)(map->nodes == 1), map->shared, map->dropped, map->joints,
        map->given_crossing, map->crossings, map->drawn_back, map->snapped, map->spikes, map->largest_area_error,
        (int)(map->largest_area_error > 0), map->largest_snap * (unit[0] != '\0' ? BAT_EARTH_RADIUS : 1), unit);
}

/// The notes of the reader; JSON's null where there are none.
static json_t *notes_json(const bat_curve_set *set)
{
    const char *note;
    if (bat_curve_set_note(set, 0) == NULL)
        return json_null();
    json_t *notes = json_array();
    for (size_t i = 0; (note = bat_curve_set_note(set, i)) != NULL; i++)
        (void)json_array_append_new(notes, json_string(note));
    return notes;
}

/// What the reader guessed or changed, and the rings that have no area at the precision of the file.
static void print_notes(const curve_job *job, FILE *stream)
{
    const bat_curve_write_report *written = &job->findings.written;
    const bat_curve_set *fine = &job->fine;
    const char *note;
    char place[160] = "";
    for (size_t i = 0; (note = bat_curve_set_note(fine, i)) != NULL; i++)
        report_text(stream, "note: %s\n", note);
    if (written->lost != NULL)
        report_text(stream, "note: the written format has no place for %s\n", written->lost);
    if (written->left_out == 0)
        return;
    if (written->first_left_out < fine->count && fine->curves != NULL)
        bat_curve_set_place(fine, written->first_left_out, BAT_NO_INDEX, place, sizeof place);
    report_text(stream, "note: left out %zu ring%s without area at %d decimals%s%s; --precision writes more\n",
                written->left_out, written->left_out == 1 ? "" : "s", job->write.precision,
                place[0] != '\0' ? ", the first in " : "", place);
}

/// "3 of 40 keyframes are farther than 4.685 sigma from the motion and do not count, the first at time 1.4". Times are to
/// the microsecond where the origin is kept apart.
static json_t *report_outliers(const curve_job *job, bool as_json)
{
    const bat_motion_report *moved = &job->findings.moved;
    int64_t origin = bat_curve_set_time_origin(&job->fine);
    double whole = floor(moved->outlier_time), first = (double)origin + moved->outlier_time;
    bool any = moved->outliers > 0;
    char time[40];
    if (origin == 0)
        (void)snprintf(time, sizeof time, "%.10g", moved->outlier_time);
    else
        (void)snprintf(time, sizeof time, "%" PRId64 ".%06.0f", origin + (int64_t)whole,
                       floor((moved->outlier_time - whole) * 1e6));
    return report_part(as_json,
                       "outliers: {count} of {keyframes} keyframes are farther than {threshold:.4g} sigma from the motion "
                       "and [tukey?do not count][!tukey?count less][count?, the first at time {time}]\n",
                       "rule:s threshold:n keyframes:z count:z first_time:n -tukey:b -time:s",
                       bat_choice_name(&bat_motion_outliers_family, (int)job->motion.spline.outliers), moved->threshold,
                       moved->keys, moved->outliers, any ? first : NAN,
                       (int)(job->motion.spline.outliers == BAT_MOTION_OUTLIERS_TUKEY), time);
}

/// The noise of the keyframes, given or found.
static json_t *report_noise(const curve_job *job, bool as_json)
{
    const bat_motion_report *moved = &job->findings.moved;
    return report_part(as_json, "noise: {sigma:.4g}[turns?, {angle_sigma:.4g} rad] of keyframes[found?, by themselves]\n",
                       "sigma:n angle_sigma:n -turns:b -found:b", moved->sigma, moved->angle_sigma,
                       (int)(moved->angle_sigma > 0), (int)(job->motion.spline.sigma < 0));
}

/// The peaks of speeds, accelerations and jerks, of poses also those of turns; new times.
static json_t *report_peaks(const curve_job *job, bool as_json)
{
    const bat_motion_report *moved = &job->findings.moved;
    const double *way = moved->peaks[0], *turn = moved->peaks[1];
    bool limited = moved->duration != moved->given_duration;
    return report_part(as_json,
                       "[limited?limits: new times, {duration:.6g} in all, {given_duration:.6g} given\n]"
                       "peaks: speed {speed:.4g}[turns?, {angular_speed:.4g} rad], acceleration {acceleration:.4g}[turns?, "
                       "{angular_acceleration:.4g} rad], jerk {jerk:.4g}[turns?, {angular_jerk:.4g} rad] between points\n",
                       "duration:n given_duration:n speed:n angular_speed:n acceleration:n angular_acceleration:n jerk:n "
                       "angular_jerk:n -turns:b -limited:b",
                       moved->duration, moved->given_duration, way[0], turn[0], way[1], turn[1], way[2], turn[2],
                       (int)(strcmp(job->coarse.space->name, "rigid") == 0), (int)limited);
}

/// What keyframes and an accelerometer tell of each other.
static json_t *report_force(const curve_job *job, bool as_json)
{
    const bat_motion_force_report *force = &job->findings.moved.force;
    const double *b = force->bias, *g = force->gravity;
    return report_part(
        as_json,
        "accelerometer[!used? not used]: tells {explained:.3g} of the energy of the keyframes' accelerations; "
        "bias {bias_x:.3g}, {bias_y:.3g}, {bias_z:.3g}; gravity {gravity_x:.4g}, {gravity_y:.4g}, "
        "{gravity_z:.4g}; noise {noise:.3g}\n",
        "explained:n bias_x:n bias_y:n bias_z:n gravity_x:n gravity_y:n gravity_z:n noise:n used:b", force->explained, b[0],
        b[1], b[2], g[0], g[1], g[2], force->noise, (int)force->used);
}

/// "2 to 7 levels, pieces up to 1000 m, within 5 m of the limit", or the other amounts. Returns it for JSON.
static json_t *report_amount(const curve_job *job, bool as_json)
{
    const char *length = argument(job->call.given, "max-edge"), *distance = argument(job->call.given, "tolerance");
    const bat_curve_refine_report *done = &job->findings.done.curves;
    size_t levels = job->refine.levels, times = job->motion.time_count;
    double rate = job->motion.rate;
    if (as_json && job->motion.times != NULL)
        return json_integer((json_int_t)times);
    bool stops = done->stopped > 0, relative = job->refine.relative_tolerance > 0;
    if (as_json && !(rate > 0) && stops)
        return json_pack("[I, I]", (json_int_t)done->min_levels, (json_int_t)done->max_levels);
    if (as_json)
        return rate > 0 ? json_real(rate) : json_integer((json_int_t)levels);
    if (rate > 0)
        (void)printf("%.15g points a unit of time\n", rate);
    else if (job->motion.times != NULL)
        (void)printf("%zu given times\n", times);
    else if (!stops)
        (void)printf("%zu level%s\n", levels, levels == 1 ? "" : "s");
    else
        (void)report_part(
            false,
            "{min} to {max} levels[length?, pieces up to {length}{unit}][distance?, within {distance}{unit} of "
            "the limit][relative?, within a fiftieth of the median edge of the limit]\n",
            "min:z max:z length:s distance:s unit:s relative:b", done->min_levels, done->max_levels, length, distance,
            job->unit, (int)relative);
    return NULL;
}

/// What smoothing did, in the unit of lengths.
static json_t *report_smooth(const curve_job *job, bool as_json)
{
    const bat_curve_refine_report *done = &job->findings.done.curves;
    double unit = job->unit[0] != '\0' ? BAT_EARTH_RADIUS : 1;
    bool estimated = isnan(job->refine.smooth);
    return report_part(as_json,
                       "smoothed: points moved by {mean_move:.3g}{unit} on average, by {largest_move:.3g}{unit} at most"
                       "[estimated?; estimated noise {noise:.3g}{unit}]\n",
                       "mean_move:n largest_move:n noise:n -estimated:b -unit:s", unit * done->mean_move,
                       unit * done->largest_move, estimated ? unit * done->noise : NAN, (int)estimated, job->unit);
}

/// A row of the table that compares the curves before and after.
static json_t *report_totals(const char *name, const curve_totals *t, bool as_json)
{
    return report_part(as_json, "{name:-8} {points:12} {length:12.6g} {bending:14.6g} {g1:15.6g}\n",
                       "-name:s points:z length:n bending:n g1:n", name, t->points, t->length, t->bending, t->g1);
}

/// Given velocities are told from this relative distance from the mean ones on.
static const double CONFLICT = 0.5;

/// Report all but the first line. Returns the object, or null where it is printed.
static json_t *report_findings(const curve_job *job, json_t *amount, bool json)
{
    const bat_curve_set *fine = &job->fine;
    const curve_findings *findings = &job->findings;
    bool many = fine->count > 1,
         corners = job->refine.corner_angle > 0 || job->refine.find_corners || findings->done.curves.corners > 0;
    size_t kept = findings->done.curves.corners;
    json_t *outliers = job->is_motion && findings->moved.threshold > 0 ? report_outliers(job, json) : json_null();
    bool noisy = findings->moved.sigma > 0 || findings->moved.angle_sigma > 0 || job->motion.spline.sigma < 0;
    json_t *noise = noisy ? report_noise(job, json) : json_null();
    const bat_motion_report *moved = &findings->moved;
    json_t *held =
        moved->held == 0
            ? json_null()
            : report_part(
                  json,
                  "held: {held} step[!one?s] between near keys, or in a jump, said nothing of the velocity, which is "
                  "that of the motion around; --tangents smooth goes through it as it is\n",
                  "held:z -one:b", moved->held, (int)(moved->held == 1));
    const double *bias = moved->gyro.bias, *sigma = moved->gyro.bias_sigma;
    json_t *gyro = job->gyro_file == NULL
                       ? json_null()
                       : report_part(json,
                                     "gyroscope: bias {bias_x:.4g}, {bias_y:.4g}, {bias_z:.4g} rad/s, +- {sigma_x:.2g}, "
                                     "{sigma_y:.2g}, {sigma_z:.2g}; "
                                     "noise of its angle {walk:.3g} rad a root of a second\n",
                                     "bias_x:n bias_y:n bias_z:n sigma_x:n sigma_y:n sigma_z:n walk:n", bias[0], bias[1],
                                     bias[2], sigma[0], sigma[1], sigma[2], moved->gyro.walk);
    json_t *force = findings->moved.force.noise > 0 ? report_force(job, json) : json_null();
    json_t *turned =
        moved->turned == 0
            ? json_null()
            : report_part(json,
                          "turns: {turned} interval[!one?s] of rotations go[one?es] another way than the shortest, as "
                          "velocities, rotation vectors or angles tell\n",
                          "turned:z -one:b", moved->turned, (int)(moved->turned == 1));
    json_t *conflict =
        !(moved->conflict > CONFLICT)
            ? json_null()
            : report_part(
                  json,
                  "velocities: those of IN differ from the keys' mean ones by {conflict:.3g} of these: their unit or "
                  "frame may be another; without their columns, the keys tell them\n",
                  "conflict:n", moved->conflict);
    json_t *peaks = findings->moved.duration > 0 ? report_peaks(job, json) : json_null();
    json_t *smoothed = job->refine.smooth != 0 ? report_smooth(job, json) : json_null();
    if (!json && corners)
        (void)printf("%zu corner%s kept\n", kept, kept == 1 ? "" : "s");
    json_t *straight = findings->edges > 0 ? report_part(json, "{straight} of {edges} edges left straight\n",
                                                         "straight:z edges:z", findings->straight, findings->edges)
                                           : json_null();
    if (!json)
        (void)printf("         %12s %12s %14s   largest angle\n", many ? "total points" : "points",
                     many ? "total length" : "length", many ? "mean bending" : "bending");
    json_t *given = report_totals("given", &findings->before, json);
    json_t *refined = report_totals("refined", &findings->after, json);
    json_t *crossings = job->is_motion       ? json_null()
                        : findings->done.map ? report_map(&findings->done, job->unit, json)
                                             : report_simple(&findings->done.curves, json);
    bool projected = findings->projection != BAT_CURVE_PROJECTION_AUTO;
    const char *projection = projected ? bat_choice_name(&bat_curve_projection_family, (int)findings->projection) : NULL;
    if (!json && projected)
        (void)printf("picture: projection %s\n", projection);
    if (!json)
        print_notes(job, stdout);
    json_t *distance =
        !findings->compared
            ? json_null()
            : report_part(json,
                          "distance to the truth[many? (means over the curves)]: mean {mean_nn:.6g}, Hausdorff "
                          "{hausdorff:.6g}\n",
                          "mean_nn:n hausdorff:n -many:b", findings->mean_nn, findings->hausdorff, (int)many);
    if (!json)
        return NULL;
    char keys[300];
    (void)snprintf(keys, sizeof keys,
                   "space:s scheme:s %s:o curves:z given:o refined:o notes:o? left_out:z? lost:s? outliers:o? held:o? "
                   "gyro:o? accelerometer:o? turned:o? conflict:o? noise:o? peaks:o? "
                   "smoothed:o? %s:o? corners:o? left_straight:o? projection:s? distance:o?",
                   job->motion.times != NULL ? "times"
                   : job->motion.rate > 0    ? "rate"
                                             : "levels",
                   findings->done.map ? "map" : "simple");
    return report_object(keys, fine->space->name, job->scheme, amount, fine->count, given, refined, notes_json(fine),
                         findings->written.left_out, findings->written.lost, outliers, held, gyro, force, turned, conflict,
                         noise, peaks, smoothed, crossings, corners ? json_integer((json_int_t)kept) : json_null(), straight,
                         projection, distance);
}

int curve_report(void *of)
{
    const curve_job *job = of;
    const bat_curve_set *fine = &job->fine;
    bool json = job->call.json;
    char place[32];
    if (job->call.silent)
        return EXIT_DONE;
    if (job->hint != NULL)
        report_text(stderr, "batten: %s %s, see `batten motion --help`\n", job->call.input, job->hint);
    if (json)
        return report_json(report_findings(job, report_amount(job, true), true));
    if (job->call.quiet)
        print_notes(job, stderr);
    if (job->call.quiet)
        return EXIT_DONE;
    (void)printf("%zu curve%s %s, scheme %s, ", fine->count, fine->count > 1 ? "s" : "",
                 place_of(fine->space, place, sizeof place), job->scheme);
    (void)report_amount(job, false);
    if (job->is_motion && job->motion.rate == 0 && strcmp(job->scheme, "spline") != 0 && bat_motion_has_times(fine))
        (void)printf("times do not steer this scheme; --scheme spline makes motions in time\n");
    (void)report_findings(job, NULL, false);
    return EXIT_DONE;
}

// The verbs

int curve_make(void *of)
{
    curve_job *job = of;
    curve_findings *findings = &job->findings;
    if (job->model_file != NULL)
    {
        if (bat_curve_model_read_published(job->model_file, &job->model, report_error()) != BAT_OK)
            return report_failure(job->model_file, report_error());
        job->refine.scheme = bat_curve_scheme_of_model(job->model);
        job->refine.scheme.fairness = job->fairness;
    }
    if (job->is_streamed)
        return refine_stream(job);
    int code = read_curves(job);
    if (code == EXIT_DONE)
        code = refine_set(job, job->refine.levels, &job->fine, &job->findings.done);
    if (code == EXIT_DONE && !job->call.quiet)
        code = measure_part(job, &job->coarse, &job->fine);
    findings->compared = job->truth != NULL && !job->call.quiet;
    if (code == EXIT_DONE && findings->compared)
        code = measure_distances(job);
    if (code == EXIT_DONE && job->call.picture != NULL)
        code = draw(job);
    return code;
}

int curve_write(void *of, const char *path)
{
    curve_job *job = of;
    bat_curve_write_options how = job->write;
    how.report = &job->findings.written;
    return report_status(job->call.given, job->call.output,
                         job->is_streamed ? BAT_OK : bat_curve_write(path, &job->fine, &how, report_error()));
}

void curve_end(void *of)
{
    curve_job *job = of;
    if (job->is_streamed)
        job->fine = (bat_curve_set){.count = 0}; // its space is the job's
    bat_curve_set_free(&job->coarse);
    bat_curve_set_free(&job->truths);
    bat_curve_set_free(&job->fine);
    bat_curve_model_free(job->model);
    free(job->times);
    bat_motion_gyro_free(&job->gyro);
}
