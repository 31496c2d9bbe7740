#include "curve.h"

#include "report.h"
#include "terminal.h"

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

static bat_status no_memory(bat_error *error)
{
    *error = (bat_error){.status = BAT_NO_MEMORY, .index = BAT_NO_INDEX, .text = "out of memory"};
    return BAT_NO_MEMORY;
}

static bat_status measure_fairness(const bat_curve_set *set, const bat_curve_measure_options *options, curve_totals *sum,
                                   bat_error *error)
{
    *sum = (curve_totals){0};
    bat_curve_fairness_values *fairness = calloc(set->count, sizeof *fairness);
    if (fairness == NULL)
        return no_memory(error);
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
    if (each == NULL)
        return no_memory(error);
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

static void print_row(const char *name, const curve_totals *t)
{
    (void)printf("%-8s %12zu %12.6g %14.6g %15.6g\n", name, t->points, t->length, t->bending, t->g1);
}

/// Whether curves crossed themselves.
static void print_simple(const bat_curve_refine_report *simple)
{
    if (simple->given_crossing > 0)
        (void)printf("crossing before: %zu of %zu given curves cross themselves and may do so refined\n",
                     simple->given_crossing, simple->checked);
    if (simple->crossing > simple->left_crossing)
        (void)printf("kept simple: %zu of %zu curves crossed themselves; the new points of %zu edges were drawn back\n",
                     simple->crossing - simple->left_crossing, simple->checked, simple->drawn_back);
    if (simple->left_crossing > 0)
        (void)printf("crossing: %zu of %zu refined curves cross themselves; the scheme does not keep the given points\n",
                     simple->left_crossing, simple->checked);
}

/// What was done to a map.
static void print_map(const bat_curve_map_refine_report *map, const char *unit, double unit_length)
{
    (void)printf("map: %zu arc%s between %zu node%s, %zu shared\n", map->arcs, map->arcs == 1 ? "" : "s", map->nodes,
                 map->nodes == 1 ? "" : "s", map->shared);
    if (map->snapped > 0)
        (void)printf("joined: %zu points moved onto others or added to edges, by %.3g%s at most\n", map->snapped,
                     map->largest_snap * unit_length, unit);
    if (map->given_crossing > 0)
        (void)printf("crossing before: %zu pairs of given edges cross or touch, and may do so refined\n",
                     map->given_crossing);
    if (map->largest_area_error > 0)
        (void)printf("areas kept to %.1g of them\n", map->largest_area_error);
    if (map->crossings > 0)
        (void)printf("kept apart: %zu pairs of refined edges met; the new points of %zu edges were drawn back\n",
                     map->crossings, map->drawn_back);
}

static void print_crossings(const curve_job *job, const bat_curve_map_refine_report *done)
{
    if (done->map)
        print_map(done, job->unit, job->unit[0] != '\0' ? BAT_EARTH_RADIUS : 1);
    else
        print_simple(&done->curves);
}

/// Whether the result has been cut at corners, or could have been.
static bool has_corners(const curve_job *job, const curve_findings *findings)
{
    return job->refine.corner_angle > 0 || findings->done.curves.corners > 0;
}

/// "2 to 7 levels, pieces up to 1000 m, within 5 m of the limit".
static void print_stops(const curve_job *job, const bat_curve_refine_report *done)
{
    const char *length = argument(job->call.given, "max-edge"), *distance = argument(job->call.given, "tolerance");
    (void)printf("%zu to %zu levels", done->min_levels, done->max_levels);
    if (length != NULL)
        (void)printf(", pieces up to %s%s", length, job->unit);
    if (distance != NULL)
        (void)printf(", within %s%s of the limit", distance, job->unit);
    (void)printf("\n");
}

/// What the reader guessed or changed.
static void print_notes(FILE *stream, const bat_curve_set *set)
{
    const char *note;
    for (size_t i = 0; (note = bat_curve_set_note(set, i)) != NULL; i++)
        terminal_print(stream, "note: %s\n", note);
}

/// The rings that have no area at the precision of the file.
static void print_left_out(FILE *stream, const curve_job *job, const bat_curve_set *fine,
                           const bat_curve_write_report *written)
{
    char place[160] = "";
    if (written->left_out == 0)
        return;
    if (written->first_left_out < fine->count && fine->curves != NULL)
        bat_curve_set_place(fine, written->first_left_out, BAT_NO_INDEX, place, sizeof place);
    terminal_print(stream, "note: left out %zu ring%s without area at %d decimals%s%s; --precision writes more\n",
                   written->left_out, written->left_out == 1 ? "" : "s", job->write.precision,
                   place[0] != '\0' ? ", the first in " : "", place);
}

/// ", the first at time 1403715524.907": to the microsecond where the origin is kept apart.
static void print_time(int64_t origin, double seconds)
{
    double whole = floor(seconds);
    if (origin == 0)
        (void)printf(", the first at time %.10g", seconds);
    else
        (void)printf(", the first at time %" PRId64 ".%06.0f", origin + (int64_t)whole, floor((seconds - whole) * 1e6));
}

/// "3 of 40 keyframes are farther than 4.685 sigma from the motion and do not count, the first at time 1.4".
static void print_outliers(const curve_job *job, const bat_curve_set *fine)
{
    const bat_motion_report *moved = &job->findings.moved;
    bool tukey = job->motion.spline.outliers == BAT_MOTION_OUTLIERS_TUKEY;
    if (!job->is_motion || !(moved->threshold > 0))
        return;
    (void)printf("outliers: %zu of %zu keyframes are farther than %.4g sigma from the motion and %s", moved->outliers,
                 moved->keys, moved->threshold, tukey ? "do not count" : "count less");
    if (moved->outliers > 0)
        print_time(bat_curve_set_time_origin(fine), moved->outlier_time);
    (void)printf("\n");
}

static void print_report(const curve_job *job, const bat_curve_set *fine, const curve_findings *findings)
{
    char place[32];
    bool many = fine->count > 1;
    (void)printf("%zu curve%s %s, scheme %s, ", fine->count, many ? "s" : "", place_of(fine->space, place, sizeof place),
                 job->scheme);
    if (job->motion.rate > 0)
        (void)printf("%.15g points a unit of time\n", job->motion.rate);
    else if (job->motion.times != NULL)
        (void)printf("%zu given times\n", job->motion.time_count);
    else if (curve_stops(job))
        print_stops(job, &findings->done.curves);
    else
        (void)printf("%zu level%s\n", job->refine.levels, job->refine.levels == 1 ? "" : "s");
    if (job->is_motion && job->motion.rate == 0 && strcmp(job->scheme, "spline") != 0 && bat_motion_has_times(fine))
        (void)printf("times do not steer this scheme; --scheme spline makes motions in time\n");
    print_outliers(job, fine);
    if (has_corners(job, findings))
        (void)printf("%zu corner%s kept\n", findings->done.curves.corners, findings->done.curves.corners == 1 ? "" : "s");
    (void)printf("%-8s %12s %12s %14s %15s\n", "", many ? "total points" : "points", many ? "total length" : "length",
                 many ? "mean bending" : "bending", "largest angle");
    print_row("given", &findings->before);
    print_row("refined", &findings->after);
    print_crossings(job, &findings->done);
    if (findings->projection != BAT_CURVE_PROJECTION_AUTO)
        (void)printf("picture: projection %s\n", bat_choice_name(&bat_curve_projection_family, (int)findings->projection));
    print_notes(stdout, fine);
    print_left_out(stdout, job, fine, &findings->written);
    if (findings->compared)
        (void)printf("distance to the truth%s: mean %.6g, Hausdorff %.6g\n", many ? " (means over the curves)" : "",
                     findings->mean_nn, findings->hausdorff);
}

static json_t *notes_json(const bat_curve_set *set)
{
    json_t *notes = json_array();
    const char *note;
    for (size_t i = 0; (note = bat_curve_set_note(set, i)) != NULL; i++)
        (void)json_array_append_new(notes, json_string(note));
    return notes;
}

static json_t *totals_json(const curve_totals *t)
{
    return json_pack("{s:I, s:o, s:o, s:o}", "points", (json_int_t)t->points, "length", report_number(t->length), "bending",
                     report_number(t->bending), "g1", report_number(t->g1));
}

static json_t *simple_json(const bat_curve_refine_report *simple)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "checked", (json_int_t)simple->checked, "given_crossing",
                     (json_int_t)simple->given_crossing, "crossing", (json_int_t)simple->crossing, "crossings",
                     (json_int_t)simple->crossings, "drawn_back", (json_int_t)simple->drawn_back, "straight",
                     (json_int_t)simple->straight, "left_crossing", (json_int_t)simple->left_crossing);
}

static json_t *map_json(const bat_curve_map_refine_report *map)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f}", "arcs", (json_int_t)map->arcs, "nodes",
                     (json_int_t)map->nodes, "shared", (json_int_t)map->shared, "given_crossing",
                     (json_int_t)map->given_crossing, "crossings", (json_int_t)map->crossings, "drawn_back",
                     (json_int_t)map->drawn_back, "snapped", (json_int_t)map->snapped, "largest_area_error",
                     map->largest_area_error);
}

/// Add a member to an object and keep the object; null where either is, or where memory runs out.
static json_t *with_member(json_t *object, const char *name, json_t *member)
{
    if (json_object_set_new(object, name, member) == 0)
        return object;
    json_decref(object);
    return NULL;
}

static json_t *outliers_json(const curve_job *job, const bat_curve_set *fine)
{
    const bat_motion_report *moved = &job->findings.moved;
    return json_pack(
        "{s:s, s:f, s:I, s:I, s:o}", "rule", bat_choice_name(&bat_motion_outliers_family, (int)job->motion.spline.outliers),
        "threshold", moved->threshold, "keyframes", (json_int_t)moved->keys, "count", (json_int_t)moved->outliers,
        "first_time",
        moved->outliers > 0 ? json_real((double)bat_curve_set_time_origin(fine) + moved->outlier_time) : json_null());
}

static json_t *make_json(const curve_job *job, const bat_curve_set *fine, const curve_findings *findings)
{
    bool sampled = job->motion.rate > 0, timed = job->motion.times != NULL;
    json_t *amount = timed     ? json_integer((json_int_t)job->motion.time_count)
                     : sampled ? json_real(job->motion.rate)
                               : json_integer((json_int_t)job->refine.levels);
    if (!sampled && !timed && curve_stops(job))
    {
        json_decref(amount);
        amount =
            json_pack("[I, I]", (json_int_t)findings->done.curves.min_levels, (json_int_t)findings->done.curves.max_levels);
    }
    json_t *object = json_pack("{s:s, s:s, s:o, s:I, s:o, s:o}", "space", fine->space->name, "scheme", job->scheme,
                               timed     ? "times"
                               : sampled ? "rate"
                                         : "levels",
                               amount, "curves", (json_int_t)fine->count, "given", totals_json(&findings->before), "refined",
                               totals_json(&findings->after));
    if (bat_curve_set_note(fine, 0) != NULL)
        object = with_member(object, "notes", notes_json(fine));
    if (findings->written.left_out > 0)
        object = with_member(object, "left_out", json_integer((json_int_t)findings->written.left_out));
    if (job->is_motion && findings->moved.threshold > 0)
        object = with_member(object, "outliers", outliers_json(job, fine));
    if (!job->is_motion && findings->done.map)
        object = with_member(object, "map", map_json(&findings->done));
    else if (!job->is_motion)
        object = with_member(object, "simple", simple_json(&findings->done.curves));
    if (has_corners(job, findings))
        object = with_member(object, "corners", json_integer((json_int_t)findings->done.curves.corners));
    if (findings->projection != BAT_CURVE_PROJECTION_AUTO)
        object = with_member(object, "projection",
                             json_string(bat_choice_name(&bat_curve_projection_family, (int)findings->projection)));
    if (findings->compared)
        object = with_member(object, "distance",
                             json_pack("{s:o, s:o}", "mean_nn", report_number(findings->mean_nn), "hausdorff",
                                       report_number(findings->hausdorff)));
    return object;
}

int curve_report(curve_job *job)
{
    const bat_curve_set *fine = &job->fine;
    const curve_findings *findings = &job->findings;
    if (job->call.json)
        return report_json(make_json(job, fine, findings));
    if (job->call.quiet)
    {
        print_notes(stderr, fine);
        print_left_out(stderr, job, fine, &findings->written);
    }
    else
        print_report(job, fine, findings);
    return EXIT_DONE;
}
