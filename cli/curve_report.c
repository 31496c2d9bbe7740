#include "curve.h"

#include "report.h"

#include "batten/curve_measure.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int curve_failure(const curve_job *job, size_t failed, const bat_error *error)
{
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

static bat_status measure_fairness(const bat_curve_set *set, const bat_curve_measure_options *options, curve_totals *sum,
                                   bat_error *error)
{
    *sum = (curve_totals){0};
    bat_curve_fairness_values *fairness = calloc(set->count, sizeof *fairness);
    *error = (bat_error){.status = BAT_NO_MEMORY, .index = BAT_NO_INDEX, .text = "out of memory"};
    if (fairness == NULL)
        return BAT_NO_MEMORY;
    bat_curve_measure_options how = *options;
    how.progress = report_progress("measuring fairness");
    bat_status status = bat_curves_fairness(set->curves, set->count, &how, fairness, NULL, error);
    report_progress_end();
    for (size_t i = 0; i < set->count && status == BAT_OK; i++)
    {
        sum->points += set->curves[i].count;
        sum->length += fairness[i].length;
        sum->bending += fairness[i].bending / (double)set->count;
        sum->g1 = fairness[i].g1 > sum->g1 ? fairness[i].g1 : sum->g1;
    }
    free(fairness);
    return status;
}

/// The mean distances of the curves of two sets, curve by curve.
static bat_status measure_distances(const bat_curve_set *fine, const bat_curve_set *truth,
                                    const bat_curve_measure_options *options, curve_findings *findings, bat_error *error)
{
    bat_curve_distance *each = calloc(fine->count, sizeof *each);
    *error = (bat_error){.status = BAT_NO_MEMORY, .index = BAT_NO_INDEX, .text = "out of memory"};
    if (each == NULL)
        return BAT_NO_MEMORY;
    bat_curve_measure_options how = *options;
    how.progress = report_progress("measuring distances");
    bat_status status = bat_curves_compare(fine->curves, truth->curves, fine->count, &how, each, NULL, error);
    report_progress_end();
    for (size_t i = 0; i < fine->count && status == BAT_OK; i++)
    {
        findings->mean_nn += each[i].mean_nn / (double)fine->count;
        findings->hausdorff += each[i].hausdorff / (double)fine->count;
    }
    free(each);
    return status;
}

/// Measure curves and, where `truth` is not null, their distances from as many others.
static int measure(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine,
                   curve_findings *findings)
{
    bat_error error;
    bat_curve_measure_options options = bat_curve_measure_defaults();
    options.threads = job->read.threads;
    findings->compared = truth != NULL;
    if (measure_fairness(coarse, &options, &findings->before, &error) != BAT_OK ||
        measure_fairness(fine, &options, &findings->after, &error) != BAT_OK)
        return report_failure(job->call.input, &error);
    if (truth != NULL && measure_distances(fine, truth, &options, findings, &error) != BAT_OK)
        return report_failure(job->truth, &error);
    return EXIT_DONE;
}

/// Add the totals of `added` curves to those of `count`.
static void add_totals(curve_totals *sum, size_t count, const curve_totals *part, size_t added)
{
    sum->points += part->points;
    sum->length += part->length;
    sum->bending = (sum->bending * (double)count + part->bending * (double)added) / (double)(count + added);
    sum->g1 = part->g1 > sum->g1 ? part->g1 : sum->g1;
}

int curve_measure(curve_job *job)
{
    return measure(job, &job->coarse, job->truth != NULL ? &job->truths : NULL, &job->fine, &job->findings);
}

int curve_measure_part(curve_job *job, const bat_curve_set *coarse, const bat_curve_set *fine)
{
    curve_findings part = {.curves = 0}, *findings = &job->findings;
    if (coarse->count == 0)
        return EXIT_DONE;
    int code = measure(job, coarse, NULL, fine, &part);
    if (code != EXIT_DONE)
        return code;
    add_totals(&findings->before, findings->curves, &part.before, coarse->count);
    add_totals(&findings->after, findings->curves, &part.after, coarse->count);
    findings->curves += coarse->count;
    return EXIT_DONE;
}

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
        "back\n]"
        "[left_crossing?crossing: {left_crossing} of {checked} refined curves cross themselves; the scheme does not keep "
        "the "
        "given points\n]",
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
        "[snapped?joined: {snapped} points moved onto others or added to edges, by {snap:.3g}{unit} at most\n]"
        "[given_crossing?crossing before: {given_crossing} pairs of given edges cross or touch, and may do so refined\n]"
        "[keeps_areas?areas kept to {largest_area_error:.1g} of them\n]"
        "[crossings?kept apart: {crossings} pairs of refined edges met; the new points of {drawn_back} edges were drawn "
        "back\n]",
        "arcs:z -one_arc:b nodes:z -one_node:b shared:z given_crossing:z crossings:z drawn_back:z snapped:z "
        "largest_area_error:n -keeps_areas:b -snap:n -unit:s",
        map->arcs, (int)(map->arcs == 1), map->nodes, (int)(map->nodes == 1), map->shared, map->given_crossing,
        map->crossings, map->drawn_back, map->snapped, map->largest_area_error, (int)(map->largest_area_error > 0),
        map->largest_snap * (unit[0] != '\0' ? BAT_EARTH_RADIUS : 1), unit);
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
                       "and [tukey?do not "
                       "count][!tukey?count less][count?, the first at time {time}]\n",
                       "rule:s threshold:n keyframes:z count:z first_time:n -tukey:b -time:s",
                       bat_choice_name(&bat_motion_outliers_family, (int)job->motion.spline.outliers), moved->threshold,
                       moved->keys, moved->outliers, any ? first : NAN,
                       (int)(job->motion.spline.outliers == BAT_MOTION_OUTLIERS_TUKEY), time);
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
    if (as_json && !(rate > 0) && curve_stops(job))
        return json_pack("[I, I]", (json_int_t)done->min_levels, (json_int_t)done->max_levels);
    if (as_json)
        return rate > 0 ? json_real(rate) : json_integer((json_int_t)levels);
    if (rate > 0)
        (void)printf("%.15g points a unit of time\n", rate);
    else if (job->motion.times != NULL)
        (void)printf("%zu given times\n", times);
    else if (!curve_stops(job))
        (void)printf("%zu level%s\n", levels, levels == 1 ? "" : "s");
    else
        (void)report_part(
            false,
            "{min} to {max} levels[length?, pieces up to {length}{unit}][distance?, within {distance}{unit} of "
            "the limit]\n",
            "min:z max:z length:s distance:s unit:s", done->min_levels, done->max_levels, length, distance, job->unit);
    return NULL;
}

/// A row of the table that compares the curves before and after.
static json_t *report_totals(const char *name, const curve_totals *t, bool as_json)
{
    return report_part(as_json, "{name:-8} {points:12} {length:12.6g} {bending:14.6g} {g1:15.6g}\n",
                       "-name:s points:z length:n bending:n g1:n", name, t->points, t->length, t->bending, t->g1);
}

/// Report all but the first line. Returns the object, or null where it is printed.
static json_t *report_findings(const curve_job *job, json_t *amount, bool json)
{
    const bat_curve_set *fine = &job->fine;
    const curve_findings *findings = &job->findings;
    bool many = fine->count > 1, corners = job->refine.corner_angle > 0 || findings->done.curves.corners > 0;
    size_t kept = findings->done.curves.corners;
    json_t *outliers = job->is_motion && findings->moved.threshold > 0 ? report_outliers(job, json) : json_null();
    if (!json && corners)
        (void)printf("%zu corner%s kept\n", kept, kept == 1 ? "" : "s");
    if (!json)
        (void)printf("%-8s %12s %12s %14s %15s\n", "", many ? "total points" : "points", many ? "total length" : "length",
                     many ? "mean bending" : "bending", "largest angle");
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
    char keys[160];
    (void)snprintf(keys, sizeof keys,
                   "space:s scheme:s %s:o curves:z given:o refined:o notes:o? left_out:z? outliers:o? %s:o? corners:o? "
                   "projection:s? distance:o?",
                   job->motion.times != NULL ? "times"
                   : job->motion.rate > 0    ? "rate"
                                             : "levels",
                   findings->done.map ? "map" : "simple");
    return report_object(keys, fine->space->name, job->scheme, amount, fine->count, given, refined, notes_json(fine),
                         findings->written.left_out, outliers, crossings,
                         corners ? json_integer((json_int_t)kept) : json_null(), projection, distance);
}

int curve_report(curve_job *job)
{
    const bat_curve_set *fine = &job->fine;
    bool json = job->call.json;
    char place[32];
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
