/// @file
/// Candidates of bat_surface_reconstruct(): parameterization, repair of folds, fit, metrics, selection.
///
/// The metrics of a surface S for points x_i with parameters u_i are
///     mean squared distance     (1/n) sum_i |S(u_i) - x_i|^2   (robust fits: the median of the squares), and
///     one-sided Hausdorff distance   max over y in Y of min_i |y - x_i|,
/// where Y holds the corners and the centre of every cell of S. The second detects oscillations between the points.

#include "surface/candidate.h"

#include "base/progress.h"
#include "surface/fit/points.h"
#include "surface/parameterize/weights.h"

#include <string.h>

static const size_t POINTS_PER_FUNCTION = 4; ///< minimum number of points for each function of a fit to a sample

// A tensor-product surface is simpler, and parameters that are corrected take a part of the noise.
static const double TENSOR_FACTOR = 0.95;

// Largest admissible ratio of a one-sided Hausdorff distance to the smallest one among the candidates.
static const double MAX_DISTANCE_RATIO = 2;

/// A point is a stray beyond so many spacings, and distances of 99 % of the points.
static const double STRAY = 5;

void surface_candidate_free(surface_candidate *candidate)
{
    free(candidate->parameters);
    free(candidate->corrected);
    bat_spline_surface_free(&candidate->surface);
    bat_surface_fit_report_free(&candidate->fit);
    *candidate = (surface_candidate){0};
}

/// Doubt a right surface over a point that is far beyond all others: least squares bend towards it.
static void doubt_strays(const bat_cloud *cloud, const double *distances, bat_surface_verdict *verdict)
{
    size_t farthest = 0;
    for (size_t i = 1; i < cloud->count; i++)
        farthest = distances[i] > distances[farthest] ? i : farthest;
    double least = STRAY * fmax(verdict->distance_from_surface, verdict->spacing);
    if (verdict->fault != BAT_SURFACE_FAULT_NONE || !(distances[farthest] > least))
        return;
    verdict->doubt = BAT_SURFACE_DOUBT_STRAY;
    verdict->doubt_size = distances[farthest];
    memcpy(verdict->doubt_place, cloud->points + 3 * farthest, sizeof verdict->doubt_place);
}

/// Record a failure of this candidate in its report. A fatal failure is passed on to the caller instead.
static bat_status record_failure(bat_status status, const bat_error *failure, surface_candidate *candidate, bat_error *error)
{
    if (status == BAT_OK)
        return BAT_OK;
    if (status == BAT_NO_MEMORY || status == BAT_CANCELLED) // ends the whole reconstruction
        return error_set(error, status, failure->index, failure->line, "%s", failure->text);
    candidate->report.failure = *failure;
    candidate->report.mean_squared = NAN;
    return BAT_OK;
}

static bat_status parameterize_classical(const bat_cloud *cloud, const double *boundary,
                                         const bat_surface_reconstruct_options *options, bat_surface_parameters kind,
                                         double *parameters, bat_error *error)
{
    static const bat_cloud_parameterization METHODS[BAT_SURFACE_PARAMETERS_COUNT] = {
        [BAT_SURFACE_PARAMETERS_UNIFORM] = BAT_CLOUD_PARAMETERIZATION_UNIFORM,
        [BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE] = BAT_CLOUD_PARAMETERIZATION_INVERSE_DISTANCE,
        [BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING] = BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING,
        [BAT_SURFACE_PARAMETERS_MEAN_VALUE] = BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE,
        [BAT_SURFACE_PARAMETERS_STRETCH_MINIMIZING] = BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING,
        [BAT_SURFACE_PARAMETERS_ISOMETRIC] = BAT_CLOUD_PARAMETERIZATION_ISOMETRIC,
    };
    bat_cloud_parameterize_options method_options = bat_cloud_parameterize_defaults();
    method_options.method = METHODS[kind];
    method_options.published = options->published && method_options.method < BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE;
    method_options.threads = options->fit.threads;
    method_options.progress = options->fit.progress;
    return bat_cloud_parameterize(cloud, boundary, &method_options, parameters, error);
}

static bat_status parameterize(const bat_cloud *cloud, const double *boundary,
                               const bat_surface_reconstruct_options *options, bat_surface_parameters kind,
                               double *parameters, bat_error *error)
{
    if (kind == BAT_SURFACE_PARAMETERS_LEARNED)
    {
        bat_surface_model *builtin = NULL;
        bat_status status = options->model != NULL ? BAT_OK : bat_surface_model_read(NULL, &builtin, error);
        if (status == BAT_OK)
            status = bat_surface_model_parameterize(options->model != NULL ? options->model : builtin, cloud, boundary,
                                                    options->fit.threads, parameters, error);
        bat_surface_model_free(builtin);
        return status;
    }
    if (kind < BAT_SURFACE_PARAMETERS_GIVEN)
        return parameterize_classical(cloud, boundary, options, kind, parameters, error);
    memcpy(parameters, options->given, 2 * cloud->count * sizeof *parameters);
    return BAT_OK;
}

/// Reject parameters with more than a quarter of the interior folded: repair would replace most of them by averages.
static bat_status check_folds(const bat_cloud *cloud, const bat_cloud_parameters_report *folds, bat_error *error)
{
    size_t interior = cloud->count - cloud->boundary_count;
    if (4 * folds->folded <= interior)
        return BAT_OK;
    return error_set(error, BAT_NO_CONVERGENCE, folds->first, 0, "%zu of %zu points are folded", folds->folded, interior);
}

bat_status surface_candidate_make(const bat_cloud *cloud, const double *boundary,
                                  const bat_surface_reconstruct_options *options, bat_surface_parameters kind,
                                  surface_candidate *candidate, bat_error *error)
{
    bat_error failure = {0};
    *candidate = (surface_candidate){.report = {.parameters = kind, .mean_squared = NAN, .expected_rms = NAN},
                                     .parameters = memory_array(cloud->count, 2 * sizeof(double))};
    if (candidate->parameters == NULL)
        return error_memory(error, cloud->count * 2 * sizeof(double));
    double begin = clock_seconds();
    bat_status status = parameterize(cloud, boundary, options, kind, candidate->parameters, &failure);
    candidate->report.seconds = clock_seconds() - begin;
    if (status == BAT_OK && boundary != NULL)
        status = bat_cloud_parameters_check(cloud, candidate->parameters, &candidate->report.folds, &failure);
    candidate->report.repaired = candidate->report.folds;
    if (status == BAT_OK && options->parameters == BAT_SURFACE_PARAMETERS_AUTO && !options->trim)
        status = check_folds(cloud, &candidate->report.folds, &failure);
    if (status == BAT_OK && options->repair && kind < BAT_SURFACE_PARAMETERS_ISOMETRIC &&
        fault_count(&candidate->report.folds) > 0)
        status = bat_cloud_parameters_repair(cloud, candidate->parameters, &candidate->report.repaired, &failure);
    return record_failure(status, &failure, candidate, error);
}

#define CELL_SAMPLES 5 ///< of a cell

/// Parameters of the corners and the centre of all cells.
static void sample_cells(const bat_hierarchical_space *space, size_t cells, double *parameters)
{
    static const double CELL_POINTS[CELL_SAMPLES][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 0.5}};
    bat_hierarchical_options options = bat_hierarchical_space_options(space);
    for (size_t c = 0; c < cells; c++)
    {
        bat_spline_box cell = bat_hierarchical_space_cell(space, c);
        for (size_t s = 0; s < CELL_SAMPLES; s++)
            for (size_t d = 0; d < 2; d++)
                parameters[2 * (c * CELL_SAMPLES + s) + d] =
                    fmin((cell.low[d] + CELL_POINTS[s][d]) / ldexp((double)options.spans[d], (int)cell.level), 1);
    }
}

static bat_status farthest_sample(const double *positions, size_t count, const nearest_tree *tree, double *distance,
                                  bat_error *error)
{
    neighbour_list list = {0};
    bat_status status = BAT_OK;
    *distance = 0;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(tree, positions + 3 * i, 1, &list, error);
        if (status == BAT_OK)
            *distance = fmax(*distance, sqrt(list.entries[0].squared));
    }
    neighbour_list_free(&list);
    return status;
}

/// One-sided Hausdorff distance: the most that corners and centres of cells are away from the nearest point.
static bat_status one_sided_hausdorff(const bat_spline_surface *surface, const double *points, size_t count,
                                      double *distance, bat_error *error)
{
    size_t cells = bat_hierarchical_space_cells(surface->space), samples = cells * CELL_SAMPLES;
    nearest_tree tree;
    bat_status status = neighbours_build(points, count, &tree, error);
    if (status != BAT_OK)
        return status;
    memory_pool pool = {0};
    double *parameters = memory_pool_array(&pool, samples, 2 * sizeof *parameters);
    double *positions = memory_pool_array(&pool, samples, 3 * sizeof *positions);
    status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        sample_cells(surface->space, cells, parameters);
    if (status == BAT_OK)
        status = bat_spline_surface_evaluate(surface, parameters, samples, 0, positions, error);
    if (status == BAT_OK)
        status = farthest_sample(positions, samples, &tree, distance, error);
    memory_pool_free(&pool);
    nearest_free(&tree);
    return status;
}

// Fits

/// The median of the squared distances, which is insensitive to outliers.
static bat_status median_squared(const double *distances, size_t count, double *median, bat_error *error)
{
    double *sorted = memory_array(count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, count * sizeof *sorted);
    memcpy(sorted, distances, count * sizeof *sorted);
    *median = sort_median(sorted, count);
    *median *= *median;
    free(sorted);
    return BAT_OK;
}

static bat_status record_metrics(const bat_surface_fit_data *data, const bat_surface_fit_options *options,
                                 const bat_spline_surface *surface, const bat_surface_fit_report *fit,
                                 bat_surface_candidate *report, bat_error *error)
{
    const bat_surface_fit_round *last = &fit->rounds[fit->count - 1];
    report->functions = last->functions;
    report->mean_squared = last->mean_squared;
    report->expected_rms = fit->expected_rms;
    report->reached = fit->reached;
    report->fit_seconds = last->seconds;
    bat_status status = one_sided_hausdorff(surface, data->points, data->count, &report->hausdorff, error);
    if (status == BAT_OK && options->robust)
        status = median_squared(fit->distances, data->count, &report->mean_squared, error);
    return status;
}

/// Whether all boundary parameters lie on the sides of the unit square. Only given parameters may violate this.
static bool boundary_on_sides(const bat_cloud *cloud, const double *parameters)
{
    for (size_t i = 0; i < cloud->boundary_count; i++)
    {
        double u = parameters[2 * i], v = parameters[2 * i + 1];
        if (u != 0 && u != 1 && v != 0 && v != 1)
            return false;
    }
    return true;
}

bat_status surface_candidate_fit(const bat_cloud *cloud, const cloud_geometry *geometry,
                                 const bat_surface_fit_options *options, bool slides, bool border,
                                 surface_candidate *candidate, bat_error *error)
{
    bat_error failure = {0};
    if (array_make(&candidate->corrected, cloud->count, 2 * sizeof *candidate->corrected, error) != BAT_OK)
        return BAT_NO_MEMORY;
    memcpy(candidate->corrected, candidate->parameters, 2 * cloud->count * sizeof *candidate->corrected);
    bat_surface_fit_data data = {.points = cloud->points,
                                 .parameters = candidate->corrected,
                                 .count = cloud->count,
                                 .dimension = 3,
                                 .boundary_count =
                                     boundary_on_sides(cloud, candidate->parameters) ? cloud->boundary_count : 0,
                                 .slides = slides,
                                 .border = border};
    virtual_points guides = {0};
    bat_status status = geometry->is_deep && cloud->triangle_count > 0
                            ? virtual_points_make(cloud, candidate->parameters, &guides, &failure)
                            : BAT_OK;
    data.guides = guides.places;
    data.guide_parameters = guides.parameters;
    data.guide_count = guides.count;
    if (status == BAT_OK)
        status = bat_surface_fit(&data, options, &candidate->surface, &candidate->fit, &failure);
    virtual_points_free(&guides);
    if (status == BAT_OK)
        status = record_metrics(&data, options, &candidate->surface, &candidate->fit, &candidate->report, &failure);
    if (status == BAT_OK && candidate->trimming != NULL)
        status = trimming_curves(geometry, candidate->trimming, candidate->corrected,
                                 ldexp(candidate->fit.rounds[candidate->fit.count - 1].rms, geometry->frame.exponent - 1),
                                 &candidate->surface.trim, &failure);
    if (status == BAT_OK)
        status = surface_judge(geometry, &candidate->surface, candidate->corrected, candidate->fit.distances, cloud->count,
                               options, &candidate->report.verdict, &failure);
    if (status == BAT_OK && !options->robust)
        doubt_strays(cloud, candidate->fit.distances, &candidate->report.verdict);
    return record_failure(status, &failure, candidate, error);
}

/// Take a random sample of a cloud's points with their parameters, boundary points first: select each point with probability
/// wanted / count. A random choice is needed because the order of points in a file may follow scan lines. The boundary is
/// sampled at the same rate.
static bat_status draw_sample(const bat_cloud *cloud, const double *parameters, size_t wanted, memory_pool *pool,
                              bat_surface_fit_data *sample, bat_error *error)
{
    bat_random random = bat_random_seed(1);
    double *points = memory_pool_array(pool, cloud->count, 3 * sizeof *points);
    sample->points = points;
    sample->parameters = memory_pool_array(pool, cloud->count, 2 * sizeof *sample->parameters);
    bat_status status = memory_pool_check(pool, error);
    if (status != BAT_OK)
        return status;
    double share = (double)wanted / (double)cloud->count;
    for (size_t i = 0; i < cloud->count; i++)
    {
        if (bat_random_uniform(&random) >= share)
            continue;
        memcpy(points + 3 * sample->count, cloud->points + 3 * i, 3 * sizeof *points);
        memcpy(sample->parameters + 2 * sample->count, parameters + 2 * i, 2 * sizeof *sample->parameters);
        sample->count++;
        sample->boundary_count += i < cloud->boundary_count;
    }
    return BAT_OK;
}

bat_status surface_candidate_fit_sample(const bat_cloud *cloud, const bat_surface_fit_options *options, bool slides,
                                        bool border, size_t points, surface_candidate *candidate, bat_error *error)
{
    bat_error failure = {0};
    memory_pool pool = {0};
    bat_surface_fit_data data = {.dimension = 3, .slides = slides, .border = border};
    bat_surface_fit_options trial = *options;
    bat_spline_surface surface = {0};
    bat_surface_fit_report fit = {0};
    bat_status status = draw_sample(cloud, candidate->parameters, points, &pool, &data, &failure);
    size_t maximum = data.count / POINTS_PER_FUNCTION;
    if (trial.functions == 0 || trial.functions > maximum)
        trial.functions = maximum;
    if (status == BAT_OK)
        status = bat_surface_fit(&data, &trial, &surface, &fit, &failure);
    if (status == BAT_OK)
        status = record_metrics(&data, options, &surface, &fit, &candidate->report, &failure);
    bat_spline_surface_free(&surface);
    bat_surface_fit_report_free(&fit);
    memory_pool_free(&pool);
    return record_failure(status, &failure, candidate, error);
}

bat_status surface_candidate_extend(surface_candidate *candidate, const cloud_part *part, const bat_cloud *cloud,
                                    const double *boundary, bat_error *error)
{
    double *parameters = memory_array(cloud->count, 2 * sizeof *parameters);
    if (parameters == NULL)
        return error_memory(error, cloud->count * 2 * sizeof *parameters);
    bat_surface_fit_data data = {.points = cloud->points,
                                 .parameters = parameters,
                                 .count = cloud->count,
                                 .dimension = 3,
                                 .boundary_count = cloud->boundary_count};
    unit_frame frame = unit_frame_of(cloud->points, cloud->count);
    bat_status status =
        cloud_part_spread(&frame, &part->cloud, candidate->corrected, cloud->points, cloud->count, parameters, error);
    memcpy(parameters, boundary, 2 * cloud->boundary_count * sizeof *parameters);
    if (status == BAT_OK)
        status = spline_correct(&candidate->surface, &data, NULL, error);
    // Correction moves the parameters of the boundary too.
    memcpy(parameters, boundary, 2 * cloud->boundary_count * sizeof *parameters);
    if (status != BAT_OK)
    {
        free(parameters);
        return status;
    }
    free(candidate->parameters);
    free(candidate->corrected);
    bat_spline_surface_free(&candidate->surface);
    bat_surface_fit_report_free(&candidate->fit);
    candidate->parameters = parameters;
    candidate->corrected = NULL;
    return BAT_OK;
}

/// Factor of the expected distance for comparisons.
static double factor_of(const bat_surface_candidate *report)
{
    return report->parameters == BAT_SURFACE_PARAMETERS_TENSOR ? TENSOR_FACTOR : 1;
}

static bool is_better(const bat_surface_candidate *first, const bat_surface_candidate *second,
                      const bat_surface_fit_options *options)
{
    if (options->tolerance > 0 && first->reached != second->reached)
        return first->reached;
    if (options->tolerance > 0 && first->reached && first->functions != second->functions)
        return first->functions < second->functions;
    if (options->functions == 0 && !options->robust && isfinite(first->expected_rms) && isfinite(second->expected_rms))
        return first->expected_rms * factor_of(first) < second->expected_rms * factor_of(second);
    return first->mean_squared < second->mean_squared;
}

/// Whether a candidate was fitted, and is judged to be right unless none is.
static bool is_eligible(const bat_surface_candidate *report, bool any_right)
{
    return isfinite(report->mean_squared) && (!any_right || report->verdict.fault == BAT_SURFACE_FAULT_NONE);
}

size_t surface_candidate_best(surface_candidate *candidates, size_t count, const bat_surface_fit_options *options)
{
    double minimum = INFINITY;
    size_t best = BAT_NO_INDEX;
    bool any_right = false;
    for (size_t i = 0; i < count; i++)
        any_right = any_right || (isfinite(candidates[i].report.mean_squared) &&
                                  candidates[i].report.verdict.fault == BAT_SURFACE_FAULT_NONE);
    for (size_t i = 0; i < count; i++)
        if (is_eligible(&candidates[i].report, any_right))
            minimum = fmin(minimum, candidates[i].report.hausdorff);
    for (size_t i = 0; i < count; i++)
    {
        bat_surface_candidate *report = &candidates[i].report;
        report->excluded = isfinite(report->mean_squared) && report->hausdorff > MAX_DISTANCE_RATIO * minimum;
        if (is_eligible(report, any_right) && !report->excluded &&
            (best == BAT_NO_INDEX || is_better(report, &candidates[best].report, options)))
            best = i;
    }
    return best == BAT_NO_INDEX ? 0 : best;
}

// Virtual points

void virtual_points_free(virtual_points *guides)
{
    free(guides->places);
    free(guides->parameters);
    *guides = (virtual_points){0};
}

/// The first node of a side that is not before a parameter.
static size_t node_from(double parameter, size_t side)
{
    double node = ceil(parameter * (double)side - 0.5);
    return node > 0 ? (size_t)fmin(node, (double)side) : 0;
}

/// Add a place with the shares of three corners.
static void add_place(const double *const place[3], const double *const at[3], const double share[3], virtual_points *guides)
{
    for (size_t d = 0; d < 3; d++)
        guides->places[3 * guides->count + d] = share[0] * place[0][d] + share[1] * place[1][d] + share[2] * place[2][d];
    for (size_t d = 0; d < 2; d++)
        guides->parameters[2 * guides->count + d] =
            fmin(fmax(share[0] * at[0][d] + share[1] * at[1][d] + share[2] * at[2][d], 0), 1);
    guides->count++;
}

/// Add the centre of a triangle, and its nodes that no other triangle has.
static void add_triangle(const bat_cloud *cloud, const double *parameters, const uint32_t *corners, size_t side, bool *taken,
                         virtual_points *guides)
{
    const double *at[3], *place[3];
    for (size_t k = 0; k < 3; k++)
    {
        at[k] = parameters + 2 * (size_t)corners[k];
        place[k] = cloud->points + 3 * (size_t)corners[k];
    }
    static const double CENTRE[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    double area = vector2_turn(at[0], at[1], at[2]), low[2], high[2];
    add_place(place, at, CENTRE, guides);
    if (area == 0)
        return;
    box_clear(2, low, high);
    for (size_t k = 0; k < 3; k++)
        box_include(2, at[k], low, high);
    for (size_t j = node_from(low[1], side); j < side && ((double)j + 0.5) / (double)side <= high[1]; j++)
        for (size_t i = node_from(low[0], side); i < side && ((double)i + 0.5) / (double)side <= high[0]; i++)
        {
            double node[2] = {((double)i + 0.5) / (double)side, ((double)j + 0.5) / (double)side};
            double share[3] = {vector2_turn(node, at[1], at[2]) / area, vector2_turn(at[0], node, at[2]) / area, 0};
            share[2] = 1 - share[0] - share[1];
            if (taken[j * side + i] || share[0] < 0 || share[1] < 0 || share[2] < 0)
                continue;
            taken[j * side + i] = true;
            add_place(place, at, share, guides);
        }
}

bat_status virtual_points_make(const bat_cloud *cloud, const double *parameters, virtual_points *guides, bat_error *error)
{
    size_t side = (size_t)ceil(sqrt((double)cloud->count)), nodes = side * side;
    size_t most = nodes + cloud->triangle_count;
    *guides = (virtual_points){.places = memory_array(most, 3 * sizeof *guides->places),
                               .parameters = memory_array(most, 2 * sizeof *guides->parameters)};
    bool *taken = calloc(nodes + 1, sizeof *taken);
    bool made = guides->places != NULL && guides->parameters != NULL && taken != NULL;
    for (size_t t = 0; t < cloud->triangle_count && made; t++)
        add_triangle(cloud, parameters, cloud->triangles + 3 * t, side, taken, guides);
    free(taken);
    if (made)
        return BAT_OK;
    virtual_points_free(guides);
    return error_memory(error, most * 5 * sizeof *guides->places);
}
