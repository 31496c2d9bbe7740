#include "verb.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    MAX_FUNCTIONS = 100000000,
    MAX_ROUNDS = 1000
};

const option_spec SURFACE_FIT_OPTIONS[] = {
    {"tolerance", "T", METHOD, COMMON, "refine where points are farther off than this, in their units",
     POSITIVE(bat_surface_fit_options, tolerance)},
    {"functions", "N", METHOD, COMMON,
     "the maximum number of functions, which is that of control points; default: as many as bring held-out points nearer",
     WHOLE(bat_surface_fit_options, functions, 1, MAX_FUNCTIONS)},
    {"degree", "P[,Q]", METHOD, COMMON, "of the spline in its two directions, 1 to 15; default 3", NO_FIELD},
    {"share", "S", METHOD, 0, "stop when this share of the points is within the tolerance; default 1",
     NUMBER(bat_surface_fit_options, share)},
    {"iterations", "N", METHOD, 0, "the maximum number of refinements; default 30",
     WHOLE(bat_surface_fit_options, iterations, 0, MAX_ROUNDS)},
    {"smoothing", "WEIGHT", METHOD, 0, "of the thin plate; default: found by likelihood, or by --noise",
     NUMBER(bat_surface_fit_options, weight)},
    {"noise", "D", METHOD, 0, "standard deviation of a coordinate, where it is known",
     NUMBER(bat_surface_fit_options, noise)},
    {"robust", NULL, METHOD, COMMON, "points far off count less", FLAG(bat_surface_fit_options, robust)},
    {"corrections", "N", METHOD, 0,
     "rounds that move parameters to the nearest place of the surface, after each fit; default 1",
     WHOLE(bat_surface_fit_options, corrections, 0, MAX_ROUNDS)},
    {"final-corrections", "N", METHOD, 0, "the same after the last refinement; default 0",
     WHOLE(bat_surface_fit_options, final_corrections, 0, MAX_ROUNDS)},
    END_OF_OPTIONS,
};

const option_spec SURFACE_WRITE_OPTIONS[] = {
    {"unit", "UNIT", RESULT, 0, "{}: what STEP and IGES name as the unit of the coordinates; default mm",
     CHOICE(bat_surface_write_options, unit, bat_surface_unit_family)},
    {"samples", "N", RESULT, 0, "of each cell and direction, for VTK and OBJ; default: the degree plus 1",
     WHOLE(bat_surface_write_options, samples, 1, MAX_ROUNDS)},
    {"to", "FORMAT", RESULT, 0, "the format of OUT; default: by its ending",
     CHOICE(bat_surface_write_options, format, bat_surface_format_family)},
    END_OF_OPTIONS,
};

static bool read_degrees(const arguments *given, int degree[2])
{
    const char *text = argument(given, "degree");
    if (text == NULL)
        return true;
    char *end;
    long first = strtol(text, &end, 10), second = first;
    bool good = end != text;
    if (good && *end == ',')
    {
        text = end + 1;
        second = strtol(text, &end, 10);
        good = end != text;
    }
    good = good && *end == '\0' && first >= 1 && first <= BAT_SPLINE_MAX_DEGREE && second >= 1 &&
           second <= BAT_SPLINE_MAX_DEGREE;
    degree[0] = (int)first;
    degree[1] = (int)second;
    return good || argument_refused(given, "degree", "a number from 1 to %d, or two as in 3,2", BAT_SPLINE_MAX_DEGREE);
}

bool surface_check_fit(const arguments *given, bat_surface_fit_options *fit)
{
    if (argument(given, "smoothing") != NULL)
        fit->smoothing = BAT_SURFACE_SMOOTHING_GIVEN;
    else if (argument(given, "noise") != NULL)
        fit->smoothing = BAT_SURFACE_SMOOTHING_NOISE;
    if (!read_degrees(given, fit->space.degree) ||
        !usage_accepts(given, bat_options_check(&bat_surface_fit_fields, fit, report_error())))
        return false;
    if (argument(given, "noise") != NULL && argument(given, "smoothing") != NULL)
        return usage_refused(given, "--noise and --smoothing exclude each other");
    return argument(given, "share") == NULL || argument(given, "tolerance") != NULL ||
           usage_refused(given, "--share needs --tolerance");
}

// The report

/// A point's place in the input.
static size_t place_of(const bat_cloud *cloud, size_t point)
{
    return cloud->order == NULL ? point : cloud->order[point];
}

/// Whether candidates are compared by the expected distance of new points.
static bool compares_expected(const surface_findings *findings, const bat_surface_candidate *candidate)
{
    const bat_surface_fit_options *fit = &findings->options->fit;
    return fit->functions == 0 && !fit->robust && isfinite(candidate->expected_rms);
}

/// The best candidate but the one that was chosen; null where all others fail or stray.
static const bat_surface_candidate *runner_up(const surface_findings *findings)
{
    const bat_surface_result *result = findings->result;
    const bat_surface_candidate *second = NULL;
    for (size_t i = 0; i < result->candidate_count; i++)
    {
        const bat_surface_candidate *candidate = &result->candidates[i];
        if (candidate->parameters != result->chosen && isfinite(candidate->mean_squared) && !candidate->excluded &&
            (second == NULL || (compares_expected(findings, second) ? candidate->expected_rms < second->expected_rms
                                                                    : candidate->mean_squared < second->mean_squared)))
            second = candidate;
    }
    return second;
}

/// Why these parameters were chosen, in a few words.
static void make_reason(const surface_findings *findings, char *text, size_t size)
{
    const bat_surface_result *result = findings->result;
    const bat_surface_candidate *first = result->candidates, *second = runner_up(findings);
    while (first + 1 < result->candidates + result->candidate_count && first->parameters != result->chosen)
        first++;
    bool tolerant = findings->options->fit.tolerance > 0;
    if (findings->options->parameters != BAT_SURFACE_PARAMETERS_AUTO)
        (void)snprintf(text, size, "asked for");
    else if (second == NULL && result->chosen == BAT_SURFACE_PARAMETERS_TENSOR)
        (void)snprintf(text, size, "new points are as near as the noise allows, so that no others were tried");
    else if (second == NULL)
        (void)snprintf(text, size, "the only ones that neither fail nor stray");
    else if (tolerant && first->reached && !second->reached)
        (void)snprintf(text, size, "the only ones that reach the tolerance");
    else if (tolerant && first->reached && first->functions != second->functions)
        (void)snprintf(text, size, "within the tolerance by %zu functions instead of %zu", first->functions,
                       second->functions);
    else if (compares_expected(findings, first))
        (void)snprintf(text, size, "expected distance of new points %.4g instead of %.4g", first->expected_rms,
                       second->expected_rms);
    else
        (void)snprintf(text, size, "%s squared distance %.4g instead of %.4g",
                       findings->options->fit.robust ? "median" : "mean", first->mean_squared, second->mean_squared);
}

static json_t *report_cloud(const surface_findings *findings, bool as_json)
{
    const bat_cloud *cloud = findings->cloud;
    size_t places[4] = {0};
    json_t *corners = json_array();
    for (int k = 0; k < 4 && (cloud->has_corners || cloud->boundary_count > 0); k++)
        places[k] = place_of(cloud, cloud->corners[k]);
    for (int k = 0; k < 4 && cloud->has_corners; k++)
        (void)json_array_append_new(corners, json_integer((json_int_t)places[k]));
    return report_part(
        as_json,
        "{file}: {points} points[duplicates?, without {duplicates} that repeat others][boundary?, {boundary} of them on the "
        "boundary[boundary_found? that was found]; corners[corners_found? that were found]: points {a}, {b}, {c}, {d}]\n",
        "file:s points:z duplicates:z boundary:z boundary_found:b corners:o corners_found:b -a:z -b:z -c:z -d:z",
        findings->input, cloud->count, cloud->duplicates, cloud->boundary_count, (int)findings->result->boundary_found,
        corners, (int)findings->result->corners_found, places[0], places[1], places[2], places[3]);
}

static json_t *folds_json(const bat_cloud *cloud, const bat_cloud_parameters_report *folds)
{
    json_t *first = folds->folded > 0 ? json_integer((json_int_t)place_of(cloud, folds->first)) : json_null();
    return report_object("folded:z first:o outside:z coincident:z stretch:n", folds->folded, first, folds->outside,
                         folds->coincident, folds->stretch);
}

static void report_candidate(report_table *table, const surface_findings *findings, const bat_surface_candidate *candidate)
{
    const char *name = bat_choice_name(&bat_surface_parameters_family, (int)candidate->parameters);
    char keys[160];
    if (candidate->failure.status != BAT_OK)
    {
        report_row(table, "{parameters:-18} failed: {failure}\n", "parameters:s failure:s", name, candidate->failure.text);
        return;
    }
    (void)snprintf(keys, sizeof keys,
                   "parameters:s seconds:n folds:o repaired:o -folded:z -mended:z functions:z -square:n %s_squared:n "
                   "hausdorff:n excluded:b reached:b fit_seconds:n",
                   findings->options->fit.robust ? "median" : "mean");
    report_row(table,
               "{parameters:-18} {seconds:8.3f} {folded:7} {mended:8} {functions:10} {square:13.4g} {hausdorff:9.3g} "
               "{fit_seconds:8.2f}[excluded?  out: strays]\n",
               keys, name, candidate->seconds, folds_json(findings->cloud, &candidate->folds),
               folds_json(findings->cloud, &candidate->repaired), candidate->folds.folded,
               candidate->folds.folded - candidate->repaired.folded, candidate->functions, candidate->mean_squared,
               candidate->mean_squared, candidate->hausdorff, (int)candidate->excluded, (int)candidate->reached,
               candidate->fit_seconds);
}

static json_t *report_round(const surface_findings *findings, size_t index, bool as_json)
{
    const bat_surface_fit_round *round = &findings->result->report.rounds[index];
    bool tolerant = findings->options->fit.tolerance > 0;
    char share[16] = "";
    if (tolerant)
        (void)snprintf(share, sizeof share, "%.2f %%", 100 * round->within);
    return report_part(as_json,
                       "{round:5} {functions:10} {levels:7} {mean_squared:12.4g} {largest:12.4g} {share:8} "
                       "{smoothing:10.2g} {seconds:8.2f}\n",
                       "-round:z functions:z levels:z mean_squared:n rms:n largest:n worst:z within:n -share:s smoothing:n "
                       "seconds:n",
                       index, round->functions, round->levels, round->mean_squared, round->rms, round->largest,
                       place_of(findings->cloud, round->worst), tolerant ? round->within : NAN, share, round->weight,
                       round->seconds);
}

/// What is told of the last round and of the points, in text alone.
static void print_end(const surface_findings *findings)
{
    const bat_surface_result *result = findings->result;
    const bat_surface_fit_options *options = &findings->options->fit;
    const bat_surface_fit_round *last = &result->report.rounds[result->report.count - 1];
    (void)printf("\nroot mean square distance %.4g, largest %.4g at point %zu\n", last->rms, last->largest,
                 place_of(findings->cloud, last->worst));
    if (!result->report.reached && (options->tolerance > 0 || options->functions > 0))
        (void)printf("%s is not reached\n", options->tolerance > 0 ? "the tolerance" : "the number of functions");
    if (options->robust)
        (void)printf("%zu points count as outliers\n", result->report.outliers);
    if (result->folds.folded > 0)
        (void)printf("%zu folds in the corrected parameters, the first at point %zu\n", result->folds.folded,
                     place_of(findings->cloud, result->folds.first));
}

const char *surface_verdict(const bat_surface_verdict *verdict, char text[SURFACE_VERDICT_SIZE])
{
    if (verdict->fault != BAT_SURFACE_FAULT_NONE)
        (void)snprintf(text, SURFACE_VERDICT_SIZE, "wrong: %s",
                       bat_choices(&bat_surface_fault_family, verdict->fault)->summary);
    else if (verdict->doubt != BAT_SURFACE_DOUBT_NONE)
        (void)snprintf(text, SURFACE_VERDICT_SIZE, "right, but %s",
                       bat_choices(&bat_surface_doubt_family, verdict->doubt)->summary);
    else
        (void)snprintf(text, SURFACE_VERDICT_SIZE, "right");
    return text;
}

static json_t *report_verdict(const bat_surface_verdict *verdict, bool as_json)
{
    const double *at = verdict->doubt_place;
    char text[SURFACE_VERDICT_SIZE];
    return report_part(
        as_json,
        "verdict: {verdict}[doubted?, by up to {doubt_size:.3g}, near {x:.4g} {y:.4g} {z:.4g}]\n  99 % of the points within "
        "{distance_from_surface:.3g}, 99 % of the surface within the "
        "spacing of points and {distance_from_points:.3g}, largest {farthest:.3g}\n  area {area:.4g}, of the points "
        "{cloud_area:.4g}; {100 cross_share:.2g} % across, {100 far_share:.2g} % far\n",
        "-verdict:s -doubted:b doubt_size:n -x:n -y:n -z:n doubt:s doubt_place:o right:b fault:s distance_from_surface:n "
        "distance_from_points:n farthest:n far_share:n cross_share:n "
        "area:n cloud_area:n spacing:n",
        surface_verdict(verdict, text), (int)(verdict->doubt != BAT_SURFACE_DOUBT_NONE && isfinite(at[0])),
        verdict->doubt_size, at[0], at[1], at[2], bat_choice_name(&bat_surface_doubt_family, (int)verdict->doubt),
        report_numbers(at, 3), (int)(verdict->fault == BAT_SURFACE_FAULT_NONE),
        bat_choice_name(&bat_surface_fault_family, (int)verdict->fault), verdict->distance_from_surface,
        verdict->distance_from_points, verdict->farthest, verdict->far_share, verdict->cross_share, verdict->area,
        verdict->cloud_area, verdict->spacing);
}

/// The form of the surface: a plane, a tensor product or a hierarchical spline.
static void make_form(const bat_surface_result *result, char *text, size_t size)
{
    const bat_hierarchical_space *space = result->surface.space;
    bat_hierarchical_options first = bat_hierarchical_space_options(space);
    size_t cells = bat_hierarchical_space_cells(space), functions = bat_hierarchical_space_functions(space);
    unsigned level = (unsigned)bat_hierarchical_space_levels(space) - 1;
    const size_t spans[2] = {first.spans[0] << level, first.spans[1] << level};
    if (result->is_plane)
        (void)snprintf(text, size, "plane, %zu functions", functions);
    else if (cells == spans[0] * spans[1])
        (void)snprintf(text, size, "tensor product of %zu x %zu cells, %zu functions", spans[0], spans[1], functions);
    else
        (void)snprintf(text, size, "hierarchical, %zu functions", functions);
}

/// List holes and closed gaps.
static json_t *report_gaps(const bat_surface_result *result, bool as_json)
{
    report_table table = report_begin(as_json);
    for (size_t k = 0; k < result->gap_count; k++)
    {
        const bat_surface_gap *gap = &result->gaps[k];
        report_row(&table, "{kind}: {diameter:.3g} across, area {area:.3g}, near {x:.4g} {y:.4g} {z:.4g}\n",
                   "-kind:s closed:b diameter:n area:n x:n y:n z:n", gap->closed ? "closed gap" : "hole", (int)gap->closed,
                   gap->diameter, gap->area, gap->place[0], gap->place[1], gap->place[2]);
    }
    return table.rows;
}

/// Report the candidates, and what was chosen.
static json_t *report_candidates(const surface_findings *findings, const char *reason, bool as_json)
{
    const bat_surface_result *result = findings->result;
    report_table table = report_begin(as_json);
    report_head(&table, "\nparameters          seconds   folds repaired  functions %13s    strays  seconds\n",
                findings->options->fit.robust ? "median square" : "mean square");
    for (size_t i = 0; i < result->candidate_count; i++)
        report_candidate(&table, findings, &result->candidates[i]);
    report_head(&table, "%s: %s", bat_choice_name(&bat_surface_parameters_family, (int)result->chosen), reason);
    if (result->trial_points < findings->cloud->count)
        report_head(&table, ", on trial with %zu of the points", result->trial_points);
    report_head(&table, "\n");
    return table.rows;
}

/// What a shape's place is, and its axis.
static const struct
{
    const char *axis, *place;
} SHAPES[] = {[BAT_SURFACE_PRIMITIVE_PLANE] = {"normal", "through"},
              [BAT_SURFACE_PRIMITIVE_SPHERE] = {"", "centre"},
              [BAT_SURFACE_PRIMITIVE_CYLINDER] = {"axis", "through"},
              [BAT_SURFACE_PRIMITIVE_CONE] = {"axis", "apex"}};

/// Tell what a file holds of a shape.
static json_t *report_written(const bat_surface_primitive *shape, const surface_written *written, bool as_json)
{
    if (written == NULL || isnan(written->area))
        return json_null();
    return report_part(as_json,
                       "  written as a {kind} of area {area:.7g}, with edges: {lines} lines, {circles} circles, {splines} "
                       "splines\n",
                       "kind:s area:n lines:z circles:z splines:z",
                       bat_choice_name(&bat_surface_primitive_kind_family, (int)shape->kind), written->area,
                       written->edges[1], written->edges[2], written->edges[0]);
}

json_t *surface_shape(const bat_surface_primitive *found, const surface_written *written, bool as_json)
{
    const bat_surface_primitive shape = *found;
    if (shape.kind == BAT_SURFACE_PRIMITIVE_NONE)
        return as_json ? json_null() : NULL;
    bool sphere = shape.kind == BAT_SURFACE_PRIMITIVE_SPHERE;
    const double *at = shape.place, *axis = shape.axis;
    json_t *object = report_part(
        as_json,
        "the points lie on a {kind}[radius? of radius {radius:.6g} (s.d. {radius_deviation:.2g})][angle? of half-angle "
        "{degrees:.6g} degrees (s.d. {degrees_deviation:.2g})][!sphere?, {line} {i:.6f} {j:.6f} {k:.6f} (s.d. {tilt:.2g} "
        "degrees)], {where} {x:.7g} {y:.7g} {z:.7g}[place_deviation? (s.d. {place_deviation:.2g})]\n  their root mean "
        "square distance {rms:.3g}, largest {largest:.3g}\n",
        "kind:s -sphere:b -line:s -where:s -x:n -y:n -z:n -i:n -j:n -k:n place:o axis:o? radius:n? radius_deviation:n? "
        "angle:n? angle_deviation:n? place_deviation:n? axis_deviation:n? -degrees:n -degrees_deviation:n -tilt:n rms:n "
        "largest:n pattern:n",
        bat_choice_name(&bat_surface_primitive_kind_family, (int)shape.kind), (int)sphere, SHAPES[shape.kind].axis,
        SHAPES[shape.kind].place, at[0], at[1], at[2], axis[0], axis[1], axis[2], report_numbers(at, 3),
        sphere ? json_null() : report_numbers(axis, 3), shape.radius, shape.radius_deviation, shape.angle,
        shape.angle_deviation, shape.place_deviation, shape.axis_deviation, shape.angle / DEGREE,
        shape.angle_deviation / DEGREE, shape.axis_deviation / DEGREE, shape.rms, shape.largest, shape.pattern);
    json_t *file = report_written(found, written, as_json);
    return as_json ? report_add(object, "written", file) : object;
}

/// The notes of reading, and one on a noise that was told and contradicts the points.
static json_t *report_notes(const surface_findings *findings, bool as_json)
{
    const bat_surface_fit_options *fit = &findings->options->fit;
    json_t *notes = as_json ? file_notes_json(findings->notes) : NULL;
    char note[120];
    if (!bat_surface_noise_contradicts(fit, findings->result->noise))
        return notes;
    (void)snprintf(note, sizeof note, "--noise %.3g contradicts the points, whose noise is about %.3g", fit->noise,
                   findings->result->noise);
    if (as_json)
        (void)json_array_append_new(notes, json_string(note));
    else
        (void)printf("note: %s\n", note);
    return notes;
}

json_t *surface_report(const surface_findings *findings, bool as_json)
{
    const bat_surface_result *result = findings->result;
    const bat_surface_fit_report *report = &result->report;
    char reason[200], form[100];
    make_reason(findings, reason, sizeof reason);
    make_form(result, form, sizeof form);
    json_t *cloud = report_cloud(findings, as_json), *candidates = report_candidates(findings, reason, as_json);
    report_table rounds = report_begin(as_json);
    report_head(&rounds, "\nround  functions  levels  mean square      largest %8s  smoothing  seconds\n",
                findings->options->fit.tolerance > 0 ? "within" : "");
    for (size_t i = 0; i < findings->result->report.count; i++)
        report_gather(&rounds, report_round(findings, i, as_json));
    if (!as_json)
        print_end(findings);
    if (!as_json)
        (void)printf("form: %s\n", form);
    json_t *shape = surface_shape(findings->shape, findings->written, as_json);
    const bat_spline_trim *cuts = &result->surface.trim;
    json_t *trim = json_null();
    if (cuts->loop_count > 0)
        trim = report_part(
            as_json, "trimmed by an outline and {holes} holes, {curves} curves in all; {filled_holes} holes are filled\n",
            "holes:z curves:z filled_holes:z", cuts->loop_count - 1, (size_t)cuts->loops[cuts->loop_count],
            (size_t)result->filled_holes);
    json_t *gaps = report_gaps(result, as_json);
    json_t *held_out = report_part(
        as_json,
        "[points?{points} points held out: root mean square distance {rms:.4g}, largest {largest:.4g}\n]noise: about "
        "{noise:.3g} in each coordinate, from residuals of local quadratic fits\n",
        "points:z rms:n largest:n -noise:n", report->held_out_count, report->held_out_rms, report->held_out_largest,
        result->noise);
    json_t *notes = report_notes(findings, as_json);
    json_t *verdict = report_verdict(&result->verdict, as_json);
    if (!as_json)
        (void)printf("seconds: boundary %.2f, measures of the cloud %.2f, parameters and fits %.2f\n", result->seconds[0],
                     result->seconds[1], result->seconds[2]);
    if (!as_json)
        return NULL;
    const int *degree = findings->options->fit.space.degree;
    return report_object(
        "cloud:o chosen:s reason:s form:s shape:o gaps:o trial_points:z candidates:o degree:o rounds:o result:o "
        "reached:b moved:z outliers:z "
        "folds:o held_out:o noise:n verdict:o below_noise:b trim:o seconds:o notes:o",
        cloud, bat_choice_name(&bat_surface_parameters_family, (int)result->chosen), reason, form, shape, gaps,
        result->trial_points, candidates, json_pack("[i, i]", degree[0], degree[1]), rounds.rows,
        report_round(findings, report->count - 1, true), (int)report->reached, (size_t)report->moved,
        (size_t)report->outliers, folds_json(findings->cloud, &result->folds), held_out, result->noise, verdict,
        (int)result->below_noise, trim, report_numbers(result->seconds, 3), notes);
}
