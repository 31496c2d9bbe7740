/// @file
/// From a cloud to a spline surface: boundary, parameters, adaptive fit. docs/surfaces.md describes the steps.
///
/// For each way k of parameterizing, S_k is the adaptive fit to the points x_i at the parameters u_i^k. The result is the
/// S_k that surface_candidate_best() selects. Of clouds of more than BAT_SURFACE_ALL_POINTS points, and of scan lines, a
/// part is parameterized and fitted for each k. The other points get the parameters of their feet on the selected surface,
/// and the last fit is to all points.

#include "base/choice.h"
#include "base/option.h"
#include "base/progress.h"
#include "surface/candidate.h"
#include "surface/cloud/boundary.h"

#include <string.h>

enum
{
    MIN_POINTS = 4,         ///< one for each corner of a patch
    MIN_JUDGED = 60,        ///< a tenth of fewer points, which is held out, tells little
    SAMPLE_POINTS = 10000,  ///< of that sample
    POINTS_PER_FUNCTION = 4 ///< minimum number of points for each function of a fit to a part
};

// Fewest conflicts of orientation of a one-sided surface, in roots of the number of points.
static const double ONE_SIDED_ROOTS = 0.25;
// Expected distance of new points, in standard deviations of the noise, below which other candidates are not tried.
static const double NOISE_REACHED = 1.05;
// Progress share of the fits to samples, for clouds that are fitted on a sample first.
static const double TRIAL_SHARE = 0.3;

static const bat_choice PARAMETERS[] = {
    CHOICE("auto",
           "learned, shape-preserving and stretch-minimizing ones, mean values for a mesh: those that fit best by "
           "measure; docs/surfaces.md",
           BAT_SURFACE_PARAMETERS_AUTO),
    CHOICE("learned", "the network that comes with batten, or another model; docs/algorithms/surface-network.md",
           BAT_SURFACE_PARAMETERS_LEARNED),
    CHOICE("shape-preserving",
           "Floater's weights on the Delaunay neighbours in local planes; docs/algorithms/parameterization.md",
           BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING),
    CHOICE("inverse-distance", "weights by the inverse distance of neighbours", BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE),
    CHOICE("uniform", "all neighbours weigh the same", BAT_SURFACE_PARAMETERS_UNIFORM),
    CHOICE("mean-value", "Floater's mean values, for clouds that are meshes", BAT_SURFACE_PARAMETERS_MEAN_VALUE),
    CHOICE("stretch-minimizing", "shape-preserving, evened out: for deep shapes", BAT_SURFACE_PARAMETERS_STRETCH_MINIMIZING),
    CHOICE("isometric", "least distortion of triangles, along the boundary too: for the deepest shapes",
           BAT_SURFACE_PARAMETERS_ISOMETRIC),
    CHOICE_OF_USE(UNNAMED, "given", "brought by the caller", BAT_SURFACE_PARAMETERS_GIVEN),
    CHOICE_OF_USE(RESULT, "planar", "chart of a trimmed surface", BAT_SURFACE_PARAMETERS_PLANAR),
    CHOICE_OF_USE(RESULT, "tensor-product", "the same of a height field, kept, with uniform cells",
                  BAT_SURFACE_PARAMETERS_TENSOR),
};
const bat_family bat_surface_parameters_family = FAMILY("parameterization", PARAMETERS);

static const bat_choice EDGES[] = {
    CHOICE("auto", "exact where points are on the edge, else fair", BAT_SURFACE_EDGES_AUTO),
    CHOICE("exact", "polygons of the outermost points", BAT_SURFACE_EDGES_EXACT),
    CHOICE("fair", "lines, circles and smooth curves everywhere", BAT_SURFACE_EDGES_FAIR),
};
const bat_family bat_surface_edges_family = FAMILY("kind of edges", EDGES);

bat_surface_reconstruct_options bat_surface_reconstruct_defaults(void)
{
    return (bat_surface_reconstruct_options){
        .fit = bat_surface_fit_defaults(), .parameters = BAT_SURFACE_PARAMETERS_AUTO, .repair = true};
}

void bat_surface_result_free(bat_surface_result *result)
{
    bat_spline_surface_free(&result->surface);
    bat_surface_fit_report_free(&result->report);
    free(result->parameters);
    free(result->gaps);
    *result = (bat_surface_result){0};
}

static const option_field FIELDS[] = {
    OPTION_FAMILY(bat_surface_reconstruct_options, parameters, bat_surface_parameters_family),
    OPTION_FAMILY(bat_surface_reconstruct_options, sides, bat_cloud_sides_family),
    OPTION_FIELD(bat_surface_reconstruct_options, fill_holes, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_surface_reconstruct_options, close_gaps, OPTION_NUMBER, 0, INFINITY),
    OPTION_STRUCT(bat_surface_reconstruct_options, fit, bat_surface_fit_fields),
};

static bat_status surface_reconstruct_options_check(const void *opaque, bat_error *error)
{
    const bat_surface_reconstruct_options *options = opaque;
    if (options->parameters == BAT_SURFACE_PARAMETERS_GIVEN && options->given == NULL)
        return error_option(error, "given", "is null, but must hold the parameters where these are given");
    if (options->trim && options->parameters != BAT_SURFACE_PARAMETERS_AUTO)
        return error_option(error, "parameters",
                            "must be auto where trim is set, because a trimmed surface has a chart of its own");
    if ((options->fill_holes > 0 || options->close_gaps > 0) && !options->trim)
        return error_option(error, options->fill_holes > 0 ? "fill_holes" : "close_gaps",
                            "goes with trim, which is not set");
    const bat_hierarchical_options *space = &options->fit.space;
    size_t minimum = (space->spans[0] + (size_t)space->degree[0]) * (space->spans[1] + (size_t)space->degree[1]);
    if (options->fit.functions > 0 && options->fit.functions < minimum)
        return error_option(error, "functions", "is %zu, but must be 0 or at least the %zu of the coarsest spline",
                            options->fit.functions, minimum);
    return BAT_OK;
}

const bat_options_table bat_surface_reconstruct_fields =
    OPTIONS_TABLE(bat_surface_reconstruct_options, FIELDS, surface_reconstruct_options_check);

static void list_kinds(reconstruction *work)
{
    if (work->options->trim)
        work->kinds[work->kind_count++] = BAT_SURFACE_PARAMETERS_PLANAR;
    else if (work->options->parameters != BAT_SURFACE_PARAMETERS_AUTO)
        work->kinds[work->kind_count++] = work->options->parameters;
    else if (work->deep && work->cloud->triangle_count > 0)
    {
        work->kinds[work->kind_count++] = BAT_SURFACE_PARAMETERS_ISOMETRIC;
        work->kinds[work->kind_count++] = BAT_SURFACE_PARAMETERS_MEAN_VALUE;
    }
    else
    {
        work->kinds[work->kind_count++] = BAT_SURFACE_PARAMETERS_LEARNED;
        work->kinds[work->kind_count++] = BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING;
        work->kinds[work->kind_count++] = BAT_SURFACE_PARAMETERS_STRETCH_MINIMIZING;
        work->kinds[work->kind_count++] = BAT_SURFACE_PARAMETERS_ISOMETRIC;
        if (work->cloud->triangle_count > 0)
            work->kinds[work->kind_count++] = BAT_SURFACE_PARAMETERS_MEAN_VALUE;
    }
}

/// Detect the boundary and its corners where they are unknown, and compute the parameters of the boundary points.
static bat_status prepare(reconstruction *work, bat_error *error)
{
    bat_cloud *cloud = work->cloud;
    bat_status status = bat_cloud_check(cloud, error);
    if (status == BAT_OK && cloud->count < MIN_POINTS)
        status = ERROR_ARGUMENT(error, "a surface patch needs at least four points, the cloud has %zu", cloud->count);
    bool given = work->options->parameters == BAT_SURFACE_PARAMETERS_GIVEN;
    if (status == BAT_OK && !given)
        status = canonical_order_apply(cloud, error);
    if (status != BAT_OK || work->options->trim)
        return status;
    if (status == BAT_OK && cloud->boundary_count == 0 && !given)
    {
        progress_part part = {work->options->fit.progress, 0, SURFACE_PREPARE_SHARE};
        status = cloud_find_boundary(cloud, work->disc, progress_of_part(&part), error);
        work->result.boundary_found = true;
    }
    if (status == BAT_OK && !cloud->has_corners && cloud->boundary_count > 0)
    {
        status = bat_cloud_find_corners(cloud, error);
        work->result.corners_found = true;
    }
    if (status != BAT_OK || cloud->boundary_count == 0)
        return status;
    work->boundary = memory_array(cloud->boundary_count, 2 * sizeof *work->boundary);
    if (work->boundary == NULL)
        return error_memory(error, cloud->boundary_count * 2 * sizeof *work->boundary);
    return bat_cloud_boundary_parameters(cloud, work->options->sides, work->boundary, error);
}

/// Set the parameters of the chart, and list a tensor-product surface over it.
static bat_status use_chart(reconstruction *work, bat_error *error)
{
    work->planar = memory_array(work->cloud->count, 2 * sizeof *work->planar);
    if (work->planar == NULL)
        return error_memory(error, work->cloud->count * 2 * sizeof *work->planar);
    trimming_parameters(&work->geometry, &work->trimming, work->planar);
    const double *direction = work->trimming.chart.direction;
    if (vector3_dot(direction, direction) > 0 && work->options->fit.functions == 0 &&
        work->cloud->count <= BAT_SURFACE_ALL_POINTS)
    {
        // Within a tolerance another grid, whose cells are thirds, may be smaller.
        size_t grids = work->options->fit.tolerance > 0 && work->kind_count + 2 <= BAT_SURFACE_MAX_CANDIDATES ? 2 : 1;
        memmove(work->kinds + grids, work->kinds, work->kind_count * sizeof *work->kinds);
        for (size_t k = 0; k < grids; k++)
            work->kinds[k] = BAT_SURFACE_PARAMETERS_TENSOR;
        work->kind_count += grids;
    }
    return BAT_OK;
}

static bat_status make_trimming(reconstruction *work, bat_error *error)
{
    const spatial_order *order = &work->geometry.order;
    bat_status status = diagnose_volume(order->cloud.points, &order->tree, error);
    if (status == BAT_OK)
        status =
            trimming_make(&work->geometry, work->options->fill_holes, work->options->close_gaps, &work->trimming, error);
    if (status != BAT_OK)
        return status;
    work->geometry.area = work->trimming.loops.area;
    work->trimming.loops.edges = work->edges;
    return use_chart(work, error);
}

/// Whether the boundary runs along the sides of the chart's rectangle, and meets its corners.
static bool fills_rectangle(const reconstruction *work)
{
    static const double NEAR_SPACINGS = 2.5, NEAR_NOISE = 4, SHARE = 0.95;
    const planar_chart *chart = &work->trimming.chart;
    const cloud_geometry *geometry = &work->geometry;
    double near = NEAR_SPACINGS * geometry->middle_spacing + NEAR_NOISE * geometry->noise, corners[4];
    size_t boundary = work->cloud->boundary_count, beside = 0;
    for (int k = 0; k < 4; k++)
        corners[k] = INFINITY;
    for (size_t i = 0; i < geometry->order.cloud.count; i++)
    {
        double apart = INFINITY;
        const double low[2] = {chart->places[i][0], chart->places[i][1]};
        const double high[2] = {chart->sides[0] - low[0], chart->sides[1] - low[1]};
        for (int k = 0; k < 4; k++)
        {
            double u = k % 2 == 0 ? low[0] : high[0], v = k / 2 == 0 ? low[1] : high[1];
            corners[k] = fmin(corners[k], hypot(u, v));
            apart = fmin(apart, fmin(u, v));
        }
        beside += geometry->order.places[i] < boundary && apart <= near;
    }
    return (double)beside >= SHARE * (double)boundary &&
           fmax(fmax(corners[0], corners[1]), fmax(corners[2], corners[3])) <= 2 * near;
}

/// A height field over a rectangle is fitted over its projection too.
static bat_status use_rectangle(reconstruction *work, bat_error *error)
{
    bat_error failure;
    if (work->options->parameters != BAT_SURFACE_PARAMETERS_AUTO || work->deep || work->part.members != NULL ||
        !work->result.corners_found || work->options->published || work->options->fit.functions > 0)
        return BAT_OK;
    bat_status status = planar_chart_make(&work->geometry, 0, &work->trimming.chart, &failure);
    if (status == BAT_NO_MEMORY)
        return error_copy(error, &failure);
    return status == BAT_OK && fills_rectangle(work) ? use_chart(work, error) : BAT_OK;
}

/// Whether every candidate is fitted to all points; the best fit is then already the result.
static bool fits_all_points(const reconstruction *work)
{
    return work->part.members == NULL && (work->kind_count == 1 || work->cloud->count <= BAT_SURFACE_ALL_POINTS);
}

static const bat_cloud *parameterized(const reconstruction *work)
{
    return work->part.members != NULL ? &work->part.cloud : work->cloud;
}

/// Take the part of a large cloud, or of scan lines. Meshes and given parameters have none.
static bat_status take_part(reconstruction *work, bat_error *error)
{
    bat_cloud *cloud = work->cloud;
    if (work->boundary == NULL || cloud->triangle_count > 0 || work->options->parameters == BAT_SURFACE_PARAMETERS_GIVEN ||
        work->options->published)
        return BAT_OK;
    bool large = cloud->count > BAT_SURFACE_ALL_POINTS && work->kind_count > 1;
    bat_status status = cloud_part_make(cloud, large ? SAMPLE_POINTS : cloud->count, &work->part, error);
    if (status != BAT_OK || work->part.members == NULL)
        return status;
    size_t count = work->part.cloud.boundary_count;
    work->part_boundary = memory_array(count, 2 * sizeof *work->part_boundary);
    if (work->part_boundary == NULL)
        return error_memory(error, count * 2 * sizeof *work->part_boundary);
    for (size_t i = 0; i < count; i++)
        memcpy(work->part_boundary + 2 * i, work->boundary + 2 * work->part.members[i], 2 * sizeof *work->boundary);
    return BAT_OK;
}

/// The progress of the fits, after the preparation. It lies in `parts`.
static bat_progress fit_progress(const reconstruction *work, double begin, double length, progress_part parts[2])
{
    parts[0] = (progress_part){work->options->fit.progress, SURFACE_PREPARE_SHARE, 1 - SURFACE_PREPARE_SHARE};
    parts[1] = (progress_part){progress_of_part(&parts[0]), begin, length};
    return progress_of_part(&parts[1]);
}

/// Cells of a trimmed surface that are about square.
static void set_spans(const reconstruction *work, bat_hierarchical_options *space)
{
    static const int MAX_SPANS = 64;
    double ratio = fmin(floor(work->trimming.chart.sides[0] / work->trimming.chart.sides[1] + 0.5), MAX_SPANS);
    size_t functions = ((size_t)ratio + (size_t)space->degree[0]) * (1 + (size_t)space->degree[1]);
    if (space->spans[0] == 1 && space->spans[1] == 1 &&
        (work->options->fit.functions == 0 || functions <= work->options->fit.functions))
        space->spans[0] = (size_t)ratio;
}

/// Whether the sides get border curves.
static bool has_border(const reconstruction *work)
{
    const bat_surface_reconstruct_options *options = work->options;
    return work->boundary != NULL && !options->slide_boundary && !options->published &&
           options->parameters != BAT_SURFACE_PARAMETERS_GIVEN;
}

/// The first fits are far from the parts that stand out of a deep shape. Their nearest places say nothing about parameters.
static void correct_late(const reconstruction *work, bat_surface_fit_options *fit)
{
    if (!work->deep)
        return;
    fit->final_corrections = fit->final_corrections > fit->corrections ? fit->final_corrections : fit->corrections;
    fit->corrections = 0;
}

/// Ask for no larger share of the points within a tolerance than noise leaves there: erf(T / (sigma sqrt 2)), less three
/// standard errors. Below TAIL_NOISE standard deviations the tolerance is below the noise.
static void spare_tail(const reconstruction *work, bat_surface_fit_options *fit)
{
    static const double TAIL_NOISE = 1.9, ERRORS = 3;
    double noise = ldexp(work->geometry.noise, 1 - work->geometry.frame.exponent);
    if (fit->tolerance < TAIL_NOISE * noise || !(noise > 0))
        return;
    double within = erf(fit->tolerance / (noise * sqrt(2)));
    within -= ERRORS * sqrt(within * (1 - within) / (double)parameterized(work)->count);
    fit->share = fmin(fit->share, within);
}

static bat_status fit_kind(reconstruction *work, size_t number, bat_error *error)
{
    bat_surface_fit_options fit = work->options->fit;
    spare_tail(work, &fit);
    bool all = fits_all_points(work), has_part = work->part.members != NULL;
    double share = (all ? 1 : TRIAL_SHARE) / (double)work->kind_count;
    progress_part parts[2];
    fit.progress = fit_progress(work, share * (double)number, share, parts);
    bat_status status = progress_check(fit.progress, 0, error);
    if (status != BAT_OK)
        return status;
    bool slides = work->options->slide_boundary, border = has_border(work);
    const bat_cloud *cloud = parameterized(work);
    size_t maximum = cloud->count / POINTS_PER_FUNCTION;
    if (has_part && (fit.functions == 0 || fit.functions > maximum))
        fit.functions = fit.functions == 0 ? 0 : maximum;
    correct_late(work, &fit);
    surface_candidate *candidate = &work->candidates[number];
    bat_surface_reconstruct_options options = *work->options;
    // Charts only ask whether to go on: their share of the time is small.
    progress_part chart = {fit.progress, 0, 0};
    options.fit.progress = progress_of_part(&chart);
    if (work->kinds[number] >= BAT_SURFACE_PARAMETERS_PLANAR)
    {
        options.given = work->planar;
        set_spans(work, &fit.space);
        fit.tensor = work->kinds[number] == BAT_SURFACE_PARAMETERS_TENSOR;
        for (size_t d = 0; d < 2 && fit.tensor && number > 0; d++)
            fit.space.spans[d] *= 3;
    }
    status = surface_candidate_make(cloud, has_part ? work->part_boundary : work->boundary, &options, work->kinds[number],
                                    candidate, error);
    candidate->trimming = work->options->trim ? &work->trimming : NULL;
    if (status == BAT_OK)
        status = progress_check(fit.progress, 0, error);
    if (status == BAT_OK && candidate->report.failure.status == BAT_OK)
        status = all || has_part
                     ? surface_candidate_fit(cloud, &work->geometry, &fit, slides, border, candidate, error)
                     : surface_candidate_fit_sample(cloud, &fit, slides, border, SAMPLE_POINTS, candidate, error);
    return status;
}

bool reconstruction_is_one_sided(const reconstruction *work)
{
    // Neighbours in space may be on sheets that touch; triangles tell them apart, and can be oriented.
    if (work->deep && work->cloud->triangle_count > 0)
        return false;
    double limit = ONE_SIDED_ROOTS * sqrt((double)work->geometry.order.cloud.count);
    return (double)work->geometry.oriented.conflicts > limit;
}

bat_status reconstruction_tell_one_sided(bat_error *error)
{
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                     "the points lie on a one-sided surface, such as a Moebius band, or on sheets that touch; cut it across "
                     "and fit the parts");
}

static bat_status check_best(const reconstruction *work, bat_error *error)
{
    const bat_error *failure = &work->best->report.failure;
    if (failure->status == BAT_OK)
        return BAT_OK;
    if (reconstruction_is_one_sided(work))
        return reconstruction_tell_one_sided(error);
    return error_copy(error, failure);
}

size_t reconstruction_last_budget(const reconstruction *work)
{
    const bat_surface_fit_options *fit = &work->options->fit;
    // Points on lines do not tell what a surface does between them: an even sample tells its size.
    if (work->part.is_even && fit->functions == 0)
        return fit->tolerance > 0 ? work->part.cloud.count / 2 : work->best->report.functions;
    return fit->functions;
}

static bat_status fit_best(reconstruction *work, bat_error *error)
{
    bat_surface_fit_options fit = work->options->fit;
    progress_part parts[2];
    fit.progress = fit_progress(work, TRIAL_SHARE, 1 - TRIAL_SHARE, parts);
    fit.functions = reconstruction_last_budget(work);
    spare_tail(work, &fit);
    correct_late(work, &fit);
    bat_status status = BAT_OK;
    if (work->part.members != NULL)
        status = surface_candidate_extend(work->best, &work->part, work->cloud, work->boundary, error);
    if (status == BAT_OK)
        status = surface_candidate_fit(work->cloud, &work->geometry, &fit, work->options->slide_boundary, has_border(work),
                                       work->best, error);
    return status == BAT_OK ? check_best(work, error) : status;
}

/// Whether a tensor-product surface is right, and as near to new points as the noise allows. Within a tolerance, others may
/// be smaller.
static bool is_at_noise(const reconstruction *work, const bat_surface_candidate *report)
{
    double noise = ldexp(work->geometry.noise, 1 - work->geometry.frame.exponent);
    return report->parameters == BAT_SURFACE_PARAMETERS_TENSOR && report->failure.status == BAT_OK &&
           report->verdict.fault == BAT_SURFACE_FAULT_NONE && report->expected_rms <= NOISE_REACHED * noise &&
           work->options->fit.tolerance == 0;
}

static bat_status fit_kinds(reconstruction *work, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < work->kind_count && status == BAT_OK; i++)
    {
        status = fit_kind(work, i, error);
        if (status != BAT_OK || !is_at_noise(work, &work->candidates[i].report))
            continue;
        work->kind_count = i + 1;
        status = progress_check(work->options->fit.progress, 1, error);
    }
    if (status != BAT_OK)
        return status;
    work->best = &work->candidates[surface_candidate_best(work->candidates, work->kind_count, &work->options->fit)];
    // The chosen grid is the first of its name.
    if (work->best == &work->candidates[1] && work->kinds[1] == BAT_SURFACE_PARAMETERS_TENSOR)
    {
        SWAP(work->candidates[0], work->candidates[1]);
        work->best = work->candidates;
    }
    for (size_t i = 0; i < work->kind_count; i++)
        work->result.candidates[i] = work->candidates[i].report;
    work->result.candidate_count = work->kind_count;
    return check_best(work, error);
}

bool bat_surface_below_noise(const bat_surface_fit_options *options, const bat_surface_fit_report *report, size_t points,
                             double noise)
{
    double share = fmin(options->share, 1 - 1 / (double)points);
    return options->tolerance > 0 && !report->reached && (report->stalled || options->functions == 0) &&
           erf(options->tolerance / (noise * sqrt(2))) < share;
}

bool bat_surface_noise_contradicts(const bat_surface_fit_options *options, double noise)
{
    return options->smoothing == BAT_SURFACE_SMOOTHING_NOISE && (options->noise > 3 * noise || 3 * options->noise < noise);
}

/// Fail where the surface is judged to be wrong.
static bat_status refuse(const bat_surface_verdict *verdict, bool trimmed, bool one_sided, bat_error *error)
{
    if (one_sided)
        return reconstruction_tell_one_sided(error);
    bat_error wrong = {0};
    (void)bat_surface_verdict_check(verdict, &wrong);
    (void)error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "%s", wrong.text);
    return trimmed ? error_remedy(error, BAT_NO_CONVERGENCE, "shell", "fits any shape")
                   : error_remedy(error, BAT_NO_CONVERGENCE, "trim", "fits concave outlines and holes");
}

static bat_status check_part(const reconstruction *work, bat_cloud_parameters_report *folds, bat_error *error)
{
    size_t count = work->part.cloud.count;
    double *parameters = memory_array(count, 2 * sizeof *parameters);
    if (parameters == NULL)
        return error_memory(error, count * 2 * sizeof *parameters);
    for (size_t i = 0; i < count; i++)
        memcpy(parameters + 2 * i, work->best->corrected + 2 * work->part.members[i], 2 * sizeof *parameters);
    bat_status status = bat_cloud_parameters_check(&work->part.cloud, parameters, folds, error);
    free(parameters);
    return status;
}

/// Doubt a right surface over the largest gap that was closed without being asked for.
static void doubt_gaps(bat_surface_result *result)
{
    bat_surface_verdict *verdict = &result->verdict;
    for (size_t k = 0; k < result->gap_count; k++)
    {
        const bat_surface_gap *gap = &result->gaps[k];
        bool first = verdict->doubt != BAT_SURFACE_DOUBT_GAP;
        if (!gap->closed || verdict->fault != BAT_SURFACE_FAULT_NONE || (!first && gap->diameter <= verdict->doubt_size))
            continue;
        verdict->doubt = BAT_SURFACE_DOUBT_GAP;
        verdict->doubt_size = gap->diameter;
        memcpy(verdict->doubt_place, gap->place, sizeof gap->place);
    }
}

bat_status reconstruction_store(reconstruction *work, bat_error *error)
{
    bat_surface_result *result = &work->result;
    surface_candidate *best = work->best;
    bat_status status = BAT_OK;
    if (work->part.members != NULL)
        status = check_part(work, &result->folds, error);
    else if (work->boundary != NULL)
        status = bat_cloud_parameters_check(work->cloud, best->corrected, &result->folds, error);
    if (status != BAT_OK)
        return status;
    result->trial_points = work->part.members != NULL ? work->part.cloud.count
                           : fits_all_points(work)    ? work->cloud->count
                                                      : SAMPLE_POINTS;
    result->chosen = best->report.parameters;
    result->verdict = best->report.verdict;
    result->noise = ldexp(work->geometry.noise, 1 - work->geometry.frame.exponent);
    result->below_noise = bat_surface_below_noise(&work->options->fit, &best->fit, work->cloud->count, result->noise);
    if (work->options->trim)
    {
        result->filled_holes = trimming_drop_filled(&work->trimming, &best->surface.trim);
        trimming_take_gaps(&work->geometry, &work->trimming, &result->gaps, &result->gap_count);
        if (work->options->close_gaps == 0)
            doubt_gaps(result);
    }
    local_plane plane = local_plane_fit_all(best->surface.control, bat_hierarchical_space_functions(best->surface.space));
    result->is_plane = plane.variance[2] <= fmax(result->noise * result->noise, 1e-15 * plane.variance[0]); // or rounding
    result->surface = best->surface;
    result->report = best->fit;
    result->parameters = best->corrected;
    best->surface = (bat_spline_surface){0};
    best->fit = (bat_surface_fit_report){0};
    best->corrected = NULL;
    return BAT_OK;
}

void reconstruction_free(reconstruction *work)
{
    cloud_geometry_free(&work->geometry);
    for (size_t i = 0; i < work->kind_count; i++)
        surface_candidate_free(&work->candidates[i]);
    free(work->boundary);
    free(work->part_boundary);
    cloud_part_free(&work->part);
    free(work->planar);
    trimming_free(&work->trimming);
}

bat_status reconstruction_find(reconstruction *work, bat_error *error)
{
    double begin = clock_seconds();
    progress_part prepare_part = {work->options->fit.progress, SURFACE_PREPARE_SHARE, 0};
    bat_status status = prepare(work, error);
    double prepared = clock_seconds();
    if (status == BAT_OK)
    {
        list_kinds(work);
        status = take_part(work, error);
    }
    if (status == BAT_OK)
        status = progress_check(work->options->fit.progress, SURFACE_PREPARE_SHARE, error);
    if (status == BAT_OK)
        status = cloud_geometry_make(parameterized(work), work->options->fit.threads, progress_of_part(&prepare_part),
                                     &work->geometry, error);
    work->geometry.is_deep = work->deep;
    double measured = clock_seconds();
    if (status == BAT_OK)
        status = work->options->trim ? make_trimming(work, error) : use_rectangle(work, error);
    if (status == BAT_OK)
        status = fit_kinds(work, error);
    const double seconds[3] = {prepared - begin, measured - prepared, clock_seconds() - measured};
    memcpy(work->result.seconds, seconds, sizeof seconds);
    return status;
}

/// Reconstruct a surface, right or wrong.
/// @param disc      factor of the radius of the disc that finds the boundary
/// @param deep      charts of triangles alone, whose parameters are corrected at the end alone
/// @param one_sided receives whether the points lie on a one-sided surface
static bat_status reconstruct(bat_cloud *cloud, const bat_surface_reconstruct_options *options, double disc, bool deep,
                              bat_surface_edges edges, bat_surface_result *result, bool *one_sided, bat_error *error)
{
    reconstruction work = {.cloud = cloud, .options = options, .disc = disc, .deep = deep, .edges = edges};
    bat_status status = reconstruction_find(&work, error);
    double found = clock_seconds();
    if (status == BAT_OK && !fits_all_points(&work))
        status = fit_best(&work, error);
    if (status == BAT_OK)
        status = reconstruction_store(&work, error);
    *one_sided = status == BAT_OK && reconstruction_is_one_sided(&work);
    work.result.seconds[2] += clock_seconds() - found;
    reconstruction_free(&work);
    if (status == BAT_OK)
        *result = work.result;
    return status;
}

/// The ways to reconstruct again where a surface is wrong or doubtful. All but the last have a boundary and charts of
/// triangles (cloud/boundary.h). They begin with the smallest triangles, which leave narrow gaps of the boundary open. The
/// first is also for meshes that are given, and for clouds with a known boundary.
typedef enum other_way
{
    OPEN_GAPS,
    NARROW_GAPS,
    SMALL_GAPS,
    CLOSED_GAPS,
    THIN_PARTS, ///< thin parts are not closed by small triangles across them
    FINE_LOOP,  ///< with a boundary that a smaller disc finds, which enters narrow gaps
    OTHER_WAYS
} other_way;

// A right surface of which more than this share is across the tangent planes is doubtful: others have less than 0.004, or up
// to 0.014 where they are noisy and bend sharply.
static const double DOUBTFUL_CROSS = 0.015;
// Triangles of random points need the scale 1; in meshes, 0.5 suffices for most.
static const advancing_front_options TRIANGLES[FINE_LOOP] = {[OPEN_GAPS] = {.scale = 0.55},
                                                             [NARROW_GAPS] = {.scale = 0.65},
                                                             [SMALL_GAPS] = {.scale = 0.8},
                                                             [CLOSED_GAPS] = {.scale = 1},
                                                             [THIN_PARTS] = {.scale = 0.65, .spares_thin = true}};

/// Prepare a copy of a cloud for another way.
static bat_status prepare_copy(const bat_cloud *cloud, bool finds_boundary, other_way way, bat_progress progress,
                               bat_cloud *copy, bat_error *error)
{
    bat_status status = bat_cloud_copy(cloud, copy, error);
    if (status != BAT_OK || !finds_boundary)
        return status;
    copy->boundary_count = 0;
    copy->has_corners = false;
    if (way == FINE_LOOP)
        return BAT_OK;
    bat_cloud disc = {0};
    status = canonical_order_apply(copy, error);
    if (status == BAT_OK)
        status = advancing_front_triangulate(copy, TRIANGLES[way], progress, &disc, error);
    bat_cloud_free(copy);
    *copy = disc;
    return status;
}

/// Reconstruct again in another way. Keep the result if it is right and less of it is across the tangent planes.
/// @param finds_boundary whether the boundary was found, or is to be found
/// @param cross          share of the surface across the tangent planes, which a better one has not
/// @param is_better      receives whether the result was kept
static bat_status reconstruct_again(bat_cloud *cloud, const bat_surface_reconstruct_options *options, bool finds_boundary,
                                    other_way way, double cross, bat_surface_result *result, bool *is_better,
                                    bat_error *error)
{
    bat_cloud copy = {0};
    bat_surface_result again = {0};
    bat_error failure = {0};
    bool one_sided = false;
    double begin = clock_seconds();
    progress_part part = {options->fit.progress, 0, 0};
    bat_status status = prepare_copy(cloud, finds_boundary, way, progress_of_part(&part), &copy, &failure);
    double prepared = clock_seconds() - begin;
    if (status == BAT_OK)
        status = reconstruct(&copy, options, way == FINE_LOOP ? SURFACE_SMALL_DISC : 1, way != FINE_LOOP,
                             BAT_SURFACE_EDGES_AUTO, &again, &one_sided, &failure);
    *is_better = status == BAT_OK && again.verdict.fault == BAT_SURFACE_FAULT_NONE && !one_sided &&
                 !(again.verdict.cross_share >= cross);
    if (*is_better)
    {
        for (size_t k = 0; k < sizeof again.seconds / sizeof *again.seconds; k++)
            again.seconds[k] += result->seconds[k];
        again.seconds[0] += prepared;
        again.boundary_found = finds_boundary;
        if (finds_boundary)
        {
            // The triangles are no part of the input.
            free(copy.triangles);
            copy.triangles = NULL;
            copy.triangle_count = 0;
        }
        bat_cloud_free(cloud);
        bat_surface_result_free(result);
        *cloud = copy;
        *result = again;
        return BAT_OK;
    }
    bat_cloud_free(&copy);
    bat_surface_result_free(&again);
    return status == BAT_NO_MEMORY || status == BAT_CANCELLED ? error_copy(error, &failure) : BAT_OK;
}

/// Doubt a surface that has no other doubt, at no place.
static void doubt_everywhere(bat_surface_doubt doubt, double size, bat_surface_verdict *verdict)
{
    if (verdict->doubt != BAT_SURFACE_DOUBT_NONE)
        return;
    verdict->doubt = doubt;
    verdict->doubt_size = size;
    verdict->doubt_place[0] = verdict->doubt_place[1] = verdict->doubt_place[2] = NAN;
}

/// Doubt a right surface that is larger than a trimmed one: it covers gaps that the boundary does not enter, or noise.
static bat_status doubt_area(const bat_cloud *cloud, const bat_surface_reconstruct_options *options,
                             bat_surface_result *result, bat_error *error)
{
    static const double LARGER = 0.03;
    bat_surface_reconstruct_options trimmed = *options;
    progress_part part = {options->fit.progress, 0, 0};
    bat_cloud copy = {0};
    bat_surface_result other = {0};
    bat_error failure = {0};
    bool one_sided;
    trimmed.trim = true;
    trimmed.fit.progress = progress_of_part(&part);
    bat_status status = prepare_copy(cloud, true, FINE_LOOP, trimmed.fit.progress, &copy, &failure);
    if (status == BAT_OK)
        status = reconstruct(&copy, &trimmed, 1, false, BAT_SURFACE_EDGES_AUTO, &other, &one_sided, &failure);
    bat_surface_verdict *verdict = &result->verdict;
    double more = status == BAT_OK && other.verdict.fault == BAT_SURFACE_FAULT_NONE ? verdict->area - other.verdict.area : 0;
    if (more > LARGER * verdict->area)
        doubt_everywhere(BAT_SURFACE_DOUBT_AREA, sqrt(more), verdict);
    size_t holes = 0;
    for (size_t k = 0; status == BAT_OK && k < other.gap_count; k++)
    {
        bat_surface_gap gap = other.gaps[k];
        gap.closed = !gap.closed;
        if (gap.closed)
            other.gaps[holes++] = gap;
    }
    result->gaps = other.gaps; // holes of the trimmed surface, which this one covers
    result->gap_count = holes;
    other.gaps = NULL;
    doubt_gaps(result);
    bat_cloud_free(&copy);
    bat_surface_result_free(&other);
    return status == BAT_NO_MEMORY || status == BAT_CANCELLED ? error_copy(error, &failure) : BAT_OK;
}

/// Whether a wrong surface, or none, may become right in another way.
/// @param finds_boundary whether the boundary was found, or is to be found
static bool may_help(const bat_cloud *cloud, const bat_surface_reconstruct_options *options, bool finds_boundary,
                     other_way way, bat_status status)
{
    if (way == FINE_LOOP)
        return finds_boundary && status == BAT_OK;
    if (way != OPEN_GAPS && !finds_boundary)
        return false;
    return options->parameters == BAT_SURFACE_PARAMETERS_AUTO && !options->published && !options->trim &&
           cloud->count <= BAT_SURFACE_ALL_POINTS;
}

bat_status bat_surface_reconstruct(bat_cloud *cloud, const bat_surface_reconstruct_options *options,
                                   bat_surface_result *result, bat_error *error)
{
    return bat_surface_reconstruct_edges(cloud, options, BAT_SURFACE_EDGES_AUTO, result, error);
}

bat_status bat_surface_reconstruct_edges(bat_cloud *cloud, const bat_surface_reconstruct_options *options,
                                         bat_surface_edges edges, bat_surface_result *result, bat_error *error)
{
    static const option_field FIELD = {"edges", 0, OPTION_CHOICE, 0, 0, &bat_surface_edges_family, NULL};
    const bat_surface_reconstruct_options defaults = bat_surface_reconstruct_defaults();
    bat_surface_result made = {0};
    bat_error failure = {0};
    bool one_sided = false;
    bat_status status = bat_options_check(&bat_surface_reconstruct_fields, options, error);
    if (status == BAT_OK)
        status = options_check(&edges, &FIELD, 1, error);
    options = options != NULL ? options : &defaults;
    if (status == BAT_OK && edges != BAT_SURFACE_EDGES_AUTO && !options->trim)
        status = error_option(error, "edges", "goes with trim, which is not set");
    if (status != BAT_OK)
        return status;
    bool has_corners = cloud->has_corners, finds_boundary = cloud->boundary_count == 0 && !options->trim &&
                                                            options->parameters != BAT_SURFACE_PARAMETERS_GIVEN;
    status = reconstruct(cloud, options, 1, false, edges, &made, &one_sided, &failure);
    bool is_right = status == BAT_OK && made.verdict.fault == BAT_SURFACE_FAULT_NONE;
    bool doubtful = is_right && made.verdict.cross_share > DOUBTFUL_CROSS, is_better = false;
    bool goes_on = (!is_right || doubtful) && !has_corners && (status == BAT_OK || status == BAT_NO_CONVERGENCE);
    for (int way = 0; way < OTHER_WAYS && goes_on && !is_better; way++)
    {
        bat_status before = status;
        if (!may_help(cloud, options, finds_boundary, (other_way)way, status) || (doubtful && way >= FINE_LOOP) ||
            (one_sided && way == FINE_LOOP))
            continue;
        status = reconstruct_again(cloud, options, finds_boundary, (other_way)way,
                                   doubtful ? made.verdict.cross_share : INFINITY, &made, &is_better, &failure);
        goes_on = status == BAT_OK;
        is_right = is_right || is_better;
        if (status == BAT_OK && !is_better)
            status = before;
    }
    if (status == BAT_OK && is_right && finds_boundary && !has_corners && cloud->triangle_count == 0 &&
        may_help(cloud, options, true, OPEN_GAPS, status))
        status = doubt_area(cloud, options, &made, &failure);
    if (status == BAT_OK && is_right && cloud->count < MIN_JUDGED)
        doubt_everywhere(BAT_SURFACE_DOUBT_FEW, 0, &made.verdict);
    if (status == BAT_OK && !is_right && !options->force)
        status = refuse(&made.verdict, options->trim, one_sided, &failure);
    if (status == BAT_OK)
        *result = made;
    else
    {
        bat_surface_result_free(&made);
        if (error != NULL)
            *error = failure;
    }
    return status;
}
