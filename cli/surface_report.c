#include "surface_report.h"

#include "report.h"
#include "terminal.h"

#include <math.h>
#include <stdio.h>

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

static const bat_surface_candidate *chosen_one(const bat_surface_result *result)
{
    size_t i = 0;
    while (i + 1 < result->candidate_count && result->candidates[i].parameters != result->chosen)
        i++;
    return &result->candidates[i];
}

void surface_report_reason(const surface_findings *findings, char *text, size_t size)
{
    const bat_surface_candidate *first = chosen_one(findings->result), *second = runner_up(findings);
    bool tolerant = findings->options->fit.tolerance > 0;
    if (findings->options->parameters != BAT_SURFACE_PARAMETERS_AUTO)
        (void)snprintf(text, size, "asked for");
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

// Text

static void print_cloud(const surface_findings *findings)
{
    const bat_cloud *cloud = findings->cloud;
    terminal_print(stdout, "%s: %zu points", findings->input, cloud->count);
    if (cloud->duplicates > 0)
        (void)printf(", without %zu that repeat others", cloud->duplicates);
    if (cloud->boundary_count > 0)
        (void)printf(", %zu of them on the boundary%s; corners%s: points", cloud->boundary_count,
                     findings->result->boundary_found ? " that was found" : "",
                     findings->result->corners_found ? " that were found" : "");
    for (int k = 0; k < 4 && cloud->boundary_count > 0; k++)
        (void)printf("%s %zu", k > 0 ? "," : "", place_of(cloud, cloud->corners[k]));
    (void)printf("\n");
}

static void print_candidates(const surface_findings *findings)
{
    const bat_surface_result *result = findings->result;
    char reason[200];
    surface_report_reason(findings, reason, sizeof reason);
    (void)printf("\n%-18s %8s %7s %8s %10s %13s %9s %8s\n", "parameters", "seconds", "folds", "repaired", "functions",
                 findings->options->fit.robust ? "median square" : "mean square", "strays", "seconds");
    for (size_t i = 0; i < result->candidate_count; i++)
    {
        const bat_surface_candidate *candidate = &result->candidates[i];
        (void)printf("%-18s", bat_choice_name(&bat_surface_parameters_family, (int)candidate->parameters));
        if (candidate->failure.status != BAT_OK)
            terminal_print(stdout, " failed: %s\n", candidate->failure.text);
        else
            (void)printf(" %8.3f %7zu %8zu %10zu %13.4g %9.3g %8.2f%s\n", candidate->seconds, candidate->folds.folded,
                         candidate->folds.folded - candidate->repaired.folded, candidate->functions, candidate->mean_squared,
                         candidate->hausdorff, candidate->fit_seconds, candidate->excluded ? "  out: strays" : "");
    }
    (void)printf("%s: %s", bat_choice_name(&bat_surface_parameters_family, (int)result->chosen), reason);
    if (result->trial_points < findings->cloud->count)
        (void)printf(", on trial with %zu of the points", result->trial_points);
    (void)printf("\n");
}

static void print_rounds(const surface_findings *findings)
{
    const bat_surface_fit_report *report = &findings->result->report;
    bool tolerant = findings->options->fit.tolerance > 0;
    (void)printf("\n%5s %10s %7s %12s %12s %8s %10s %8s\n", "round", "functions", "levels", "mean square", "largest",
                 tolerant ? "within" : "", "smoothing", "seconds");
    for (size_t i = 0; i < report->count; i++)
    {
        const bat_surface_fit_round *round = &report->rounds[i];
        char within[16] = "";
        if (tolerant)
            (void)snprintf(within, sizeof within, "%.2f %%", 100 * round->within);
        (void)printf("%5zu %10zu %7zu %12.4g %12.4g %8s %10.2g %8.2f\n", i, round->functions, round->levels,
                     round->mean_squared, round->largest, within, round->weight, round->seconds);
    }
}

static void print_trim(const bat_surface_result *result)
{
    const bat_spline_trim *trim = &result->surface.trim;
    if (trim->loop_count > 0)
        (void)printf("trimmed by an outline and %zu holes, %zu curves in all; %zu holes are filled\n", trim->loop_count - 1,
                     trim->loops[trim->loop_count], result->filled_holes);
}

const char *surface_report_verdict(const bat_surface_verdict *verdict)
{
    static const char *const TEXTS[] = {
        "right", "wrong: points are far from the surface", "wrong: the surface is far from the points",
        "wrong: the surface stands across the points' tangent planes", "wrong: the area is not that of the points"};
    return TEXTS[verdict->fault];
}

static void print_verdict(const surface_findings *findings)
{
    const bat_surface_result *result = findings->result;
    const bat_surface_verdict *verdict = &result->verdict;
    if (result->report.held_out_count > 0)
        (void)printf("%zu points held out: root mean square distance %.4g, largest %.4g\n", result->report.held_out_count,
                     result->report.held_out_rms, result->report.held_out_largest);
    (void)printf("noise: about %.3g in each coordinate, from residuals of local quadratic fits\n", result->noise);
    (void)printf(
        "verdict: %s\n  99 %% of the points within %.3g, 99 %% of the surface within the spacing of points and %.3g, "
        "largest %.3g\n  area %.4g, of the points %.4g; %.2g %% across, %.2g %% far\n",
        surface_report_verdict(verdict), verdict->distance_from_surface, verdict->distance_from_points, verdict->farthest,
        verdict->area, verdict->cloud_area, 100 * verdict->cross_share, 100 * verdict->far_share);
    (void)printf("seconds: boundary %.2f, measures of the cloud %.2f, parameters and fits %.2f\n", result->seconds[0],
                 result->seconds[1], result->seconds[2]);
}

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

void surface_report_print(const surface_findings *findings)
{
    print_cloud(findings);
    print_candidates(findings);
    print_rounds(findings);
    print_end(findings);
    print_trim(findings->result);
    print_verdict(findings);
}

// JSON

static json_t *folds_json(const bat_cloud *cloud, const bat_cloud_parameters_report *folds)
{
    return json_pack("{s:I, s:o, s:I, s:I, s:o}", "folded", (json_int_t)folds->folded, "first",
                     folds->folded > 0 ? json_integer((json_int_t)place_of(cloud, folds->first)) : json_null(), "outside",
                     (json_int_t)folds->outside, "coincident", (json_int_t)folds->coincident, "stretch",
                     report_number(folds->stretch));
}

static json_t *candidate_json(const surface_findings *findings, const bat_surface_candidate *candidate)
{
    const char *name = bat_choice_name(&bat_surface_parameters_family, (int)candidate->parameters);
    if (candidate->failure.status != BAT_OK)
        return json_pack("{s:s, s:s}", "parameters", name, "failure", candidate->failure.text);
    return json_pack("{s:s, s:o, s:o, s:o, s:I, s:o, s:o, s:b, s:b, s:o}", "parameters", name, "seconds",
                     report_number(candidate->seconds), "folds", folds_json(findings->cloud, &candidate->folds), "repaired",
                     folds_json(findings->cloud, &candidate->repaired), "functions", (json_int_t)candidate->functions,
                     findings->options->fit.robust ? "median_squared" : "mean_squared",
                     report_number(candidate->mean_squared), "hausdorff", report_number(candidate->hausdorff), "excluded",
                     (int)candidate->excluded, "reached", (int)candidate->reached, "fit_seconds",
                     report_number(candidate->fit_seconds));
}

static json_t *round_json(const surface_findings *findings, const bat_surface_fit_round *round)
{
    bool tolerant = findings->options->fit.tolerance > 0;
    return json_pack("{s:I, s:I, s:o, s:o, s:o, s:I, s:o, s:o, s:o}", "functions", (json_int_t)round->functions, "levels",
                     (json_int_t)round->levels, "mean_squared", report_number(round->mean_squared), "rms",
                     report_number(round->rms), "largest", report_number(round->largest), "worst",
                     (json_int_t)place_of(findings->cloud, round->worst), "within",
                     tolerant ? json_real(round->within) : json_null(), "smoothing", report_number(round->weight), "seconds",
                     report_number(round->seconds));
}

static json_t *cloud_json(const surface_findings *findings)
{
    const bat_cloud *cloud = findings->cloud;
    json_t *corners = json_array();
    for (int k = 0; k < 4 && cloud->has_corners; k++)
        (void)json_array_append_new(corners, json_integer((json_int_t)place_of(cloud, cloud->corners[k])));
    return json_pack("{s:s, s:I, s:I, s:I, s:b, s:o, s:b}", "file", findings->input, "points", (json_int_t)cloud->count,
                     "duplicates", (json_int_t)cloud->duplicates, "boundary", (json_int_t)cloud->boundary_count,
                     "boundary_found", (int)findings->result->boundary_found, "corners", corners, "corners_found",
                     (int)findings->result->corners_found);
}

static json_t *verdict_json(const bat_surface_verdict *verdict)
{
    static const char *const NAMES[] = {"none", "missed", "strays", "folds", "area"};
    return json_pack("{s:b, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "right",
                     (int)(verdict->fault == BAT_SURFACE_FAULT_NONE), "fault", NAMES[verdict->fault],
                     "distance_from_surface", report_number(verdict->distance_from_surface), "distance_from_points",
                     report_number(verdict->distance_from_points), "farthest", report_number(verdict->farthest), "far_share",
                     report_number(verdict->far_share), "cross_share", report_number(verdict->cross_share), "area",
                     report_number(verdict->area), "cloud_area", report_number(verdict->cloud_area), "spacing",
                     report_number(verdict->spacing));
}

static json_t *held_out_json(const bat_surface_fit_report *report)
{
    return json_pack("{s:I, s:o, s:o}", "points", (json_int_t)report->held_out_count, "rms",
                     report_number(report->held_out_rms), "largest", report_number(report->held_out_largest));
}

static json_t *trim_json(const bat_surface_result *result)
{
    const bat_spline_trim *trim = &result->surface.trim;
    if (trim->loop_count == 0)
        return json_null();
    return json_pack("{s:I, s:I, s:I}", "holes", (json_int_t)trim->loop_count - 1, "curves",
                     (json_int_t)trim->loops[trim->loop_count], "filled_holes", (json_int_t)result->filled_holes);
}

json_t *surface_report_json(const surface_findings *findings)
{
    const bat_surface_result *result = findings->result;
    char reason[200];
    surface_report_reason(findings, reason, sizeof reason);
    json_t *candidates = json_array(), *rounds = json_array();
    for (size_t i = 0; i < result->candidate_count; i++)
        (void)json_array_append_new(candidates, candidate_json(findings, &result->candidates[i]));
    for (size_t i = 0; i < result->report.count; i++)
        (void)json_array_append_new(rounds, round_json(findings, &result->report.rounds[i]));
    return json_pack(
        "{s:o, s:s, s:s, s:I, s:o, s:[ii], s:o, s:o, s:b, s:I, s:I, s:o, s:o, s:o, s:o, s:b, s:o, s:[fff]}", "cloud",
        cloud_json(findings), "chosen", bat_choice_name(&bat_surface_parameters_family, (int)result->chosen), "reason",
        reason, "trial_points", (json_int_t)result->trial_points, "candidates", candidates, "degree",
        findings->options->fit.space.degree[0], findings->options->fit.space.degree[1], "rounds", rounds, "result",
        round_json(findings, &result->report.rounds[result->report.count - 1]), "reached", (int)result->report.reached,
        "moved", (json_int_t)result->report.moved, "outliers", (json_int_t)result->report.outliers, "folds",
        folds_json(findings->cloud, &result->folds), "held_out", held_out_json(&result->report), "noise",
        report_number(result->noise), "verdict", verdict_json(&result->verdict), "below_noise", (int)result->below_noise,
        "trim", trim_json(result), "seconds", result->seconds[0], result->seconds[1], result->seconds[2]);
}
